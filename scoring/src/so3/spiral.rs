//! Super-Fibonacci spirals of rotations (Alexa, CVPR 2022).
//!
//! Rotation i of n is the unit quaternion (r sin a, r cos a, R sin b, R cos b).
//!
//! With s = i + 1/2: r = sqrt(s / n), R = sqrt(1 - s / n), a = 2 pi s / sqrt 2 and b = 2 pi s / 1.5337511687....

use crate::grid_turn::GridTurn;
use nalgebra::{Quaternion, UnitQuaternion};
use std::f64::consts::PI;

/// Parts of a unit quaternion, (w, x, y, z).
pub(super) type Point = [f64; 4];

/// Root of x^4 = x + 4: the divisor of the second angle.
const TURN: f64 = 1.533_751_168_755_204_3;

/// Rotation `index` of a spiral of `count`.
pub(super) fn rotation(index: usize, count: usize) -> UnitQuaternion<f64> {
    let s = index as f64 + 0.5;
    let t = s / count as f64;
    let (a, b) = (2.0 * PI * s / 2f64.sqrt(), 2.0 * PI * s / TURN);
    let (inner, outer) = (t.sqrt(), (1.0 - t).sqrt());
    UnitQuaternion::from_quaternion(Quaternion::new(
        outer * b.cos(),
        inner * a.sin(),
        inner * a.cos(),
        outer * b.sin(),
    ))
}

/// `count` rotations of a spiral that are nearer to none than their images under the grid's turns are, or a few more.
pub(super) fn domain(count: usize) -> Vec<Point> {
    let images = GridTurn::ALL.len();
    let mut size = images * count;
    loop {
        let points: Vec<Point> = (0..size)
            .map(|index| rotation(index, size))
            .map(|q| [q.w, q.i, q.j, q.k])
            .filter(is_nearest)
            .collect();
        if points.len() >= count {
            return points;
        }
        size += count.max(16) / 16;
    }
}

/// Whether the rotation turns by a smaller angle than each of its images: |w| is the cosine of half the angle.
fn is_nearest(point: &Point) -> bool {
    let images = &GridTurn::ALL[1..];
    images
        .iter()
        .all(|turn| turn.after_parts(*point)[0].abs() < point[0].abs())
}
