//! Voxels of the translation grid whose poses form rings.
//!
//! The grid holds all translations, and a ring allows a plane of them (Cn) or a line (Dn). A voxel stays if that plane
//! or line runs through it; refinement then moves its pose onto the ring.

use knotdock_scoring::engine::CpuEngine;
use knotdock_scoring::peaks::ScoreGrid;
use knotdock_scoring::symmetry::RingAxis;
use nalgebra::{Unit, UnitQuaternion, Vector3};

/// Voxels of a grid whose poses form rings.
pub(crate) struct VoxelFilter {
    /// Position of the ligand's centre less the receptor's along each axis of the grid, Å.
    places: [Vec<f64>; 3],
    receptor_center: Vector3<f64>,
    ligand_center: Vector3<f64>,
    spacing: f64,
    /// The axis that must be crossed, of Dn.
    across: Option<RingAxis>,
}

/// A plane through voxels that stay.
struct Layer {
    /// The plane's normal.
    normal: Unit<Vector3<f64>>,
    /// Distance along it of a voxel at the origin of positions from the plane, Å.
    start: f64,
    /// Half of a voxel's extent along it, Å.
    reach: f64,
}

impl VoxelFilter {
    /// The filter for the grids of an engine; `across` is the ring's own axis, of Dn.
    pub fn new(engine: &CpuEngine, across: Option<RingAxis>) -> Self {
        let plan = engine.plan();
        assert_eq!(
            plan.frame(),
            UnitQuaternion::identity(),
            "voxels are found along the axes of the file"
        );
        let [nx, ny, nz] = plan.size();
        let along = |axis: usize, count: usize, stride: usize| -> Vec<f64> {
            let place = |index| engine.position(index * stride)[axis];
            (0..count).map(place).collect()
        };
        Self {
            places: [along(0, nx, ny * nz), along(1, ny, nz), along(2, nz, 1)],
            receptor_center: plan.receptor_center(),
            ligand_center: plan.ligand_center(),
            spacing: plan.spacing(),
            across,
        }
    }

    /// The layer of voxels whose poses move the molecule's origin by `shift` along `normal`.
    fn layer(
        &self,
        rotation: &UnitQuaternion<f64>,
        normal: Unit<Vector3<f64>>,
        shift: f64,
    ) -> Layer {
        // Shift of a ligand whose centre is that of the receptor.
        let from = self.receptor_center - rotation * self.ligand_center;
        Layer {
            normal,
            start: normal.dot(&from) - shift,
            // A plane through the corner of a voxel runs through it, whatever rounding does.
            reach: (0.5 + 1e-12)
                * self.spacing
                * (normal.x.abs() + normal.y.abs() + normal.z.abs()),
        }
    }

    /// Takes voxels whose poses form no ring out of a grid.
    ///
    /// Voxels stay if the plane runs through them on which poses do not slide along the rotation's axis. For Dn the
    /// plane on which that axis crosses the ring's own must run through them, too.
    pub fn restrict(&self, rotation: &UnitQuaternion<f64>, scores: &mut ScoreGrid) {
        let [along_x, along_y, along_z] = &self.places;
        let slide = self.layer(rotation, Unit::new_normalize(rotation.imag()), 0.0);
        let sideways = self.across.map(|across| {
            let (normal, shift) = across.sideways(rotation);
            self.layer(rotation, normal, shift)
        });
        scores.restrict(&mut |row, open| {
            let (x, y) = (along_x[row / along_y.len()], along_y[row % along_y.len()]);
            slide.keep(x, y, along_z, open);
            if let Some(sideways) = &sideways {
                sideways.keep(x, y, along_z, open);
            }
        });
    }
}

impl Layer {
    /// Clears the marks of a row's voxels that the plane does not run through.
    fn keep(&self, x: f64, y: f64, along_z: &[f64], open: &mut [bool]) {
        let from = self.start + self.normal.x * x + self.normal.y * y;
        for (open, z) in open.iter_mut().zip(along_z) {
            *open &= (from + self.normal.z * z).abs() <= self.reach;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::DockOptions;
    use crate::pose_space::axes::axis_set;
    use knotdock_scoring::Precision;
    use knotdock_scoring::engine::{Plan, ReceptorSpectra};
    use knotdock_scoring::quantity::Quantity;
    use knotdock_scoring::se3::Pose;
    use knotdock_scoring::symmetry::Symmetry;
    use knotdock_structures::Knots;
    use std::sync::Arc;

    /// The filter keeps the voxels about whose position the pose can slide both ways along its axis, wherever the
    /// molecule is in its file. The largest value of each row is in that row.
    #[test]
    fn voxels_stay_that_the_plane_across_the_axis_runs_through() {
        let centers = vec![[40.0, -7.0, 3.0], [43.0, -5.0, 1.0], [38.0, -9.0, 7.0]];
        let knots = Knots::new(centers, vec![1.7, 1.8, 1.9]).unwrap();
        let plan =
            Arc::new(Plan::new(&knots, &knots, DockOptions::default().kernel.engine()).unwrap());
        let spectra =
            ReceptorSpectra::new(&plan, &knots, &knots, Quantity::Score, Precision::Double);
        let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &knots, spectra.full_rank());
        let voxels = VoxelFilter::new(&engine, None);
        let [nx, ny, nz] = plan.size();
        let symmetry: Symmetry = "C3".parse().unwrap();
        for axis in &axis_set(7) {
            let rotation = symmetry.rotation(axis);
            let value = |voxel: usize| (voxel * 7919 % 1009) as f32;
            let grid = (0..nx * ny * nz).map(value).collect();
            let mut grid = ScoreGrid::of_scores(plan.size(), grid);
            voxels.restrict(&rotation, &mut grid);
            let mut kept = 0;
            for (voxel, left) in grid.iter().enumerate() {
                let slide = |corner: [f64; 3]| {
                    let place = plan.receptor_center()
                        + engine.position(voxel)
                        + 0.5 * plan.spacing() * Vector3::from(corner);
                    let pose = Pose::about(rotation, plan.ligand_center(), place);
                    axis.dot(&pose.translation)
                };
                let signs = [-1.0, 1.0];
                let corners = signs.map(|x| signs.map(|y| signs.map(|z| slide([x, y, z]))));
                let slides = corners.as_flattened().as_flattened();
                let through = slides.iter().any(|&s| s > -1e-9) && slides.iter().any(|&s| s < 1e-9);
                let expected = if through {
                    f64::from(value(voxel))
                } else {
                    f64::NEG_INFINITY
                };
                assert_eq!(left, expected, "voxel {voxel}");
                kept += usize::from(through);
            }
            // The plane is a layer or so of the box.
            assert!(kept >= nx.min(ny).min(nz).pow(2) && kept < 3 * nx * ny.max(nz));
        }
    }

    /// If the axis must cross a ring's own, the filter keeps the voxels about which the pose also moves a point of
    /// that axis both ways aside. They form a line, which holds the half turns at all heights.
    #[test]
    fn of_two_rings_voxels_along_their_axis_stay() {
        let copies = [1.0, -1.0].map(|side| {
            let cloud = [[9.0, 2.0, 3.0], [12.0, -3.0, 9.0], [15.0, 4.0, -6.0]];
            let place = |[x, y, z]: [f64; 3]| [40.0 + side * x, side * y - 7.0, 3.0 + z];
            cloud.map(place).to_vec()
        });
        let axis = RingAxis::of(&copies).unwrap();
        let knots = Knots::new(copies.concat(), vec![1.7; 6]).unwrap();
        let plan =
            Arc::new(Plan::new(&knots, &knots, DockOptions::default().kernel.engine()).unwrap());
        let spectra =
            ReceptorSpectra::new(&plan, &knots, &knots, Quantity::Score, Precision::Double);
        let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &knots, spectra.full_rank());
        let [nx, ny, nz] = plan.size();
        let symmetry: Symmetry = "D2".parse().unwrap();
        for across in axis.across(5) {
            let rotation = symmetry.rotation(&across);
            let keep = |crossing| {
                let mut grid = ScoreGrid::of_scores(plan.size(), vec![1.0; nx * ny * nz]);
                VoxelFilter::new(&engine, crossing).restrict(&rotation, &mut grid);
                grid.iter().map(|value| value == 1.0).collect::<Vec<_>>()
            };
            let (line, layer) = (keep(Some(axis)), keep(None));
            let mut heights = Vec::new();
            for voxel in (0..line.len()).filter(|&voxel| line[voxel]) {
                assert!(layer[voxel]);
                let place = plan.receptor_center() + engine.position(voxel);
                let pose = Pose::about(rotation, plan.ligand_center(), place);
                let off = axis.nearest(&pose).translation - pose.translation;
                assert!(off.norm() < 1.8 * plan.spacing(), "{off}");
                heights.push(pose.translation.z);
            }
            // The ring's axis is that of z, along which the voxels go from end to end.
            heights.sort_by(f64::total_cmp);
            assert!(heights.len() >= nz && heights.len() < 6 * nz);
            assert!(
                heights
                    .windows(2)
                    .all(|pair| pair[1] - pair[0] < 1.5 * plan.spacing())
            );
        }
    }
}
