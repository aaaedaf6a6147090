//! The frame of the grid: how the receptor is turned in the box.
//!
//! The box holds the receptor's bounding box, and the ligand on all sides of it. A receptor that is askew has a large
//! one. Turned well it needs fewer points, and where its box is as long in y as in z, quarter turns about x share the
//! ligand's transform among eight rotations instead of four ([`crate::grid_turn`]).

use super::grid::Extents;
use crate::so3::spiral_set;
use knotdock_structures::Knots;
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use rayon::prelude::*;

/// Frames that are tried: about 10 degrees apart, since turns of a box onto itself change nothing.
const FRAMES: usize = 1024;
/// Rotations along whose axes the receptor's outermost knots are looked for.
const DIRECTIONS: usize = 64;
/// Time of a rotation of eight that share a transform, over that of one of four, on one grid (cargo bench --bench
/// rotation, 7 components: 0.77 for 1PPE, 0.75 for 1AHW).
const SHARE_OF_EIGHT: f64 = 0.77;

/// The frame in which `points` points of a grid cost least, if it costs less than the one that the extents are of:
/// `size` gives the grid's points on each axis.
pub(super) fn best_frame(
    receptor: &Knots,
    extents: &Extents,
    size: impl Fn(&Extents) -> Option<[usize; 3]> + Sync,
) -> Option<UnitQuaternion<f64>> {
    let outermost = outermost(receptor);
    let cost = |extents: &Extents| {
        let size = size(extents)?;
        let points: f64 = size.iter().map(|&n| n as f64).product();
        // Of equal grids the one with the most room.
        let volume: f64 = extents.receptor_extent.iter().product();
        let share = if size[1] == size[2] {
            SHARE_OF_EIGHT
        } else {
            1.0
        };
        Some((share * points, volume))
    };
    let least = cost(extents)?;
    // The axes in turn: (x, y, z) to (y, z, x).
    let cycle = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(
        nalgebra::Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0),
    ));
    let turned = spiral_set(8 * FRAMES).into_iter().step_by(8);
    let frames = turned.flat_map(|turned| [turned, cycle * turned, cycle * cycle * turned]);
    let frames: Vec<UnitQuaternion<f64>> = frames.collect();
    let costs = frames.par_iter();
    let costs = costs.map(|&frame| cost(&extents.turned(&outermost, frame)));
    let costs: Vec<Option<(f64, f64)>> = costs.collect();
    // Of equal ones the first.
    let mut best = (least, None);
    for (&frame, found) in frames.iter().zip(costs) {
        if let Some(found) = found
            && found < best.0
        {
            best = (found, Some(frame));
        }
    }
    best.1
}

/// The knots that lie outermost along some directions: enough to compare boxes by.
fn outermost(receptor: &Knots) -> Vec<[f64; 3]> {
    let rotations = spiral_set(8 * DIRECTIONS);
    let extremes = rotations.par_iter().step_by(8).flat_map_iter(|rotation| {
        let matrix = rotation.to_rotation_matrix();
        (0..3).flat_map(move |axis| {
            let row = matrix.matrix().row(axis).transpose();
            let along = |x: &[f64; 3]| row.dot(&Vector3::from(*x));
            let by = |a: &&[f64; 3], b: &&[f64; 3]| along(a).total_cmp(&along(b));
            let centers = || receptor.centers.iter();
            [centers().min_by(by), centers().max_by(by)]
        })
    });
    let mut kept: Vec<[f64; 3]> = extremes.flatten_iter().copied().collect();
    kept.sort_unstable_by(|a, b| {
        let order = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
        order.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
    });
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{EngineOptions, Plan};
    use crate::test_support::Numbers;

    /// A rod that lies askew in its file fits into a box that is long in x alone.
    #[test]
    fn a_rod_is_laid_along_x() {
        let mut numbers = Numbers(5);
        let askew = UnitQuaternion::from_euler_angles(0.7, -0.5, 0.6);
        let centers: Vec<[f64; 3]> = (0..600)
            .map(|_| {
                let [x, y, z] = std::array::from_fn(|_| 2.0 * numbers.next() - 1.0);
                (askew * Vector3::new(60.0 * x, 8.0 * y, 8.0 * z)).into()
            })
            .collect();
        let rod = Knots::new(centers, vec![1.7; 600]).unwrap();
        let ball = Knots::new(vec![[0.0; 3], [6.0, 0.0, 0.0]], vec![1.7; 2]).unwrap();
        let plan = Plan::new(&rod, &ball, EngineOptions::default()).unwrap();
        let fitted = plan.fitted(&rod).unwrap();
        let points = |plan: &Plan| plan.size().iter().product::<usize>();
        assert!(2 * points(&fitted) < points(&plan), "{:?}", fitted.size());
        let [nx, ny, nz] = fitted.size();
        assert!(ny == nz && nx > 2 * ny, "{:?}", fitted.size());
        assert!(fitted.modes().has_quarter_turns());
        let axis = fitted.frame() * (askew * Vector3::x());
        assert!(axis.x.abs() > 0.97, "{axis}");
    }
}
