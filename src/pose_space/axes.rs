//! Directions of ring axes, near uniform over half a sphere.

use nalgebra::{Unit, UnitQuaternion, Vector3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// `count` axis directions, near uniform over half a sphere.
///
/// They form a spiral of equal steps in height, each rotated by the golden angle (Swinbank and Purser, Q. J. R.
/// Meteorol. Soc. 132 (2006) 1769-1793). The other half holds the same rings, their copies counted the other way.
pub fn axis_set(count: usize) -> Vec<Unit<Vector3<f64>>> {
    let golden = PI * (3.0 - 5f64.sqrt());
    let axis = |index: usize| {
        let height = (index as f64 + 0.5) / count as f64;
        let (radius, angle) = ((1.0 - height * height).sqrt(), golden * index as f64);
        Unit::new_normalize(Vector3::new(
            radius * angle.cos(),
            radius * angle.sin(),
            height,
        ))
    };
    (0..count).map(axis).collect()
}

/// Largest angle in radians from any axis to the nearest of the set; axes have no sign.
///
/// It is computed over a fixed sample of directions, so it is a lower bound, within a few per cent.
pub fn axes_radius(axes: &[Unit<Vector3<f64>>]) -> f64 {
    // About 1e8 comparisons at most.
    let probes = (100_000_000 / axes.len().max(1)).clamp(64, 20_000);
    // Turned away from the set, on whose axes they might lie.
    let away = UnitQuaternion::from_euler_angles(0.3, 1.1, 0.0);
    let nearest = |probe: &Unit<Vector3<f64>>| {
        let probe = away * probe;
        let cosines = axes.iter().map(|axis| axis.dot(&probe).abs());
        cosines.fold(0.0, f64::max)
    };
    let least = axis_set(probes)
        .par_iter()
        .map(nearest)
        .reduce(|| 1.0, f64::min);
    least.min(1.0).acos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n caps of the covering radius cover the half sphere, so their area is at least its own. The set is not much
    /// worse than that.
    #[test]
    fn axes_cover_the_half_sphere_evenly() {
        for count in [20, 300, 900, 3600, 10_000] {
            let axes = axis_set(count);
            let least = (1.0 - 1.0 / count as f64).acos();
            let radius = axes_radius(&axes);
            assert!(
                radius > least && radius < 1.7 * least,
                "{count}: {radius} {least}"
            );
            assert!(axes.iter().all(|axis| axis.z > 0.0));
        }
    }
}
