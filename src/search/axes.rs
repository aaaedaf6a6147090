//! Axes for rings: directions over half a sphere, and the grid's voxels whose poses turn about such an axis without sliding along it.

use knotdock_scoring::engine::CpuEngine;
use knotdock_scoring::transform::Real;
use nalgebra::{Unit, UnitQuaternion, Vector3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Directions of axes, near uniform over half a sphere: a spiral of equal steps in height, each turned on by the golden angle (Swinbank and
/// Purser, Q. J. R. Meteorol. Soc. 132 (2006) 1769-1793). The other half holds the same rings with their copies counted the other way.
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

/// Largest angle in radians from any axis to the nearest of the set, an axis having no sign: over a fixed sample of directions, so a lower bound that is
/// within a few per cent.
pub fn axes_radius(axes: &[Unit<Vector3<f64>>]) -> f64 {
    // About 1e8 comparisons at most.
    let probes = (100_000_000 / axes.len().max(1)).clamp(64, 20_000);
    let nearest = |probe: &Unit<Vector3<f64>>| {
        let cosines = axes.iter().map(|axis| axis.dot(probe).abs());
        cosines.fold(0.0, f64::max)
    };
    let least = axis_set(probes)
        .par_iter()
        .map(nearest)
        .reduce(|| 1.0, f64::min);
    least.min(1.0).acos()
}

/// Where voxels lie, to tell those whose poses make rings.
pub(super) struct RingVoxels {
    /// Position of the ligand's centre less the receptor's along each axis of the grid, Å.
    places: [Vec<f64>; 3],
    receptor_center: Vector3<f64>,
    ligand_center: Vector3<f64>,
    spacing: f64,
}

impl RingVoxels {
    /// For the grids of an engine.
    pub fn new<T: Real>(engine: &CpuEngine<T>) -> Self {
        let plan = engine.plan();
        let [nx, ny, nz] = plan.size();
        let along = |axis: usize, count: usize, stride: usize| -> Vec<f64> {
            let place = |index| engine.position(index * stride)[axis];
            (0..count).map(place).collect()
        };
        Self {
            places: [along(0, nx, ny * nz), along(1, ny, nz), along(2, nz, 1)],
            receptor_center: plan.receptor_center,
            ligand_center: plan.ligand_center,
            spacing: plan.spacing,
        }
    }

    /// Leaves of a rotation's grid only voxels through which the plane across the axis runs, on which its poses do not slide along it; the others become
    /// minus infinity, and each row's largest value is found again.
    pub fn keep<T: Real>(
        &self,
        rotation: &UnitQuaternion<f64>,
        grid: &mut [T],
        row_best: &mut [T],
    ) {
        let axis = Unit::new_normalize(rotation.imag());
        let [along_x, along_y, along_z] = &self.places;
        // How far along the axis a ligand is moved whose centre lies on the receptor's.
        let start = axis.dot(&(self.receptor_center - rotation * self.ligand_center));
        let reach = 0.5 * self.spacing * (axis.x.abs() + axis.y.abs() + axis.z.abs());
        let rows = grid.chunks_exact_mut(along_z.len()).zip(row_best);
        for (index, (row, best)) in rows.enumerate() {
            let (x, y) = (
                along_x[index / along_y.len()],
                along_y[index % along_y.len()],
            );
            let slide = start + axis.x * x + axis.y * y;
            *best = T::neg_infinity();
            for (value, z) in row.iter_mut().zip(along_z) {
                if (slide + axis.z * z).abs() > reach {
                    *value = T::neg_infinity();
                }
                *best = best.max(*value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n caps of the covering radius hide the half sphere, so that their area is at least its own; and the set is not much worse than that.
    #[test]
    fn axes_cover_the_half_sphere_evenly() {
        for count in [20, 300, 900, 3600] {
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
