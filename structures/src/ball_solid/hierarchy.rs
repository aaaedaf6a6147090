//! A sphere tree over balls, for queries between two solids.
//!
//! A binary tree, halved at the median of the longest side of the box of the centres. Each node knows a ball about all
//! of its balls, and the largest of them. Building takes O(n log n) time and O(n) memory; a rotation changes nothing.

use crate::ball::Ball;
use crate::neighbours::box_tree::box_tree;
use crate::vector::{add, along, bounds, distance, scale, subtract};

const LEAF: usize = 4;
/// Steps by which the centre of a bounding ball is moved towards what reaches out farthest.
const STEPS: i32 = 24;

#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// A ball that holds all of them.
    pub bound: Ball,
    /// Where they begin in the list of all.
    pub first: u32,
    pub count: u32,
    /// The second half; the first follows this node. Zero in a leaf.
    pub second: u32,
    /// The largest of them.
    pub largest: u32,
}

/// Balls and a tree of balls about them.
#[derive(Clone, Debug)]
pub struct BallHierarchy {
    /// In the order of the tree.
    balls: Vec<Ball>,
    /// Index of each in the list given.
    order: Vec<u32>,
    /// Nodes in depth-first order; none without balls.
    nodes: Vec<Node>,
}

impl BallHierarchy {
    /// Builds the tree. Balls in the same place keep their order.
    pub fn new(balls: &[Ball]) -> Self {
        let mut numbered: Vec<(usize, Ball)> = balls.iter().copied().enumerate().collect();
        let place = |(number, ball): &(usize, Ball)| (ball.center, *number);
        let nodes = box_tree(&mut numbered, LEAF, place, |balls| {
            // In the order of the input, whatever order the halving left.
            let mut balls = balls.to_vec();
            balls.sort_unstable_by_key(|(number, _)| *number);
            bounding(&balls)
        });
        let mut nodes: Vec<Node> = nodes
            .into_iter()
            .map(|node| Node {
                bound: node.known,
                first: node.first as u32,
                count: node.count as u32,
                second: node.second as u32,
                largest: node.first as u32,
            })
            .collect();
        for at in (0..nodes.len()).rev() {
            let Node {
                first,
                count,
                second,
                ..
            } = nodes[at];
            if second == 0 {
                let own = first as usize..(first + count) as usize;
                numbered[own].sort_unstable_by_key(|(number, _)| *number);
            }
            let radius = |place: u32| numbered[place as usize].1.radius;
            let larger = |best, place| {
                if radius(place) > radius(best) {
                    place
                } else {
                    best
                }
            };
            nodes[at].largest = if second == 0 {
                (first + 1..first + count).fold(first, larger)
            } else {
                larger(nodes[at + 1].largest, nodes[second as usize].largest)
            };
        }
        let (order, balls) = numbered
            .into_iter()
            .map(|(number, ball)| (number as u32, ball))
            .unzip();
        Self {
            balls,
            order,
            nodes,
        }
    }

    /// The balls, in the order of the tree.
    pub fn balls(&self) -> &[Ball] {
        &self.balls
    }

    /// Index of each ball, in the order of the tree, in the list given to [`Self::new`].
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// A ball that holds all.
    pub fn bound(&self) -> Option<Ball> {
        self.nodes.first().map(|root| root.bound)
    }

    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    #[inline(always)]
    pub(super) fn members(&self, node: &Node) -> &[Ball] {
        &self.balls[node.first as usize..(node.first + node.count) as usize]
    }
}

/// A small ball that holds all: from the middle of their box, the centre moves towards the ball that reaches out
/// farthest, by ever smaller steps (Badoiu and Clarkson, SODA 2003).
fn bounding(balls: &[(usize, Ball)]) -> Ball {
    if let [(_, only)] = balls {
        return *only;
    }
    let (low, high) = bounds(balls.iter().flat_map(|(_, ball)| ball.corners()));
    let mut center = add(scale(low, 0.5), scale(high, 0.5));
    let mut best = farthest(balls, center);
    let mut bound = (center, best.0);
    for step in 2..STEPS + 2 {
        let (reach, at) = best;
        let ball = &balls[at].1;
        let toward = subtract(ball.center, center);
        let length = reach - ball.radius;
        if length <= 0.0 {
            break;
        }
        // The far point of the ball is `reach` away; the step goes a share of that.
        let share = reach / length / f64::from(step);
        center = along(center, share, toward);
        best = farthest(balls, center);
        if best.0 < bound.1 {
            bound = (center, best.0);
        }
    }
    // Rounding must not let a ball peep out.
    Ball::new(bound.0, bound.1 * (1.0 + 4.0 * f64::EPSILON))
}

/// How far the balls reach out from a point, and which of them does.
fn farthest(balls: &[(usize, Ball)], center: [f64; 3]) -> (f64, usize) {
    let mut best = (0.0, 0);
    for (at, (_, ball)) in balls.iter().enumerate() {
        let reach = distance(ball.center, center) + ball.radius;
        if reach > best.0 {
            best = (reach, at);
        }
    }
    best
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Balls in no order, of very different size.
    pub fn jumbled(count: i32, seed: f64) -> Vec<Ball> {
        let part = |i: i32, step: f64| (seed + f64::from(i) * step).fract();
        let ball = |i| Ball {
            center: [
                3.0 * part(i, 0.8191) - 1.5,
                2.0 * part(i, 0.6710) - 1.0,
                part(i, 0.5497) - 0.5,
            ],
            radius: 0.002 + 0.3 * part(i, 0.4503).powi(6),
        };
        (1..=count).map(ball).collect()
    }

    #[test]
    fn every_node_holds_its_balls_and_knows_the_largest() {
        for count in [1, 2, 4, 5, 300] {
            let given = jumbled(count, 0.3);
            let tree = BallHierarchy::new(&given);
            assert_eq!(tree.balls().len(), given.len());
            for (ball, &number) in tree.balls().iter().zip(tree.order()) {
                assert_eq!(*ball, given[number as usize]);
            }
            for (at, node) in tree.nodes().iter().enumerate() {
                let members = tree.members(node);
                assert!(
                    members
                        .iter()
                        .all(|ball| node.bound.grown(1e-14).holds(ball))
                );
                let radii = members.iter().map(|ball| ball.radius);
                let largest = tree.balls()[node.largest as usize].radius;
                assert_eq!(largest, radii.fold(0.0, f64::max), "node {at} of {count}");
                if node.second > 0 {
                    let (one, other) = (&tree.nodes()[at + 1], &tree.nodes()[node.second as usize]);
                    assert_eq!(
                        (one.first, one.first + one.count),
                        (node.first, other.first)
                    );
                    assert_eq!(one.count + other.count, node.count);
                } else {
                    assert!(members.len() <= LEAF);
                }
            }
        }
        assert!(BallHierarchy::new(&[]).bound().is_none());
    }
}
