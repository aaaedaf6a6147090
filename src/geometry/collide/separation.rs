//! A translation that parts two solids: an upper bound of their penetration depth.
//!
//! Two ways are tried, and the shorter result is taken. Any translation after which no outer balls meet is one. None is
//! shorter than the depth of the deepest pair: a push of at most twice that is taken as it is.
//!
//! - **Pushes.** All pairs of outer balls that meet push along their centres, each by its depth. B goes along the sum
//!   until the deepest pair is parted, again and again. This follows a curved way out of shallow contacts, and fails if
//!   solids interlock. The line from the first to the last place is tried as well.
//! - **Lines.** Body B moves along a line, away from A, in steps that part the deepest pair known. The lines are that of
//!   the deepest pair, that of the centres of mass, and the axes both ways. After many steps a line ends beyond the balls
//!   about all of A and all of B.

use knotdock_structures::Ball;
use knotdock_structures::ball_solid::{Closest, Limits};

use super::{CollisionQuery, PAIRS_PER_CLOCK_CHECK, has_come, length, unit};

/// Steps along one line.
const STEPS: usize = 64;
/// Pairs of balls compared for one step, or more until one that meets is found.
const PAIRS_PER_STEP: usize = 512;
/// A push within this multiple of the deepest pair's depth is not improved by lines.
const ENOUGH: f64 = 2.0;
/// Maximum number of pushes.
const MAX_PUSHES: usize = 100;
/// Share by which a step goes on, so that rounding does not leave it at the pair that it parts.
const BEYOND: f64 = 1e-12;

impl CollisionQuery<'_> {
    /// Length of a translation of B after which no outer balls meet, given the deepest pair of inner balls.
    pub(super) fn separation(&mut self, deepest: &Closest) -> f64 {
        let pushed = self.pushed();
        let mut best = pushed.map_or(f64::INFINITY, length);
        if best <= ENOUGH * (self.collision.band() - deepest.distance) {
            return best;
        }
        let straight = pushed.map(unit);
        for direction in straight.into_iter().chain(self.directions(deepest.pair)) {
            let end = self.beyond_all(direction);
            let along = self.line(direction, best.min(end));
            best = best.min(along.unwrap_or(end));
            if has_come(self.end) {
                break;
            }
        }
        best
    }

    /// The translation that repeated pushes add up to; `None` if they do not part the bodies.
    fn pushed(&mut self) -> Option<[f64; 3]> {
        let (trees, band) = (self.collision.trees(), self.collision.band());
        let mut total = [0.0f64; 3];
        for _ in 0..MAX_PUSHES {
            let moved = self.motion.shifted(total);
            let mut push = [0.0f64; 3];
            let mut deepest: Option<(f64, [usize; 2])> = None;
            let mut visit = |[i, j]: [usize; 2], ball: &Ball, squared: f64| {
                let other = &trees[0].balls()[i];
                let depth = other.radius + ball.radius + band - squared.sqrt();
                let away = unit([0, 1, 2].map(|axis| ball.center[axis] - other.center[axis]));
                for axis in 0..3 {
                    push[axis] += depth * away[axis];
                }
                if deepest.is_none_or(|(most, _)| depth > most) {
                    deepest = Some((depth, [i, j]));
                }
                self.ball_pairs += 1;
                !self.ball_pairs.is_multiple_of(PAIRS_PER_CLOCK_CHECK) || !has_come(self.end)
            };
            self.work.pairs.visit(trees, &moved, band, &mut visit);
            let Some((_, [i, j])) = deepest else {
                return Some(total);
            };
            if has_come(self.end) {
                return None;
            }
            let (a, b) = (trees[0].balls()[i], trees[1].balls()[j]);
            let direction = unit(push);
            let sum = a.radius + b.radius + band;
            let step = exit(a.center, moved.apply(b.center), direction, sum);
            let step = step.max(0.0) + BEYOND * (sum + length(total));
            for axis in 0..3 {
                total[axis] += step * direction[axis];
            }
        }
        None
    }

    fn directions(&self, deepest: Option<[usize; 2]>) -> Vec<[f64; 3]> {
        let from = |a: [f64; 3], b: [f64; 3]| {
            let b = self.motion.apply(b);
            unit([0, 1, 2].map(|axis| b[axis] - a[axis]))
        };
        let [a, b] = self.collision.solids;
        let pair = deepest.map(|[i, j]| from(a.inner()[i].center, b.inner()[j].center));
        let mut directions: Vec<[f64; 3]> = pair.into_iter().collect();
        directions.push(from(a.centroid(), b.centroid()));
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let mut direction = [0.0; 3];
                direction[axis] = sign;
                directions.push(direction);
            }
        }
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
    fn line(&mut self, direction: [f64; 3], enough: f64) -> Option<f64> {
        let (trees, band) = (self.collision.trees(), self.collision.band());
        let limits = Limits {
            ignored_from: band,
            enough_below: f64::NEG_INFINITY,
        };
        let mut place = 0.0;
        for _ in 0..STEPS {
            let moved = self.motion.shifted(direction.map(|part| place * part));
            let search = &mut self.work.search;
            search.begin(trees, &moved, &limits);
            let mut closest = search.advance(trees, &moved, &limits, PAIRS_PER_STEP);
            while closest.pair.is_none() && !closest.finished {
                closest = search.advance(trees, &moved, &limits, PAIRS_PER_STEP);
            }
            self.ball_pairs += closest.ball_pairs;
            let Some([i, j]) = closest.pair else {
                return Some(place);
            };
            let (a, b) = (trees[0].balls()[i], trees[1].balls()[j]);
            let sum = a.radius + b.radius + band;
            let step = exit(a.center, moved.apply(b.center), direction, sum);
            place += step.max(0.0) + BEYOND * (sum + place);
            if place >= enough || has_come(self.end) {
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
