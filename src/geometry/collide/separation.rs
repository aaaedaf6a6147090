//! A translation that parts two solids: an upper bound of their penetration depth.
//!
//! Body B moves along a line, away from A, in steps that part the deepest pair of outer balls known, until none meet. The
//! last pair that was parted touches at the end. Near there the translations that part the bodies are bounded by a surface
//! across the line of its centres, so this line is tried next, as long as it gets shorter. It begins with the lines of the
//! force, of the deepest pair, of the centres of mass, and of the axes of both bodies both ways.
//!
//! Meshes whose triangles decide need not be parted as far as their outer balls. A line is cut back as far as they show,
//! and turned to that of the closest points, as long as it gets shorter. Another line is looked at only if a shorter step
//! along it parts the meshes.
//!
//! An exchange of the bodies turns every line round. It changes lengths by no more than rounding, unless two lines are as
//! good as each other.

use knotdock_structures::ball_solid::{Closest, Limits, Motion};
use knotdock_structures::mesh::{ExactSolid, MeshContact};

use super::{CollisionQuery, has_come, unit};

/// Steps along one line.
const STEPS: usize = 64;
/// Pairs of balls compared for one step, or more until one that meets is found.
const PAIRS_PER_STEP: usize = 512;
/// Most lines across a touching pair, one after another.
const REFINED: usize = 8;
/// Share of the shortest line at which others are looked at.
const SHORTER: f64 = 0.97;
/// Times that a line is halved.
const HALVED: usize = 5;
/// Share by which a step goes on, so that rounding does not leave it at the pair that it parts.
const BEYOND: f64 = 1e-12;

/// The end of a line.
struct Exit {
    /// Its length.
    length: f64,
    /// Direction of the centres of the pair that was parted last, if one was.
    across: Option<[f64; 3]>,
}

impl CollisionQuery<'_> {
    /// Length of a translation of B that parts the bodies, given the deepest pair of inner balls.
    pub(super) fn separation(&mut self, deepest: &Closest) -> f64 {
        let exact = self.collision.exact().filter(|_| self.end.is_none());
        let least = (-deepest.distance).max(0.0);
        let mut best = f64::INFINITY;
        for direction in self.directions(deepest.pair) {
            if has_come(self.end) {
                break;
            }
            best = match exact {
                Some(solids) if best.is_finite() => {
                    let shorter = SHORTER * best;
                    if least > shorter || !self.are_apart(solids, direction, shorter) {
                        continue;
                    }
                    self.cut_back(solids, direction, [least, shorter])
                }
                Some(solids) => {
                    let length = self.along(direction, best);
                    self.cut_back(solids, direction, [least, length])
                }
                None => self.along(direction, best),
            };
        }
        match best.is_finite() {
            true => best,
            // The deadline came first: any line ends beyond all balls.
            false => self.beyond_all([1.0, 0.0, 0.0]),
        }
    }

    /// The shorter of `best` and of the lengths along a direction, and along those across the pairs touching last, after
    /// which no outer balls meet.
    fn along(&mut self, direction: [f64; 3], mut best: f64) -> f64 {
        // Meshes are turned by their closest points.
        let turns = match self.collision.exact() {
            Some(_) => 0,
            None => REFINED,
        };
        let mut next = Some(direction);
        for _ in 0..=turns {
            let Some(direction) = next.take().filter(|_| !has_come(self.end)) else {
                break;
            };
            let end = self.beyond_all(direction);
            if let Some(exit) = self.line(direction, best.min(end)) {
                best = exit.length;
                next = exit.across;
            } else {
                best = best.min(end);
            }
        }
        best
    }

    /// Length of a translation that parts two meshes, from one that does; none is shorter than `least`.
    fn cut_back(
        &mut self,
        solids: [&ExactSolid; 2],
        mut direction: [f64; 3],
        [least, mut length]: [f64; 2],
    ) -> f64 {
        let rounding = self.rounding();
        for _ in 0..REFINED {
            let mut below = least;
            let mut met = false;
            for _ in 0..HALVED {
                let middle = 0.5 * (below + length);
                match self.are_apart(solids, direction, middle) {
                    true => length = middle,
                    false => (below, met) = (middle, true),
                }
            }
            let place = self.motion.shifted(direction.map(|part| length * part));
            // The gap is no larger than the step from where they meet.
            let step = length - if met { below } else { 0.0 };
            let lengths = [step * (1.0 + 1e-9), rounding];
            let Some(found) = self.work.surfaces.closest(solids, &place, lengths) else {
                break;
            };
            let [from, to] = found.points;
            let across = unit([0, 1, 2].map(|axis| to[axis] - from[axis]));
            // Up to the plane across the closest points, and a hundredth of the gap beyond.
            let share: f64 = (0..3).map(|axis| direction[axis] * across[axis]).sum();
            let turned = length * share - 0.99 * found.low;
            if turned >= length || turned < least || !self.are_apart(solids, across, turned) {
                break;
            }
            (direction, length) = (across, turned);
        }
        length
    }

    /// Whether a translation parts two meshes.
    fn are_apart(&mut self, solids: [&ExactSolid; 2], direction: [f64; 3], length: f64) -> bool {
        let place = self.motion.shifted(direction.map(|part| length * part));
        let lengths = [0.0, self.rounding()];
        let surfaces = &mut self.work.surfaces;
        surfaces.contact(solids, &place, lengths, || false) == MeshContact::Apart
    }

    fn directions(&mut self, deepest: Option<[usize; 2]>) -> Vec<[f64; 3]> {
        let force = self
            .region()
            .map(|region| region.by_shift.map(|part| -part));
        let [a, b] = self.collision.solids;
        let motion = &self.motion;
        let from = |a: [f64; 3], b: [f64; 3]| {
            let b = motion.apply(b);
            [0, 1, 2].map(|axis| b[axis] - a[axis])
        };
        let pair = deepest.map(|[i, j]| from(a.inner()[i].center, b.inner()[j].center));
        let ways = force.into_iter().chain(pair);
        let ways = ways.chain([from(a.centroid(), b.centroid())]).map(unit);
        let columns = [0, 1, 2].map(|axis| motion.rows.map(|row| row[axis]));
        let axes = Motion::IDENTITY.rows.into_iter().chain(columns);
        let mut axes: Vec<[f64; 3]> = axes
            .flat_map(|axis| [axis, axis.map(|part| -part)])
            .collect();
        let mut directions: Vec<[f64; 3]> = ways.collect();
        // In an order that an exchange of the bodies leaves.
        let away = |axis: &[f64; 3]| (0..3).map(|i| axis[i] * directions[0][i]).sum::<f64>();
        axes.sort_by(|one, other| away(other).total_cmp(&away(one)));
        directions.append(&mut axes);
        directions
    }

    /// Place on a line from which the balls about both bodies no longer meet.
    fn beyond_all(&self, direction: [f64; 3]) -> f64 {
        let [a, b] = self.collision.trees().map(|tree| tree.bound());
        let (Some(a), Some(b)) = (a, b) else {
            return 0.0;
        };
        let sum = a.radius + b.radius + self.collision.band();
        exit(a.center, self.motion.apply(b.center), direction, sum).max(0.0)
    }

    /// Place on a line from which no pair of outer balls meets; `None` if that is not before `enough`, or not known.
    fn line(&mut self, direction: [f64; 3], enough: f64) -> Option<Exit> {
        let (trees, band) = (self.collision.trees(), self.collision.band());
        let limits = Limits {
            ignored_from: band,
            enough_below: f64::NEG_INFINITY,
        };
        let mut exit = Exit {
            length: 0.0,
            across: None,
        };
        for _ in 0..STEPS {
            let moved = self
                .motion
                .shifted(direction.map(|part| exit.length * part));
            let search = &mut self.work.search;
            search.begin(trees, &moved, &limits);
            let mut closest = search.advance(trees, &moved, &limits, PAIRS_PER_STEP);
            while closest.pair.is_none() && !closest.finished {
                closest = search.advance(trees, &moved, &limits, PAIRS_PER_STEP);
            }
            self.ball_pairs += closest.ball_pairs;
            let Some([i, j]) = closest.pair else {
                return Some(exit);
            };
            let (a, b) = (trees[0].balls()[i], trees[1].balls()[j]);
            let sum = a.radius + b.radius + band;
            let step = self::exit(a.center, moved.apply(b.center), direction, sum).max(0.0);
            let step = step + BEYOND * (sum + exit.length);
            exit.length += step;
            let parted = moved
                .shifted(direction.map(|part| step * part))
                .apply(b.center);
            exit.across = Some(unit([0, 1, 2].map(|axis| parted[axis] - a.center[axis])));
            if exit.length >= enough || has_come(self.end) {
                return None;
            }
        }
        None
    }
}

/// How far a ball at `center` goes along a direction of length one until it is `sum` away from `from` and leaves.
fn exit(from: [f64; 3], center: [f64; 3], direction: [f64; 3], sum: f64) -> f64 {
    let arm = [0, 1, 2].map(|axis| center[axis] - from[axis]);
    let along = (0..3).map(|axis| arm[axis] * direction[axis]).sum::<f64>();
    let across = [0, 1, 2].map(|axis| arm[axis] - along * direction[axis]);
    let squared = sum * sum - across.iter().map(|part| part * part).sum::<f64>();
    squared.max(0.0).sqrt() - along
}
