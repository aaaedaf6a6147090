//! Distance-greedy packing, after Weller and Zachmann (Inner Sphere Trees, TU Clausthal IfI-08-09, 2008), as B&I
//! compare with.
//!
//! Balls that do not overlap: each has its centre at the node that is farthest from the surface and from all balls
//! before it, and reaches to the nearest of these. It ends when every node inside is in a ball.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::ball::Ball;
use crate::sampling::grid::DepthField;

/// Nearer to a ball or the surface than this, in the solid's unit, a node counts as covered.
const COVERED: f64 = 1e-12;

/// The packing, largest ball first.
pub fn pack(field: &DepthField) -> Vec<Ball> {
    let grid = field.grid;
    // Depth below the surface and all balls so far.
    let mut free: Vec<f64> = field.depth.clone();
    // The largest first, then the lowest index; the bits of radii, which are above zero, are in their order.
    let candidate = |radius: f64, node: usize| (radius.to_bits(), Reverse(node));
    let inside = field.inside().into_iter();
    let mut queue: BinaryHeap<_> = inside.map(|node| candidate(free[node], node)).collect();
    let mut balls = Vec::new();
    while let Some((bits, Reverse(node))) = queue.pop() {
        let radius = f64::from_bits(bits);
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
                    queue.push(candidate(left, other));
                }
            }
        });
    }
    balls
}
