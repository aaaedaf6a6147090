//! The signed distance of two unions of balls: best-first descent of two sphere trees.
//!
//! The signed distance of a pair of balls is d - r - s. The least over all pairs is the distance of unions that do not
//! meet. For unions that meet, it is minus the depth of the deepest pair, which no shorter translation can separate.
//!
//! A pair of nodes is opened only while the balls about them could hold a closer pair than the one known. The larger of
//! the two is replaced by its halves, the closer half first. The largest balls of two nodes are tried before their
//! parts, so that solids deep in each other are known to meet at once.
//!
//! A search stops when its limits say so and can go on. Until it has finished, it knows a lower bound as well.

use super::Motion;
use super::hierarchy::{BallHierarchy, Node};
use crate::ball::Ball;

/// Nodes of fewer balls do not try their largest ones first.
const TRIED_FIRST: u32 = 16;

/// Bounds beyond which a search need not go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Pairs at this signed distance or farther do not count.
    pub ignored_from: f64,
    /// The search ends at the first pair closer than this.
    pub enough_below: f64,
}

impl Limits {
    /// The closest pair whatever its distance.
    pub const NONE: Self = Self {
        ignored_from: f64::INFINITY,
        enough_below: f64::NEG_INFINITY,
    };
}

/// Result of a search as far as it went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The closest pair found: its balls' numbers in the first and the second tree. `None` if all pairs seen are ignored.
    pub pair: Option<[usize; 2]>,
    /// Signed distance of that pair, or [`Limits::ignored_from`].
    pub distance: f64,
    /// No pair is closer than this.
    pub lower: f64,
    /// Whether the search has ended: then `lower` is `distance`, or that is below what was enough.
    pub finished: bool,
    /// Pairs of balls whose distance was computed.
    pub ball_pairs: usize,
}

/// Two nodes, and no pair of their balls is closer than `bound`.
#[derive(Clone, Copy, Debug)]
struct Open {
    bound: f64,
    nodes: [u32; 2],
}

/// A search in progress. Buffers are kept from one search to the next.
#[derive(Debug, Default)]
pub struct ClosestSearch {
    /// The last is opened next.
    open: Vec<Open>,
    best: f64,
    pair: Option<[usize; 2]>,
    ball_pairs: usize,
}

impl ClosestSearch {
    /// A search without buffers.
    pub fn new() -> Self {
        Self::default()
    }

    /// Begins anew: the first tree stands, the second is moved.
    pub fn begin(&mut self, trees: [&BallHierarchy; 2], motion: &Motion, limits: &Limits) {
        self.open.clear();
        self.best = limits.ignored_from;
        self.pair = None;
        self.ball_pairs = 0;
        if let [Some(a), Some(b)] = trees.map(|tree| tree.nodes().first()) {
            let bound = gap(&a.bound, &b.bound, motion);
            self.open.push(Open {
                bound,
                nodes: [0, 0],
            });
        }
    }

    /// Goes on until the search is finished, or `pairs` more pairs of balls were looked at.
    pub fn advance(
        &mut self,
        trees: [&BallHierarchy; 2],
        motion: &Motion,
        limits: &Limits,
        pairs: usize,
    ) -> Closest {
        let stop_at = self.ball_pairs.saturating_add(pairs);
        while let Some(open) = self.open.pop() {
            if open.bound >= self.best {
                continue;
            }
            if self.best < limits.enough_below || self.ball_pairs >= stop_at {
                self.open.push(open);
                break;
            }
            self.open_up(trees, motion, limits, open);
        }
        self.state(limits)
    }

    /// Pairs of balls compared since the search began.
    pub fn ball_pairs(&self) -> usize {
        self.ball_pairs
    }

    /// The closest pair, from beginning to end.
    pub fn find(
        &mut self,
        trees: [&BallHierarchy; 2],
        motion: &Motion,
        limits: &Limits,
    ) -> Closest {
        self.begin(trees, motion, limits);
        self.advance(trees, motion, limits, usize::MAX)
    }

    fn state(&self, limits: &Limits) -> Closest {
        let bounds = self.open.iter().map(|open| open.bound);
        Closest {
            pair: self.pair,
            distance: self.best,
            lower: bounds.fold(self.best, f64::min),
            finished: self.open.is_empty() || self.best < limits.enough_below,
            ball_pairs: self.ball_pairs,
        }
    }

    /// Compares the balls of two leaves, or replaces the larger node by its halves.
    fn open_up(
        &mut self,
        trees: [&BallHierarchy; 2],
        motion: &Motion,
        limits: &Limits,
        open: Open,
    ) {
        let [a, b] = [0, 1].map(|side| &trees[side].nodes()[open.nodes[side] as usize]);
        if a.second == 0 && b.second == 0 {
            return self.compare(trees, motion, [a, b]);
        }
        if a.count.min(b.count) >= TRIED_FIRST {
            self.try_largest(trees, motion, [a, b]);
            if self.best < limits.enough_below {
                // It stays open: the search has seen enough, not all.
                self.open.push(open);
                return;
            }
        }
        let split_second = a.second == 0 || (b.second != 0 && b.bound.radius > a.bound.radius);
        let side = usize::from(split_second);
        let parent = open.nodes[side];
        let children = [parent + 1, trees[side].nodes()[parent as usize].second];
        let mut halves = children.map(|child| {
            let mut nodes = open.nodes;
            nodes[side] = child;
            let [a, b] = [0, 1].map(|side| &trees[side].nodes()[nodes[side] as usize].bound);
            // No child is nearer than its parent: the least of all bounds never falls.
            let bound = gap(a, b, motion).max(open.bound);
            Open { bound, nodes }
        });
        if halves[0].bound < halves[1].bound {
            halves.swap(0, 1);
        }
        // The closer one last, so that it is opened next.
        for half in halves {
            if half.bound < self.best {
                self.open.push(half);
            }
        }
    }

    fn try_largest(&mut self, trees: [&BallHierarchy; 2], motion: &Motion, nodes: [&Node; 2]) {
        let pair = nodes.map(|node| node.largest as usize);
        let [a, b] = [0, 1].map(|side| &trees[side].balls()[pair[side]]);
        self.ball_pairs += 1;
        let found = gap(a, b, motion);
        if found < self.best {
            self.best = found;
            self.pair = Some(pair);
        }
    }

    fn compare(&mut self, trees: [&BallHierarchy; 2], motion: &Motion, [a, b]: [&Node; 2]) {
        self.ball_pairs += (a.count * b.count) as usize;
        for (second, ball) in (b.first..).zip(trees[1].members(b)) {
            let moved = Ball::new(motion.apply(ball.center), ball.radius);
            for (first, other) in (a.first..).zip(trees[0].members(a)) {
                // Compared as squares: a root only where a pair is closer than the best.
                let [x, y, z] = [0, 1, 2].map(|axis| other.center[axis] - moved.center[axis]);
                let squared = x * x + y * y + z * z;
                let sum = other.radius + moved.radius;
                let limit = self.best + sum;
                if limit > 0.0 && squared < limit * limit {
                    let found = squared.sqrt() - sum;
                    if found < self.best {
                        self.best = found;
                        self.pair = Some([first as usize, second as usize]);
                    }
                }
            }
        }
    }
}

/// Signed distance of a ball and a moved one.
#[inline(always)]
fn gap(first: &Ball, second: &Ball, motion: &Motion) -> f64 {
    let center = motion.apply(second.center);
    let [x, y, z] = [0, 1, 2].map(|axis| first.center[axis] - center[axis]);
    (x * x + y * y + z * z).sqrt() - first.radius - second.radius
}

#[cfg(test)]
mod tests {
    use super::super::hierarchy::tests::jumbled;
    use super::*;

    /// A rotation about an axis of no special direction, and a shift.
    fn motion(angle: f64, shift: [f64; 3]) -> Motion {
        let (s, c) = angle.sin_cos();
        let [x, y, z] = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0];
        let t = 1.0 - c;
        Motion {
            rows: [
                [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
                [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
                [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
            ],
            shift,
        }
    }

    fn least(trees: [&BallHierarchy; 2], motion: &Motion) -> f64 {
        let pairs = trees[0].balls().iter().flat_map(|a| {
            let second = trees[1].balls().iter();
            second.map(|b| gap(a, b, motion))
        });
        pairs.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_closest_pair_is_that_of_all_pairs() {
        let (a, b) = (
            BallHierarchy::new(&jumbled(300, 0.1)),
            BallHierarchy::new(&jumbled(170, 0.7)),
        );
        let mut search = ClosestSearch::new();
        for step in 0..60 {
            let far = f64::from(step) * 0.1;
            let motion = motion(f64::from(step), [far, -0.3 * far, 0.1]);
            let exact = least([&a, &b], &motion);
            let found = search.find([&a, &b], &motion, &Limits::NONE);
            assert!(
                found.finished && (found.distance - exact).abs() <= 1e-14,
                "{step}"
            );
            assert_eq!(found.lower, found.distance);
            let [i, j] = found.pair.unwrap();
            let own = gap(&a.balls()[i], &b.balls()[j], &motion);
            assert!((own - found.distance).abs() <= 1e-14);
            assert!(found.ball_pairs < 300 * 170 / 4, "{}", found.ball_pairs);
        }
    }

    #[test]
    fn limits_are_kept() {
        let (a, b) = (
            BallHierarchy::new(&jumbled(300, 0.1)),
            BallHierarchy::new(&jumbled(170, 0.7)),
        );
        let mut search = ClosestSearch::new();
        for step in 0..60 {
            let motion = motion(f64::from(step), [0.05 * f64::from(step), 0.0, 0.0]);
            let exact = least([&a, &b], &motion);
            let limits = Limits {
                ignored_from: 0.1,
                enough_below: 0.0,
            };
            let found = search.find([&a, &b], &motion, &limits);
            assert!(found.finished);
            assert_eq!(found.pair.is_some(), exact < 0.1, "{step}");
            assert_eq!(found.distance < 0.0, exact < 0.0, "{step}");
            assert!(found.lower <= exact.min(0.1));
            if (0.0..0.1).contains(&exact) {
                assert!((found.distance - exact).abs() < 1e-14);
            }
        }
    }

    /// A search that is stopped after every few pairs brackets the answer, ever closer, and ends with it.
    #[test]
    fn a_stopped_search_brackets_and_goes_on() {
        let (a, b) = (
            BallHierarchy::new(&jumbled(300, 0.1)),
            BallHierarchy::new(&jumbled(170, 0.7)),
        );
        let motion = motion(1.0, [1.2, 0.4, 0.1]);
        let exact = least([&a, &b], &motion);
        let mut search = ClosestSearch::new();
        search.begin([&a, &b], &motion, &Limits::NONE);
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut stops = 0;
        loop {
            let state = search.advance([&a, &b], &motion, &Limits::NONE, 3);
            assert!(state.lower <= exact + 1e-14 && exact <= state.distance + 1e-14);
            assert!(state.lower >= low && state.distance <= high);
            (low, high) = (state.lower, state.distance);
            stops += 1;
            if state.finished {
                break;
            }
        }
        assert!(stops > 3 && (high - exact).abs() < 1e-14 && low == high);
    }
}
