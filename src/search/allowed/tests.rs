//! Regions against the distances of the poses that their voxels stand for.

use super::*;
use crate::options::DockOptions;
use knotdock_scoring::Precision;
use knotdock_scoring::engine::ReceptorSpectra;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::pose::{DistanceRestraint, DistanceRestraints, Membrane};
use std::sync::Arc;

/// Balls at the corners of a box of which no two edges are alike, about `at`.
fn body(size: [f64; 3], at: f64) -> Knots {
    let corner = |k: usize| -> [f64; 3] {
        [0, 1, 2].map(|axis| at + size[axis] * ((k >> axis & 1) as f64 - 0.5))
    };
    Knots::new((0..8).map(corner).collect(), vec![1.7; 8]).unwrap()
}

/// Compares the regions of `known` at rotations and images of a turned grid with what `is_allowed` says of a pose:
/// nothing where rounding decides. Returns how many voxels were allowed, and how many not.
fn compare(
    restraints: &DistanceRestraints,
    membrane: Option<&Membrane>,
    is_allowed: impl Fn([&Knots; 2], &Pose, f64) -> Option<bool>,
) -> [usize; 2] {
    let (receptor, ligand) = (body([22.0, 14.0, 9.0], 30.0), body([7.0, 12.0, 5.0], -4.0));
    let options = DockOptions::default().kernel.engine();
    let plan = Plan::new(&receptor, &ligand, options).unwrap();
    let plan = Arc::new(plan.fitted(&receptor).unwrap());
    let spectra = ReceptorSpectra::new(
        &plan,
        &receptor,
        &ligand,
        Quantity::Score,
        Precision::Single,
    );
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &ligand, 1);
    let known = SearchRestraints {
        restraints,
        membrane,
        knots: [&receptor, &ligand],
    };
    let allowed = Allowed::new(known, &plan, 0.0).unwrap();
    let between = 0.5 * 3f64.sqrt() * plan.spacing();
    let regions = allowed.regions(&engine);
    let mut region = Region::default();
    let start = UnitQuaternion::from_euler_angles(0.4, -1.0, 2.2);
    let mut seen = [0; 2];
    for &turn in GridTurn::of(plan.modes()) {
        let frame = plan.frame();
        let rotation = frame.inverse() * turn.after(&(frame * start));
        regions.at(&rotation, turn, &mut region);
        for (voxel, allowed) in region.allowed().into_iter().enumerate() {
            let place = plan.receptor_center() + engine.position_after(turn, voxel);
            let pose = Pose::about(rotation, plan.ligand_center(), place);
            if let Some(expected) = is_allowed([&receptor, &ligand], &pose, between) {
                assert_eq!(allowed, expected, "{turn:?} {voxel}");
                seen[usize::from(!expected)] += 1;
            }
        }
    }
    seen
}

/// Every voxel whose pose brings two atoms within the ball's radius is allowed, and no other.
#[test]
fn allowed_voxels_are_those_whose_poses_satisfy() {
    let restraint = |a: usize, b: usize| DistanceRestraint {
        pairs: vec![[vec![a], vec![b]]],
        lower: 0.0,
        upper: 9.0,
    };
    let restraints = DistanceRestraints {
        list: vec![restraint(3, 0), restraint(1, 6)],
        needed: 2,
    };
    let seen = compare(&restraints, None, |[receptor, ligand], pose, between| {
        let distance = |restraint: &DistanceRestraint| {
            restraint.effective_distance(&receptor.centers, &ligand.centers, pose)
        };
        let worst = restraints.list.iter().map(distance).fold(0.0, f64::max);
        let beyond = worst - (9.0 + between);
        (beyond.abs() > 1e-4).then_some(beyond < 0.0)
    });
    assert!(seen.iter().all(|&count| count > 100), "{seen:?}");
}

/// Every voxel is allowed whose pose lies no deeper in a membrane than the samples leave open, of either side.
#[test]
fn allowed_voxels_are_those_outside_of_a_membrane() {
    for membrane in [
        Membrane {
            side: 0,
            low: 27.0,
            high: 34.0,
        },
        Membrane {
            side: 1,
            low: -6.0,
            high: -1.0,
        },
    ] {
        let none = DistanceRestraints::none();
        let seen = compare(none, Some(&membrane), |knots, pose, between| {
            let pose = match membrane.side {
                0 => *pose,
                _ => pose.inverse(),
            };
            let z = knots[1 - membrane.side].centers.iter();
            let z: Vec<f64> = z.map(|x| pose.apply(*x)[2]).collect();
            let lowest = z.iter().copied().fold(f64::INFINITY, f64::min);
            let highest = z.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let beyond = membrane.depth(lowest, highest) - between;
            (beyond.abs() > 1e-4).then_some(beyond < 0.0)
        });
        assert!(seen.iter().all(|&count| count > 1000), "{seen:?}");
    }
}
