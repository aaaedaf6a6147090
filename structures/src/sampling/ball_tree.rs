//! A tree of boxes over balls that answers how far a point is from their union.

use crate::ball::Ball;
use crate::mesh::vector::{distance, dot};

/// Balls in a leaf.
const LEAF: usize = 8;

/// A binary tree over balls, halved at the median of the longest of the ranges of x, y, z and radius.
#[derive(Debug)]
pub struct BallTree {
    balls: Vec<Ball>,
    /// Nodes in depth-first order.
    nodes: Vec<Node>,
}

/// Some balls, the box of their centres and the box around them.
#[derive(Debug)]
struct Node {
    center_low: [f64; 3],
    center_high: [f64; 3],
    low: [f64; 3],
    high: [f64; 3],
    largest: f64,
    first: u32,
    count: u32,
    /// The second half; the first follows this node. Zero in a leaf.
    second: u32,
}

impl Node {
    /// No ball of the node is nearer than this to `point`, in the sense of [`BallTree::distance`].
    fn bound(&self, point: [f64; 3]) -> f64 {
        let beyond = |low: &[f64; 3], high: &[f64; 3]| {
            let beyond = [0, 1, 2].map(|axis| {
                (low[axis] - point[axis])
                    .max(point[axis] - high[axis])
                    .max(0.0)
            });
            dot(beyond, beyond)
        };
        let centers = beyond(&self.center_low, &self.center_high).sqrt() - self.largest;
        let balls = beyond(&self.low, &self.high);
        if balls > 0.0 {
            centers.max(balls.sqrt())
        } else {
            centers
        }
    }
}

impl BallTree {
    /// Builds the tree over any number of balls.
    pub fn new(balls: &[Ball]) -> Self {
        let mut balls = balls.to_vec();
        let mut nodes = Vec::new();
        if !balls.is_empty() {
            build(&mut balls, 0, &mut nodes);
        }
        Self { balls, nodes }
    }

    /// Distance from `point` to the union of the balls, below zero inside one of them (then the depth in the one that
    /// it is deepest in); infinite without balls.
    ///
    /// The search stops at the first ball found within `enough`, so a value up to that says no more than "within".
    pub fn distance(&self, point: [f64; 3], enough: f64) -> f64 {
        let mut best = f64::INFINITY;
        if let Some(root) = self.nodes.first() {
            self.search(0, root.bound(point), point, enough, &mut best);
        }
        best
    }

    /// As [`Self::distance`], never more than `at_most`, which spares the search for what lies farther.
    pub fn distance_within(&self, point: [f64; 3], enough: f64, at_most: f64) -> f64 {
        let mut best = at_most;
        if let Some(root) = self.nodes.first() {
            self.search(0, root.bound(point), point, enough, &mut best);
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
            && self.search_holder(0, ball, |other| {
                let order = (other.radius.total_cmp(&ball.radius).reverse())
                    .then_with(|| compare(other.center, ball.center));
                order.is_lt()
            })
    }

    fn search_holder(&self, at: usize, ball: &Ball, counts: impl Fn(&Ball) -> bool + Copy) -> bool {
        let node = &self.nodes[at];
        if node.second == 0 {
            let first = node.first as usize;
            let balls = &self.balls[first..first + node.count as usize];
            return balls.iter().any(|other| other.holds(ball) && counts(other));
        }
        let halves =
            [at + 1, node.second as usize].map(|half| (half, self.nodes[half].bound(ball.center)));
        let [a, b] = if halves[1].1 < halves[0].1 {
            [halves[1], halves[0]]
        } else {
            halves
        };
        // A holder is as deep about the centre as the ball is large.
        (a.1 <= -ball.radius && self.search_holder(a.0, ball, counts))
            || (b.1 <= -ball.radius && self.search_holder(b.0, ball, counts))
    }

    fn search(&self, at: usize, bound: f64, point: [f64; 3], enough: f64, best: &mut f64) {
        // The root's bound may be below `best` although nothing in it is; a bound equal to it cannot better it.
        if bound >= *best {
            return;
        }
        let node = &self.nodes[at];
        if node.second == 0 {
            let first = node.first as usize;
            for ball in &self.balls[first..first + node.count as usize] {
                *best = best.min(distance(ball.center, point) - ball.radius);
            }
            return;
        }
        let halves =
            [at + 1, node.second as usize].map(|half| (half, self.nodes[half].bound(point)));
        let [a, b] = if halves[1].1 < halves[0].1 {
            [halves[1], halves[0]]
        } else {
            halves
        };
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

/// Order of points by x, then y, then z.
fn compare(a: [f64; 3], b: [f64; 3]) -> std::cmp::Ordering {
    (a[0].total_cmp(&b[0]))
        .then(a[1].total_cmp(&b[1]))
        .then(a[2].total_cmp(&b[2]))
}

fn build(balls: &mut [Ball], first: usize, nodes: &mut Vec<Node>) {
    let mut node = Node {
        center_low: [f64::INFINITY; 3],
        center_high: [f64::NEG_INFINITY; 3],
        low: [f64::INFINITY; 3],
        high: [f64::NEG_INFINITY; 3],
        largest: 0.0,
        first: first as u32,
        count: balls.len() as u32,
        second: 0,
    };
    let mut smallest = f64::INFINITY;
    for &Ball { center, radius } in &*balls {
        node.largest = node.largest.max(radius);
        smallest = smallest.min(radius);
        for (axis, middle) in center.into_iter().enumerate() {
            node.center_low[axis] = node.center_low[axis].min(middle);
            node.center_high[axis] = node.center_high[axis].max(middle);
            node.low[axis] = node.low[axis].min(middle - radius);
            node.high[axis] = node.high[axis].max(middle + radius);
        }
    }
    let range = |axis: usize| match axis {
        3 => node.largest - smallest,
        _ => node.center_high[axis] - node.center_low[axis],
    };
    let axis = (0..4)
        .max_by(|&a, &b| range(a).total_cmp(&range(b)))
        .unwrap_or(0);
    let place = nodes.len();
    nodes.push(node);
    if balls.len() <= LEAF {
        return;
    }
    let middle = balls.len() / 2;
    let key = |ball: &Ball| ball.center.get(axis).copied().unwrap_or(ball.radius);
    balls.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
    let (left, right) = balls.split_at_mut(middle);
    build(left, first, nodes);
    nodes[place].second = nodes.len() as u32;
    build(right, first + middle, nodes);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jumbled(count: u32) -> Vec<Ball> {
        (1..=count)
            .map(|i| {
                let part = |step: f64| (f64::from(i) * step).fract();
                Ball {
                    center: [part(0.8191), part(0.6710), part(0.5497)],
                    radius: 0.02 + 0.3 * part(0.4503).powi(3),
                }
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
                    || other.radius == ball.radius && compare(other.center, ball.center).is_lt();
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
