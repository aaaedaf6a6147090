//! Balls that cover a point: whether one of many holds it, however they crowd.

use crate::neighbours::box_tree::{BoxNode, LEAF, box_tree};

/// A ball as the tree holds it: its centre, its radius, and its place in the list given.
#[derive(Clone, Copy, Debug)]
struct Member {
    center: [f64; 3],
    radius: f64,
    place: usize,
}

/// Balls in a tree of boxes in four dimensions, of their centres and radii.
///
/// A half whose balls all hold a point, or none of which does, is decided by its box. A query therefore takes about
/// logarithmic time also where each of n balls meets all others.
#[derive(Debug)]
pub struct CoveringBalls {
    members: Vec<Member>,
    nodes: Vec<BoxNode<(), 4>>,
}

impl CoveringBalls {
    /// Builds the tree over balls, each a centre and a radius in one unit of length.
    pub fn new(balls: impl IntoIterator<Item = ([f64; 3], f64)>) -> Self {
        let balls = balls.into_iter().enumerate();
        let member = |(place, (center, radius))| Member {
            center,
            radius,
            place,
        };
        let mut members: Vec<Member> = balls.map(member).collect();
        let place = |member: &Member| {
            let [x, y, z] = member.center;
            ([x, y, z, member.radius], member.place)
        };
        let nodes = box_tree(&mut members, LEAF, place, |_| ());
        Self { members, nodes }
    }

    /// Whether a ball other than number `own` holds `point` inside its sphere.
    pub fn covers(&self, point: [f64; 3], own: usize) -> bool {
        !self.nodes.is_empty() && self.covers_below(0, point, own)
    }

    fn covers_below(&self, at: usize, point: [f64; 3], own: usize) -> bool {
        let node = &self.nodes[at];
        let (smallest, largest) = (node.low[3], node.high[3]);
        let [mut nearest, mut farthest] = [0.0; 2];
        for (axis, x) in point.into_iter().enumerate() {
            let below = node.low[axis] - x;
            let above = x - node.high[axis];
            let (near, far) = (below.max(above).max(0.0), below.min(above));
            nearest += near * near;
            farthest += far * far;
        }
        if nearest >= largest * largest {
            return false;
        }
        // Of several balls one at least is not the point's own.
        if node.count > 1 && farthest < smallest * smallest {
            return true;
        }
        if node.second == 0 {
            let members = &self.members[node.first..node.first + node.count];
            return members.iter().any(|ball| {
                ball.place != own && squared(ball.center, point) < ball.radius * ball.radius
            });
        }
        self.covers_below(at + 1, point, own) || self.covers_below(node.second, point, own)
    }
}

fn squared(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against every ball in turn: sparse, crowded and coincident balls, of one radius and of several.
    #[test]
    fn the_tree_agrees_with_every_ball_in_turn() {
        for (spread, radii) in [(9.0, [1.0, 2.0]), (0.5, [1.5, 1.5]), (0.0, [1.0, 1.1])] {
            let place = |i: usize, step: f64| spread * (step * i as f64).sin();
            let ball = |i: usize| {
                let center = [place(i, 1.3), place(i, 2.1), place(i, 0.7)];
                (center, radii[i % 2])
            };
            let balls: Vec<_> = (0..150).map(ball).collect();
            let tree = CoveringBalls::new(balls.iter().copied());
            for own in 0..150 {
                let point = [
                    place(own, 3.1) + 1.0,
                    place(own, 1.1),
                    0.9 * place(own, 0.3),
                ];
                let others = balls.iter().enumerate().filter(|(place, _)| *place != own);
                let expected = others
                    .map(|(_, ball)| ball)
                    .any(|&(center, radius)| squared(center, point) < radius * radius);
                assert_eq!(tree.covers(point, own), expected);
            }
        }
        assert!(!CoveringBalls::new([]).covers([0.0; 3], 0));
        assert!(!CoveringBalls::new([([0.0; 3], 1.0)]).covers([0.0; 3], 0));
    }
}
