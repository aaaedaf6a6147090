//! The pairs of parts as solids and as files, and how far a pose is from the right one.

use super::parts::{
    HalfTurnAxis, Pair, Part, broken_block, linked_torus, peg_and_hole, saddle_block,
};
use knotdock::options::SampleGrid;
use knotdock_scoring::se3::Pose;
use knotdock_structures::mesh::{Solid, from_triangles};
use nalgebra::{UnitQuaternion, Vector3};

/// A pair with a clearance of 2 (`eps_A` + `eps_B`) and 1% more for the default grid, whose eps is sqrt(3) / 2 of its
/// spacing. The grid is that of the bounding box as the part comes, so the ligand is measured [`away`].
fn with_least_clearance(pair: fn(f64) -> Pair) -> (Pair, f64) {
    let extent = |points: &mut dyn Iterator<Item = [f64; 3]>| -> f64 {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for point in points {
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        (0..3)
            .map(|axis| high[axis] - low[axis])
            .fold(0.0, f64::max)
    };
    // Parts hardly change with the clearance.
    let close = pair(0.055);
    let turned = close
        .ligand
        .positions
        .iter()
        .map(|&point| away().apply(point));
    let lengths = extent(&mut close.receptor.positions.iter().copied()) + extent(&mut { turned });
    let clearance = 1.01 * 3f64.sqrt() * lengths / (SampleGrid::default().per_axis - 1) as f64;
    (pair(clearance), clearance)
}

/// The peg and its hole, and their clearance.
pub fn peg() -> (Pair, f64) {
    with_least_clearance(peg_and_hole)
}

/// The halves of the torus, and their clearance.
pub fn torus() -> (Pair, f64) {
    with_least_clearance(linked_torus)
}

/// The broken block, and its clearance.
pub fn broken() -> (Pair, f64) {
    with_least_clearance(broken_block)
}

/// The block cut along a saddle, and its clearance.
pub fn saddle() -> (Pair, f64) {
    with_least_clearance(saddle_block)
}

pub fn solid(part: &Part) -> Solid {
    let (mesh, report) = from_triangles(&part.positions, &part.triangles).unwrap();
    assert!(report.is_sound(), "{report:?}");
    Solid::new(&mesh).unwrap()
}

/// The pose that a ligand is moved to before it is docked.
pub fn away() -> Pose {
    Pose::from_parts([0.4, 0.5, -0.6, 0.35], [3.0, -2.0, 1.5])
}

/// Error of a pose that should undo [`away`], in the unit of the parts and in degrees: the least over the symmetries
/// of both parts.
///
/// The distance is that of the middle of the ligand's vertices.
pub fn error(pair: &Pair, pose: &Pose) -> (f64, f64) {
    let together = pose.after(&away());
    let count = pair.ligand.positions.len() as f64;
    let middle: Vector3<f64> = pair
        .ligand
        .positions
        .iter()
        .map(|&point| Vector3::from(point))
        .sum::<Vector3<f64>>()
        / count;
    let with_identity = |axes: &[HalfTurnAxis]| -> Vec<Pose> {
        let mut group = vec![Pose::identity()];
        group.extend(axes.iter().map(half_turn));
        group
    };
    let mut least = (f64::INFINITY, f64::INFINITY);
    for of_receptor in with_identity(&pair.receptor_symmetry) {
        for of_ligand in with_identity(&pair.ligand_symmetry) {
            // Right is any motion that is a symmetry of the ligand, then one of the receptor.
            let right = of_receptor.after(&of_ligand);
            let way = Vector3::from(together.apply(middle.into()))
                - Vector3::from(right.apply(middle.into()));
            let turn = together.angle_to(&right).to_degrees();
            if turn < least.1 {
                least = (way.norm(), turn);
            }
        }
    }
    least
}

fn half_turn(axis: &HalfTurnAxis) -> Pose {
    let direction = nalgebra::Unit::new_normalize(Vector3::from(axis.direction));
    let rotation = UnitQuaternion::from_axis_angle(&direction, std::f64::consts::PI);
    let point = Vector3::from(axis.point);
    Pose {
        rotation,
        translation: point - rotation * point,
    }
}
