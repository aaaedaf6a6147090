//! A translation that parts two solids: an upper bound of their penetration depth.
//!
//! Two ways are tried, and the shorter result is taken. Any translation after which no outer balls meet is one. None is
//! shorter than the depth of the deepest pair: a push of at most twice that is taken as it is.
//!
//! - **Pushes.** All pairs of outer balls that meet push along their centres, each by its depth. B goes along the sum
//!   until the deepest pair is parted, again and again. This follows a curved way out of shallow contacts, and ends
//!   nowhere where solids interlock. The line from the first to the last place is tried as well.
//! - **Lines.** Body B moves along a line, away from A. At every place the deepest pair known says how far B must go at
//!   least to part that pair. The lines are that of the deepest pair, that of the centres of mass, and the axes both
//!   ways. Each ends, since balls are convex, so that a line leaves each pair once. After many steps it ends beyond the
//!   balls about all of A and all of B.

use knotdock_structures::ball_solid::{ClosestSearch, Limits, Motion};

use super::scene::{CollisionScene, Deadline, PAIRS_A_LOOK, Workspace, unit};

/// Steps along one line.
const STEPS: usize = 64;
/// Pairs of balls looked at for one step, unless none that meets is found among them.
const PAIRS_A_STEP: usize = 512;
/// A push of so many times the depth of the deepest pair is not bettered by lines.
const ENOUGH: f64 = 2.0;
/// Pushes at most.
const PUSHES: usize = 100;
/// Share by which a step goes on, so that rounding does not leave it at the pair that it parts.
const BEYOND: f64 = 1e-12;

impl CollisionScene {
    /// Length of a translation of B after which no outer balls meet, given the deepest pair of inner balls and its
    /// signed distance, and the pairs of balls looked at.
    pub(super) fn separation(
        &self,
        motion: &Motion,
        (high, deepest): (f64, Option<[usize; 2]>),
        deadline: Deadline,
        work: &mut Workspace,
    ) -> (f64, usize) {
        let mut pairs = 0;
        let pushed = self.pushed(motion, deadline, work, &mut pairs);
        let mut best = pushed.map_or(f64::INFINITY, length);
        if best <= ENOUGH * (self.band() - high) {
            return (best, pairs);
        }
        let straight = pushed.map(unit);
        for direction in straight.into_iter().chain(self.directions(motion, deepest)) {
            let end = self.beyond_all(motion, direction);
            let along = self.line(motion, direction, best.min(end), deadline, work, &mut pairs);
            best = best.min(along.unwrap_or(end));
            if deadline.has_come() {
                break;
            }
        }
        (best, pairs)
    }

    /// The translation that repeated pushes add up to; `None` where they do not part the bodies.
    fn pushed(
        &self,
        motion: &Motion,
        deadline: Deadline,
        work: &mut Workspace,
        pairs: &mut usize,
    ) -> Option<[f64; 3]> {
        let trees = self.trees();
        let mut total = [0.0f64; 3];
        for _ in 0..PUSHES {
            let moved = motion.shifted(total);
            let mut push = [0.0f64; 3];
            let mut deepest: Option<(f64, [usize; 2])> = None;
            work.pairs
                .visit(trees, &moved, self.band(), |[i, j], ball, squared| {
                    let other = &trees[0].balls()[i];
                    let depth = other.radius + ball.radius + self.band() - squared.sqrt();
                    let away = unit([0, 1, 2].map(|axis| ball.center[axis] - other.center[axis]));
                    for axis in 0..3 {
                        push[axis] += depth * away[axis];
                    }
                    if deepest.is_none_or(|(most, _)| depth > most) {
                        deepest = Some((depth, [i, j]));
                    }
                    *pairs += 1;
                    !pairs.is_multiple_of(PAIRS_A_LOOK) || !deadline.has_come()
                });
            let Some((_, [i, j])) = deepest else {
                return Some(total);
            };
            if deadline.has_come() {
                return None;
            }
            let (a, b) = (trees[0].balls()[i], trees[1].balls()[j]);
            let direction = unit(push);
            let sum = a.radius + b.radius + self.band();
            let step = exit(a.center, moved.apply(b.center), direction, sum);
            let step = step.max(0.0) + BEYOND * (sum + length(total));
            for axis in 0..3 {
                total[axis] += step * direction[axis];
            }
        }
        None
    }

    fn directions(&self, motion: &Motion, deepest: Option<[usize; 2]>) -> Vec<[f64; 3]> {
        let from = |a: [f64; 3], b: [f64; 3]| {
            let b = motion.apply(b);
            unit([0, 1, 2].map(|axis| b[axis] - a[axis]))
        };
        let [a, b] = self.solids();
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

    /// Where on a line the balls about both bodies no longer meet.
    fn beyond_all(&self, motion: &Motion, direction: [f64; 3]) -> f64 {
        let [a, b] = self.trees().map(|tree| tree.bound());
        let (Some(a), Some(b)) = (a, b) else {
            return 0.0;
        };
        let center = motion.apply(b.center);
        let sum = a.radius + b.radius + self.band();
        exit(a.center, center, direction, sum).max(0.0)
    }

    /// Where on a line no pair of outer balls meets any more; `None` where that is not before `enough`, or not known.
    fn line(
        &self,
        motion: &Motion,
        direction: [f64; 3],
        enough: f64,
        deadline: Deadline,
        work: &mut Workspace,
        pairs: &mut usize,
    ) -> Option<f64> {
        let limits = Limits {
            ignored_from: self.band(),
            enough_below: f64::NEG_INFINITY,
        };
        let trees = self.trees();
        let mut place = 0.0;
        for _ in 0..STEPS {
            let moved = motion.shifted(direction.map(|part| place * part));
            let search: &mut ClosestSearch = &mut work.search;
            search.begin(trees, &moved, &limits);
            let mut found = search.advance(trees, &moved, &limits, PAIRS_A_STEP);
            while found.pair.is_none() && !found.finished {
                found = search.advance(trees, &moved, &limits, PAIRS_A_STEP);
            }
            *pairs += found.ball_pairs;
            let Some([i, j]) = found.pair else {
                return Some(place);
            };
            let (a, b) = (trees[0].balls()[i], trees[1].balls()[j]);
            let sum = a.radius + b.radius + self.band();
            let step = exit(a.center, moved.apply(b.center), direction, sum);
            place += step.max(0.0) + BEYOND * (sum + place);
            if place >= enough || deadline.has_come() {
                return None;
            }
        }
        None
    }
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().fold(0.0f64, |sum, part| sum.hypot(*part))
}

/// How far a ball at `center` goes along a direction of length one until it is `sum` away from `from` and leaves.
fn exit(from: [f64; 3], center: [f64; 3], direction: [f64; 3], sum: f64) -> f64 {
    let arm = [0, 1, 2].map(|axis| center[axis] - from[axis]);
    let along = (0..3).map(|axis| arm[axis] * direction[axis]).sum::<f64>();
    let across = [0, 1, 2].map(|axis| arm[axis] - along * direction[axis]);
    let squared = sum * sum - across.iter().map(|part| part * part).sum::<f64>();
    squared.max(0.0).sqrt() - along
}
