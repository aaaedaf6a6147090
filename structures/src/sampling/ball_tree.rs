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
