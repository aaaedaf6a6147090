//! A tree of boxes over balls that answers how far a point is from their union.

use crate::ball::{Ball, largest_first};
use crate::neighbours::box_tree::{BoxNode, LEAF, box_tree};
use crate::vector::{bounds, distance, squared_distance_to_box};

/// A tree over balls of boxes in four dimensions, of their centres and radii.
#[derive(Debug)]
pub struct BallTree {
    balls: Vec<Ball>,
    nodes: Vec<Node>,
}

type Node = BoxNode<([f64; 3], [f64; 3]), 4>;

/// No ball of a node is nearer than this to `point`, in the sense of [`BallTree::distance`].
fn bound(node: &Node, point: [f64; 3]) -> f64 {
    let centers = squared_distance_to_box(&node.low, &node.high, point).sqrt() - node.high[3];
    let (low, high) = &node.known;
    let balls = squared_distance_to_box(low, high, point);
    if balls > 0.0 {
        centers.max(balls.sqrt())
    } else {
        centers
    }
}

impl BallTree {
    /// Builds the tree over any number of balls.
    pub fn new(balls: &[Ball]) -> Self {
        let mut numbered: Vec<(usize, Ball)> = balls.iter().copied().enumerate().collect();
        let place = |(number, ball): &(usize, Ball)| {
            let [x, y, z] = ball.center;
            ([x, y, z, ball.radius], *number)
        };
        let nodes = box_tree(&mut numbered, LEAF, place, |balls| {
            bounds(balls.iter().flat_map(|(_, ball)| ball.corners()))
        });
        let balls = numbered.into_iter().map(|(_, ball)| ball).collect();
        Self { balls, nodes }
    }

    /// Distance from `point` to the union of the balls, below zero inside one of them (then the depth in the one that
    /// it is deepest in); infinite without balls.
    ///
    /// The search stops at the first ball found within `enough`, so a value up to that says no more than "within".
    pub fn distance(&self, point: [f64; 3], enough: f64) -> f64 {
        self.distance_within(point, enough, f64::INFINITY)
    }

    /// As [`Self::distance`], never more than `at_most`, which spares the search of farther balls.
    pub fn distance_within(&self, point: [f64; 3], enough: f64, at_most: f64) -> f64 {
        let mut best = at_most;
        if let Some(root) = self.nodes.first() {
            self.search(0, bound(root, point), point, enough, &mut best);
        }
        best
    }

    /// Whether one ball of the tree holds all of `ball`, itself included.
    pub fn holds(&self, ball: &Ball) -> bool {
        !self.nodes.is_empty() && self.search_holder(0, ball, |_| true)
    }

    /// Whether a ball of the tree that comes before `ball` holds all of it. The larger comes first, then the one of
    /// the lesser centre, so that of several equal in all but rounding one is always held by none.
    pub fn holds_before(&self, ball: &Ball) -> bool {
        !self.nodes.is_empty()
            && self.search_holder(0, ball, |other| largest_first(other, ball).is_lt())
    }

    fn search_holder(&self, at: usize, ball: &Ball, counts: impl Fn(&Ball) -> bool + Copy) -> bool {
        let node = &self.nodes[at];
        if node.second == 0 {
            let balls = &self.balls[node.first..node.first + node.count];
            return balls.iter().any(|other| other.holds(ball) && counts(other));
        }
        let [a, b] = self.halves(at, ball.center);
        // A holder is as deep about the centre as the ball is large.
        (a.1 <= -ball.radius && self.search_holder(a.0, ball, counts))
            || (b.1 <= -ball.radius && self.search_holder(b.0, ball, counts))
    }

    /// The halves of a node with their bounds, the nearer one first.
    fn halves(&self, at: usize, point: [f64; 3]) -> [(usize, f64); 2] {
        let (first, second) = (at + 1, self.nodes[at].second);
        let a = (first, bound(&self.nodes[first], point));
        let b = (second, bound(&self.nodes[second], point));
        if b.1 < a.1 { [b, a] } else { [a, b] }
    }

    fn search(&self, at: usize, bound: f64, point: [f64; 3], enough: f64, best: &mut f64) {
        // The root's bound may be below `best` although nothing in it is; a bound equal to it cannot better it.
        if bound >= *best {
            return;
        }
        let node = &self.nodes[at];
        if node.second == 0 {
            for ball in &self.balls[node.first..node.first + node.count] {
                *best = best.min(distance(ball.center, point) - ball.radius);
            }
            return;
        }
        let [a, b] = self.halves(at, point);
        self.search(a.0, a.1, point, enough, best);
        if *best > enough {
            self.search(b.0, b.1, point, enough, best);
        }
    }

    /// Whether `point` is in a ball.
    pub fn contains(&self, point: [f64; 3]) -> bool {
        self.distance(point, 0.0) <= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jumbled(count: u32) -> Vec<Ball> {
        (1..=count)
            .map(|i| {
                let part = |step: f64| (f64::from(i) * step).fract();
                Ball::new(
                    [part(0.8191), part(0.6710), part(0.5497)],
                    0.02 + 0.3 * part(0.4503).powi(3),
                )
            })
            .collect()
    }

    #[test]
    fn balls_are_held_as_trying_all_says() {
        let mut balls = jumbled(700);
        // Copies hold each other: one of them is held by none before it.
        balls.extend_from_within(..50);
        let tree = BallTree::new(&balls);
        for ball in &balls {
            let larger = balls.iter().any(|other| {
                let first = other.radius > ball.radius
                    || other.radius == ball.radius
                        && crate::vector::compare(other.center, ball.center).is_lt();
                first && other.holds(ball)
            });
            assert_eq!(tree.holds_before(ball), larger);
            assert!(tree.holds(ball));
            assert!(!tree.holds(&ball.grown(0.4)));
        }
        assert!(!BallTree::new(&[]).holds(&balls[0]));
    }

    #[test]
    fn a_bounded_distance_is_the_distance_or_the_bound() {
        let balls = jumbled(300);
        let tree = BallTree::new(&balls);
        for place in jumbled(100) {
            let point = place.center.map(|part| 2.0 * part - 0.5);
            let exact = tree.distance(point, f64::NEG_INFINITY);
            for at_most in [-0.2, 0.0, 0.1, 1.0] {
                let found = tree.distance_within(point, f64::NEG_INFINITY, at_most);
                assert_eq!(found, exact.min(at_most));
                let early = tree.distance_within(point, 0.05, at_most);
                assert!(early == exact.min(at_most) || (exact..=0.05).contains(&early));
            }
        }
    }
}
