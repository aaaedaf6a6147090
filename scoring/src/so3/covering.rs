//! The covering radius of a set of rotations.

use super::spiral::rotation;
use nalgebra::UnitQuaternion;

/// Rotations that are compared at a time.
const LANES: usize = 8;

/// Covering radius of a set: the largest angle in radians from any rotation to the nearest of the set.
///
/// Maximised from a fixed sample of starts, so a lower bound, within a few per cent.
pub fn covering_radius(set: &[UnitQuaternion<f64>]) -> f64 {
    // |q.p| is the cosine of half the angle. Eight points at a time, component by component, fill vector registers; the
    // last point fills what is left.
    let points: Vec<[[f32; LANES]; 4]> = set
        .chunks(LANES)
        .map(|chunk| {
            let quaternion = |lane: usize| {
                let q = chunk[lane.min(chunk.len() - 1)];
                [q.w as f32, q.i as f32, q.j as f32, q.k as f32]
            };
            std::array::from_fn(|part| std::array::from_fn(|lane| quaternion(lane)[part]))
        })
        .collect();
    let nearest = |q: &[f32; 4]| -> f32 {
        let mut largest = [0.0f32; LANES];
        for [w, x, y, z] in &points {
            let mut cosines = [0.0f32; LANES];
            for lane in 0..LANES {
                cosines[lane] = w[lane] * q[0] + x[lane] * q[1] + y[lane] * q[2] + z[lane] * q[3];
            }
            for (largest, cosine) in largest.iter_mut().zip(cosines) {
                let cosine = cosine.abs();
                // A comparison: `f32::max` handles NaN and takes three instructions.
                *largest = if cosine > *largest { cosine } else { *largest };
            }
        }
        largest.into_iter().fold(0.0, f32::max)
    };
    // About 4e8 comparisons at most: measuring a set of a million takes no longer than making it.
    let starts = (1_500_000 / set.len().max(1)).clamp(8, 384);
    let mut worst = 1.0f32;
    for start in 0..starts {
        // A spiral of another size samples SO(3) independently of the set.
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
