//! Unions of copies of balls, each moved and grown: sums and products of which no ball is stored.
//!
//! The sum C + B is a copy of C for each ball (b, s) of B, moved by b and grown by s. Copies are halved into a tree. The
//! copies below a node with middle m and reach R (the most of |b - m| + s) are no nearer to a point x than C is to
//! x - m, less R.

use knotdock_scoring::se3::Pose;
use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::ball_tree::BallTree;

use crate::geometry::bracket::bounds;

/// A union of copies of balls. Points are relative to a middle, that of a cube.
pub struct Copies {
    /// The balls, as they were before they were moved.
    tree: BallTree,
    /// Trees of copies, each in depth-first order.
    nodes: Vec<Node>,
    roots: Vec<usize>,
}

/// One copy, or the copies below a node.
struct Node {
    /// Where a point lies for the balls as they were.
    to_balls: Pose,
    /// What the balls grow by; of several copies what holds them all.
    grown: f64,
    /// The second half; the first follows this node. Zero where it is one copy.
    second: usize,
}

impl Copies {
    /// The balls as they are; `middle` is where the union's own coordinates have their zero.
    pub fn of(balls: &[Ball], middle: [f64; 3]) -> Self {
        let origin = Ball {
            center: [0.0; 3],
            radius: 0.0,
        };
        Self::sum(balls, &[origin], middle)
    }

    /// The Minkowski sum of two sets.
    pub fn sum(balls: &[Ball], others: &[Ball], middle: [f64; 3]) -> Self {
        let mut nodes = Vec::new();
        let mut others = others.to_vec();
        if !others.is_empty() {
            halve(&mut others, middle, &mut nodes);
        }
        Self {
            tree: BallTree::new(balls),
            roots: (0..nodes.len().min(1)).collect(),
            nodes,
        }
    }

    /// The balls in several poses; `middle` is in the frame to which the poses go.
    pub fn moved(balls: &[Ball], poses: &[Pose], middle: [f64; 3]) -> Self {
        let from_middle = Pose {
            translation: middle.into(),
            ..Pose::identity()
        };
        let nodes = poses.iter().map(|pose| Node {
            to_balls: pose.inverse().after(&from_middle),
            grown: 0.0,
            second: 0,
        });
        Self {
            tree: BallTree::new(balls),
            nodes: nodes.collect(),
            roots: (0..poses.len()).collect(),
        }
    }

    /// Distance from a point to the union, below zero inside, or `most` if it is more than that. The search stops at the
    /// first copy found within `enough`, so that a value up to that says no more than "within".
    pub fn distance_within(&self, point: [f64; 3], enough: f64, most: f64) -> f64 {
        let mut best = most;
        for &root in &self.roots {
            let bound = self.bound(root, point, [enough, best]);
            self.search(root, bound, point, enough, &mut best);
            if best <= enough {
                break;
            }
        }
        best
    }

    /// No copy below a node is nearer to a point than this, or than `most`, whichever is less. Of one copy it is the
    /// distance, or a value up to `enough`.
    fn bound(&self, at: usize, point: [f64; 3], [enough, most]: [f64; 2]) -> f64 {
        let node = &self.nodes[at];
        let there = node.to_balls.apply(point);
        let most = most + node.grown;
        if node.second == 0 {
            return self.tree.distance_within(there, enough + node.grown, most) - node.grown;
        }
        // A middle within the balls rules out nothing, however deep it is.
        match self.tree.distance_within(there, 0.0, most) {
            ..=0.0 => f64::NEG_INFINITY,
            distance => distance - node.grown,
        }
    }

    fn search(&self, at: usize, bound: f64, point: [f64; 3], enough: f64, best: &mut f64) {
        let second = self.nodes[at].second;
        if second == 0 {
            *best = best.min(bound);
        }
        if second == 0 || bound >= *best {
            return;
        }
        let [a, b] = [at + 1, second].map(|half| (half, self.bound(half, point, [enough, *best])));
        let [near, far] = if b.1 < a.1 { [b, a] } else { [a, b] };
        self.search(near.0, near.1, point, enough, best);
        if *best > enough {
            self.search(far.0, far.1, point, enough, best);
        }
    }

    /// The copies that come within `reach` of a point, for [`Self::holds`].
    pub fn near(&self, point: [f64; 3], reach: f64) -> Vec<usize> {
        let mut found = Vec::new();
        let mut open = self.roots.clone();
        while let Some(at) = open.pop() {
            let node = &self.nodes[at];
            let limit = reach + node.grown;
            if self.tree.distance(node.to_balls.apply(point), limit) > limit {
                continue;
            }
            match node.second {
                0 => found.push(at),
                second => open.extend([at + 1, second]),
            }
        }
        found
    }

    /// Whether one ball of the copies named holds all of `ball`.
    pub fn holds(&self, copies: &[usize], ball: &Ball) -> bool {
        copies.iter().any(|&copy| {
            let copy = &self.nodes[copy];
            self.tree.holds(&Ball {
                center: copy.to_balls.apply(ball.center),
                radius: ball.radius - copy.grown,
            })
        })
    }
}

/// Adds the tree of the copies that balls, at least one, stand for.
fn halve(balls: &mut [Ball], origin: [f64; 3], nodes: &mut Vec<Node>) {
    let (low, high) = bounds(balls);
    let middle = match balls {
        [only] => only.center,
        _ => [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis])),
    };
    let reach = balls.iter().map(|ball| {
        let off = [0, 1, 2].map(|axis| ball.center[axis] - middle[axis]);
        nalgebra::Vector3::from(off).norm() + ball.radius
    });
    let at = nodes.len();
    nodes.push(Node {
        to_balls: Pose {
            translation: [0, 1, 2].map(|axis| origin[axis] - middle[axis]).into(),
            ..Pose::identity()
        },
        grown: reach.fold(0.0, f64::max),
        second: 0,
    });
    if balls.len() == 1 {
        return;
    }
    let extent = |axis: &usize| high[*axis] - low[*axis];
    let axis = (0..3).max_by(|a, b| extent(a).total_cmp(&extent(b))).unwrap_or(0);
    let half = balls.len() / 2;
    balls.select_nth_unstable_by(half, |a, b| a.center[axis].total_cmp(&b.center[axis]));
    let (left, right) = balls.split_at_mut(half);
    halve(left, origin, nodes);
    nodes[at].second = nodes.len();
    halve(right, origin, nodes);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::obstacle::pairs::PairSums;

    #[test]
    fn a_sum_that_is_not_stored_is_as_far_as_one_that_is() {
        let cloud = |count: u32, step: f64| -> Vec<Ball> {
            (1..=count)
                .map(|i| {
                    let part = |factor: f64| (f64::from(i) * factor * step).fract();
                    let center = [part(0.8191), part(0.671), part(0.5497)];
                    let radius = 0.01 + 0.1 * part(0.45);
                    Ball { center, radius }
                })
                .collect()
        };
        let (a, b) = (cloud(60, 1.0), cloud(37, 1.7));
        let middle = [0.5, 1.0, -0.25];
        let sum = Copies::sum(&a, &b, middle);
        let all: Vec<Ball> = PairSums::new(&a, &b, 0.0).iter().collect();
        let tree = BallTree::new(&all);
        for place in cloud(200, 0.3) {
            let point = place.center.map(|x| 4.0 * x - 2.0);
            let there = [0, 1, 2].map(|axis| point[axis] + middle[axis]);
            let exact = tree.distance(there, f64::NEG_INFINITY);
            assert!((sum.distance_within(point, f64::NEG_INFINITY, f64::INFINITY) - exact).abs() < 1e-12);
            let bounded = sum.distance_within(point, f64::NEG_INFINITY, 0.1);
            assert!((bounded - exact.min(0.1)).abs() < 1e-12);
            let early = sum.distance_within(point, 0.0, f64::INFINITY);
            assert!((early - exact).abs() < 1e-12 || exact <= early + 1e-12 && early <= 0.0);
            let small = Ball {
                center: point,
                radius: 0.02,
            };
            let near = sum.near(point, 0.02);
            assert_eq!(near.is_empty(), exact > 0.02);
            assert_eq!(sum.holds(&near, &small), exact <= -0.02);
        }
    }
}
