//! A deterministic near-uniform set of rotations of any size, and its covering radius.
//!
//! Super-Fibonacci spirals (Alexa, CVPR 2022): rotation i of n is the unit quaternion
//! (r sin a, r cos a, R sin b, R cos b) with s = i + 1/2, r = sqrt(s/n), R = sqrt(1 - s/n), a = 2 pi s / sqrt 2 and b = 2 pi s / 1.5337511687....

use nalgebra::{Quaternion, UnitQuaternion};
use std::f64::consts::PI;

/// Root of x^4 = x + 4, the second turning rate.
const TURN: f64 = 1.533_751_168_755_204_3;

/// Rotation `index` of a set of `count`.
pub fn rotation(index: usize, count: usize) -> UnitQuaternion<f64> {
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

/// The whole set.
pub fn rotation_set(count: usize) -> Vec<UnitQuaternion<f64>> {
    (0..count).map(|index| rotation(index, count)).collect()
}

/// Largest angle in radians from any rotation to the nearest of the set: measured by climbing away from the set from a fixed
/// sample of starts, so a lower bound that is within a few per cent.
pub fn covering_radius(set: &[UnitQuaternion<f64>]) -> f64 {
    // 4 x 4 f32 dot products: |q.p| is the cosine of half the angle.
    let points: Vec<[f32; 4]> = set
        .iter()
        .map(|q| [q.w as f32, q.i as f32, q.j as f32, q.k as f32])
        .collect();
    let nearest = |q: &[f32; 4]| -> f32 {
        points
            .iter()
            .map(|p| (p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]).abs())
            .fold(0.0, f32::max)
    };
    // About 4e8 comparisons at most, so that a set of a million costs no more to measure than to make.
    let starts = (1_500_000 / points.len().max(1)).clamp(8, 384);
    let mut worst = 1.0f32;
    for start in 0..starts {
        // A spiral of another size is a sample that has nothing to do with the set's own.
        let q = rotation(start, starts);
        let mut best = [q.w as f32, q.i as f32, q.j as f32, q.k as f32];
        let mut cosine = nearest(&best);
        let mut step = 1.5 / (set.len() as f32).cbrt();
        while step > 0.05 / (set.len() as f32).cbrt() {
            let mut moved = false;
            for axis in 0..4 {
                for sign in [-1.0, 1.0] {
                    let mut trial = best;
                    trial[axis] += sign * step;
                    let norm = trial.iter().map(|x| x * x).sum::<f32>().sqrt();
                    trial = trial.map(|x| x / norm);
                    let value = nearest(&trial);
                    if value < cosine {
                        (best, cosine, moved) = (trial, value, true);
                    }
                }
            }
            if !moved {
                step *= 0.5;
            }
        }
        worst = worst.min(cosine);
    }
    2.0 * f64::from(worst.min(1.0)).acos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covers_as_evenly_as_the_field_expects() {
        for count in [60, 500, 3600] {
            let set = rotation_set(count);
            let radius = covering_radius(&set);
            // A ball of angle a holds (a - sin a) / pi of SO(3): no set covers with less than the radius whose ball holds 1 / n.
            let mut least = 0.0f64;
            while (least - least.sin()) / PI < 1.0 / count as f64 {
                least += 1e-4;
            }
            assert!(
                radius > least && radius < 2.2 * least,
                "{count}: {radius} {least}"
            );
        }
    }

    /// Uniform over SO(3): the mean of the rotation matrices vanishes.
    #[test]
    fn mean_rotation_vanishes() {
        let set = rotation_set(3600);
        let sum = set.iter().fold(nalgebra::Matrix3::zeros(), |sum, q| {
            sum + q.to_rotation_matrix().matrix()
        });
        assert!((sum / 3600.0).norm() < 0.02);
    }
}
