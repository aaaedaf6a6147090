//! Distance-greedy packing, after Weller and Zachmann (Inner Sphere Trees, TU Clausthal IfI-08-09, 2008), as B&I
//! compare with.
//!
//! Balls that do not overlap: each has its centre at the node that is farthest from the surface and from all balls
//! before it, and reaches to the nearest of these. It ends when every node inside is in a ball.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::ball::Ball;
use crate::sampling::grid::DepthField;

/// Nearer to a ball or the surface than this, in the solid's unit, a node counts as covered.
const COVERED: f64 = 1e-12;

/// A node and the radius that a ball there would have; the largest first, then the lowest index.
#[derive(Clone, Copy, PartialEq)]
struct Candidate {
    radius: f64,
    node: usize,
}

impl Eq for Candidate {}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.radius
            .total_cmp(&other.radius)
            .then(Reverse(self.node).cmp(&Reverse(other.node)))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The packing, largest ball first.
pub fn pack(field: &DepthField) -> Vec<Ball> {
    let grid = field.grid;
    // Depth below the surface and all balls so far.
    let mut free: Vec<f64> = field.depth.clone();
    let mut queue: BinaryHeap<Candidate> = field
        .inside()
        .into_iter()
        .map(|node| Candidate {
            radius: free[node],
            node,
        })
        .collect();
    let mut balls = Vec::new();
    while let Some(Candidate { radius, node }) = queue.pop() {
        // Entries that a later ball has overtaken stay in the queue.
        if radius != free[node] || radius <= COVERED {
            continue;
        }
        let center = grid.node(node);
        balls.push(Ball { center, radius });
        // No free radius exceeds this one, so a ball farther off than twice it is out of reach.
        grid.visit_ball(center, 2.0 * radius, |other, squared| {
            let left = squared.sqrt() - radius;
            if left < free[other] {
                free[other] = left;
                if left > COVERED {
                    queue.push(Candidate {
                        radius: left,
                        node: other,
                    });
                }
            }
        });
    }
    balls
}
