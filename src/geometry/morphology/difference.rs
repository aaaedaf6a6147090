//! Minkowski differences by duality.
//!
//! t is in A - B if and only if B + t meets no point outside A: A - B is the complement of (complement of A) + (-B).
//! The complement of A is sampled in a cube that B cannot leave while it touches A's own cube:
//!
//! - balls that hold the complement of A's inner balls, plus -B's outer ones, hold the complement of A - B; so balls
//!   that reach none of them are inside A - B;
//! - balls inside the complement of A's outer balls, plus -B's inner ones, are inside the complement of A - B; so balls
//!   that hold all that these leave free hold A - B.
//!
//! Neither depends on how fine the grids are, only the width of the bracket does.

use knotdock_structures::Error;
use knotdock_structures::sampling::Ball;

use super::MorphologyOptions;
use super::complement::{Cube, hausdorff_bound, holding, inside, needed_in};
use crate::geometry::bracket::{Bracket, bounds};
use crate::geometry::obstacle::pair_sums;
use crate::geometry::obstacle::reduce::reduced_sum;

/// Cells of free space about A, so that nothing of the result touches the cube's faces.
const MARGIN: f64 = 2.0;

/// A - B: the translations t with B + t inside A. Its eps is measured, infinite where no inner ball is left.
///
/// # Errors
/// [`Error`] if memory has no room for the balls.
pub fn difference(a: &Bracket, b: &Bracket, options: &MorphologyOptions) -> Result<Bracket, Error> {
    let (low, high) = b.bounds();
    let middle = [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis]));
    let reach = (0..3).map(|axis| 0.5 * (high[axis] - low[axis]));
    let reach = reach.fold(0.0, f64::max);
    let reflected = |balls: &[Ball]| -> Vec<Ball> {
        let balls = balls.iter().map(|ball| Ball {
            center: [0, 1, 2].map(|axis| middle[axis] - ball.center[axis]),
            radius: ball.radius,
        });
        balls.collect()
    };
    let result = Cube::about(bounds(&a.outer), options.per_axis, MARGIN);
    let around = result.wider(reach);
    let origin = [0, 1, 2].map(|axis| a.origin[axis] - b.origin[axis] - middle[axis]);
    // The balls of a sum, the larger of the first summand first.
    let sum = |mut outside: Vec<Ball>, others: &[Ball]| {
        let others = reflected(others);
        outside.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        let balls = needed_in(&result, pair_sums(&outside, &others, 0.0));
        options.room_for(balls.len() as u64).map(|()| balls)
    };
    let inner = if a.inner.is_empty() {
        Vec::new()
    } else {
        let blocked = sum(holding(&a.inner, &around), &b.outer)?;
        inside(&blocked, &result)
    };
    let outer = if b.inner.is_empty() {
        // Only the outer balls of B are known: A - B is inside A + (-B).
        let others = reflected(&b.outer);
        options.room_for(a.outer.len() as u64 * others.len() as u64)?;
        reduced_sum(&a.outer, &others, 0.0)
    } else {
        let blocked = sum(inside(&a.outer, &around), &b.inner)?;
        holding(&blocked, &result)
    };
    let epsilon = hausdorff_bound(&inner, &outer, options.per_axis);
    Ok(Bracket {
        origin,
        inner,
        outer,
        epsilon,
    })
}
