//! Regions against the distances of the poses that their voxels stand for.

use super::*;
use crate::options::DockOptions;
use knotdock_scoring::engine::ReceptorSpectra;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::pose::DistanceRestraint;
use std::sync::Arc;

/// Balls at the corners of a box of which no two edges are alike, about `at`.
fn body(size: [f64; 3], at: f64) -> Knots {
    let corner = |k: usize| -> [f64; 3] {
        [0, 1, 2].map(|axis| at + size[axis] * ((k >> axis & 1) as f64 - 0.5))
    };
    Knots::new((0..8).map(corner).collect(), vec![1.7; 8]).unwrap()
}

/// Every voxel whose pose brings two atoms within the ball's radius is allowed, and no other, at rotations and images
/// of a turned grid.
#[test]
fn allowed_voxels_are_those_whose_poses_satisfy() {
    let (receptor, ligand) = (body([22.0, 14.0, 9.0], 30.0), body([7.0, 12.0, 5.0], -4.0));
    let options = DockOptions::default().kernel.engine();
    let plan = Plan::new(&receptor, &ligand, options).unwrap();
    let plan = Arc::new(plan.fitted(&receptor).unwrap());
    let spectra = ReceptorSpectra::<f32>::new(&plan, &receptor, &ligand, Quantity::Score);
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &ligand, 1);
    let restraint = |a: usize, b: usize| DistanceRestraint {
        pairs: vec![[vec![a], vec![b]]],
        lower: 0.0,
        upper: 9.0,
    };
    let restraints = DistanceRestraints {
        list: vec![restraint(3, 0), restraint(1, 6)],
        needed: 2,
    };
    let allowed = Allowed::new(&restraints, [&receptor, &ligand], &plan, 0.0);
    let reach = 9.0 + 0.5 * 3f64.sqrt() * plan.spacing();
    let regions = allowed.regions(&engine);
    let mut region = Region::default();
    let size = plan.size();
    let start = UnitQuaternion::from_euler_angles(0.4, -1.0, 2.2);
    let mut seen = 0;
    for &turn in GridTurn::of(plan.modes()) {
        let frame = plan.frame();
        let rotation = frame.inverse() * turn.after(&(frame * start));
        regions.at(&rotation, turn, &mut region);
        for voxel in 0..size.iter().product() {
            let index = [
                voxel / (size[1] * size[2]),
                voxel / size[2] % size[1],
                voxel % size[2],
            ];
            let place = plan.receptor_center() + engine.position_after(turn, voxel);
            let pose = Pose::about(rotation, plan.ligand_center(), place);
            let distance = |restraint: &DistanceRestraint| {
                restraint.effective_distance(&receptor.centers, &ligand.centers, &pose)
            };
            let worst = restraints.list.iter().map(distance).fold(0.0, f64::max);
            if (worst - reach).abs() > 1e-4 {
                assert_eq!(region.allows(index), worst < reach, "{turn:?} {worst}");
            }
            seen += usize::from(worst < reach);
        }
    }
    assert!(seen > 100, "{seen}");
}
