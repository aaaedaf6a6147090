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
    use crate::search::DockOptions;
    use knotdock_scoring::engine::{Folded, Plan};
    use knotdock_scoring::lifted_axis::Fold;
    use knotdock_scoring::se3::Pose;
    use knotdock_scoring::symmetry::Cyclic;
    use knotdock_structures::Knots;
    use std::sync::Arc;

    /// The voxels that stay are those about whose position the pose can slide both ways along its axis, wherever the molecule stands in its file; and each
    /// row's largest value is its own.
    #[test]
    fn voxels_stay_that_the_plane_across_the_axis_runs_through() {
        let centers = vec![[40.0, -7.0, 3.0], [43.0, -5.0, 1.0], [38.0, -9.0, 7.0]];
        let knots = Knots::new(centers, vec![1.7, 1.8, 1.9]).unwrap();
        let plan = Arc::new(Plan::new(&knots, &knots, DockOptions::default().engine()).unwrap());
        let folded = Folded::<f64>::new(&plan, &knots, &knots, Fold::Score);
        let engine = CpuEngine::new(Arc::clone(&plan), &folded, &knots, folded.full_rank());
        let voxels = RingVoxels::new(&engine);
        let [nx, ny, nz] = plan.size();
        let symmetry: Cyclic = "C3".parse().unwrap();
        for axis in &axis_set(7) {
            let rotation = symmetry.rotation(axis);
            let value = |voxel: usize| (voxel * 7919 % 1009) as f64;
            let mut grid: Vec<f64> = (0..nx * ny * nz).map(value).collect();
            let mut rows = vec![f64::INFINITY; nx * ny];
            voxels.keep(&rotation, &mut grid, &mut rows);
            let mut kept = 0;
            for (voxel, &left) in grid.iter().enumerate() {
                let slide = |corner: [f64; 3]| {
                    let place = plan.receptor_center
                        + engine.position(voxel)
                        + 0.5 * plan.spacing * Vector3::from(corner);
                    let pose = Pose::about(rotation, plan.ligand_center, place);
                    axis.dot(&pose.translation)
                };
                let signs = [-1.0, 1.0];
                let corners = signs.map(|x| signs.map(|y| signs.map(|z| slide([x, y, z]))));
                let slides = corners.as_flattened().as_flattened();
                let through = slides.iter().any(|&s| s > -1e-9) && slides.iter().any(|&s| s < 1e-9);
                let expected = if through {
                    value(voxel)
                } else {
                    f64::NEG_INFINITY
                };
                assert_eq!(left, expected, "voxel {voxel}");
                kept += usize::from(through);
            }
            // The plane is a layer or so of the box.
            assert!(kept >= nx.min(ny).min(nz).pow(2) && kept < 3 * nx * ny.max(nz));
            for (row, best) in grid.chunks_exact(nz).zip(&rows) {
                assert_eq!(*best, row.iter().copied().fold(f64::NEG_INFINITY, f64::max));
            }
        }
    }

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
