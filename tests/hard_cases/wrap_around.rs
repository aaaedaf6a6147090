//! Hard cases of the periodic box: no pose may score through the receptor's image, or a ligand's, beyond the tolerance.
//!
//! The box holds the receptor, the ligand's diameter, and the kernel's effective reach on either side. Once, designs
//! of such engines count the reach only once: a ligand in the gap between receptor and image then scores with both.
//! And the effective reach is one pair's: beyond it the tails of many pairs may add up in step, most so for two plates,
//! whose knots are all at the same distance.

use crate::scene::{Pair, RADII, cloud, engine_options, knots, some_rotation};
use knotdock_scoring::Precision;
use knotdock_scoring::engine::ReceptorSpectra;
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::transform::truncation::Selection;
use knotdock_scoring::truncated::TruncatedCorrelation;
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};
use rayon::prelude::*;

/// A lattice with the given number of knots per axis, spaced like a protein's atoms.
fn lattice(counts: [usize; 3]) -> Knots {
    let mut centers = Vec::new();
    for x in 0..counts[0] {
        for y in 0..counts[1] {
            for z in 0..counts[2] {
                centers.push([x, y, z].map(|n| 2.2 * n as f64));
            }
        }
    }
    knots(centers, &RADII)
}

/// Worst |fast - exact| relative to the best exact score seen. It is over all voxels of the outermost layer on
/// `axis`, where ligand, receptor and image are closest to each other, and over every 31st voxel of the rest.
fn worst(pair: &Pair, rotation: UnitQuaternion<f64>) -> (f64, f64) {
    let work = pair.correlate(&rotation);
    let half = pair.plan.modes().lengths.map(|length| 0.5 * length);
    let errors: Vec<(bool, f64, f64)> = (0..work.scores.count())
        .into_par_iter()
        .filter_map(|voxel| {
            let t = pair.engine.position(voxel);
            let face = (0..3).any(|axis| half[axis] - t[axis].abs() < pair.plan.spacing());
            if !face && voxel % 31 != 0 {
                return None;
            }
            let exact = pair.exact(rotation, voxel);
            Some((face, (work.scores.score(voxel) - exact).abs(), exact))
        })
        .collect();
    let (most, best) = (0..work.scores.count())
        .map(|voxel| (work.scores.score(voxel), voxel))
        .fold((f64::NEG_INFINITY, 0), |a, b| if b.0 > a.0 { b } else { a });
    assert!(most > 0.0);
    let best = pair.exact(rotation, best);
    let share = |face: bool| {
        let own = errors.iter().filter(|error| error.0 == face);
        own.fold(0.0f64, |worst, error| worst.max(error.1)) / best
    };
    (share(true), share(false))
}

/// The ligand sandwiched between the receptor and its image: rods, plates and balls whose ends or faces point across
/// the gap, and one that lies along it. At the faces of the box the exact sum, which has no image, is the true
/// receptor's remaining score.
#[test]
fn a_ligand_between_receptor_and_image_scores_with_neither() {
    let quarter = std::f64::consts::FRAC_PI_4;
    let turns = [
        UnitQuaternion::identity(),
        Pose::from_parts([quarter.cos(), 0.0, quarter.sin(), 0.0], [0.0; 3]).rotation,
    ];
    for (name, receptor, ligand) in [
        ("rod along the gap", lattice([6, 6, 6]), lattice([12, 1, 1])),
        (
            "plate against plate",
            lattice([2, 14, 14]),
            lattice([2, 14, 14]),
        ),
        (
            "plate against ball",
            lattice([2, 14, 14]),
            cloud(60, 8.0, &RADII, 1),
        ),
        (
            "ball against rod",
            cloud(60, 8.0, &RADII, 2),
            lattice([1, 1, 16]),
        ),
        ("small in large", lattice([7, 7, 7]), lattice([1, 1, 1])),
    ] {
        let pair = Pair::new(Precision::Single, &receptor, &ligand, engine_options(1e-2));
        for turn in turns {
            let (face, inside) = worst(&pair, turn);
            println!("{name}: {face:.2e} at the faces, {inside:.2e} elsewhere");
            assert!(
                face <= 1e-2 && inside <= 1e-2,
                "{name}: {face:e} {inside:e}"
            );
        }
    }
}

/// A pose a box length away is far from everything: the field that refinement climbs must not read the receptor's
/// image there.
#[test]
fn the_field_ends_with_the_box() {
    let (a, b) = (cloud(120, 10.0, &RADII, 3), cloud(50, 7.0, &RADII, 4));
    let pair = Pair::new(Precision::Single, &a, &b, engine_options(1e-2));
    let spectra = ReceptorSpectra::new(&pair.plan, &a, &b, Quantity::Score, Precision::Single);
    let field = PotentialGrid::new(&pair.plan, &spectra, &b);
    let rotation = UnitQuaternion::identity();
    let work = pair.correlate(&rotation);
    let (best, score) = work
        .scores
        .iter()
        .enumerate()
        .fold((0, 0.0f64), |a, b| if b.1 > a.1 { b } else { a });
    let pose = pair.pose(rotation, best);
    let here = field.gradient(&pose).0;
    assert!((here - score).abs() < 1e-2 * here);
    for axis in 0..3 {
        for boxes in [-2.0, -1.0, 1.0, 2.0] {
            let mut step = Vector3::zeros();
            step[axis] = boxes * pair.plan.modes().lengths[axis];
            let away = Pose {
                translation: pose.translation + step,
                ..pose
            };
            let (there, slope) = field.gradient(&away);
            assert!(
                there.abs() < 1e-2 * here,
                "axis {axis}, {boxes}: {there} of {here}"
            );
            assert!(slope.force.norm() < 1e-2 * here);
        }
    }
}

/// A ligand far wider than receptor and kernel on a grid of coarse cells: the ligand's own spread block must fit into
/// the box. At first only the receptor's block was fitted. The window can be wider than the kernel reaches: here it
/// is 9 cells of 8 Å, and a kernel can be 0 everywhere, as for lambda = 1 without a skin. Knots at the ligand's ends
/// were then spread outside the block: a panic in debug builds, wrong places in others. The direct sum over the same
/// modes gives the values that the grid should hold.
#[test]
fn a_wide_ligand_fits_into_a_box_of_coarse_cells() {
    let (a, b) = (
        knots(vec![[1.0, 2.0, 3.0]], &[1.7]),
        cloud(60, 30.0, &RADII, 5),
    );
    for (spacing, lambda, offset) in [(Some(8.0), 10.0, 2.0), (None, 1.0, 0.0)] {
        let mut options = engine_options(1e-2);
        options.spacing = spacing;
        options.kernel.lambda = lambda;
        options.kernel.offset = offset;
        let pair = Pair::new(Precision::Double, &a, &b, options);
        let spectra = ReceptorSpectra::new(&pair.plan, &a, &b, Quantity::Score, Precision::Double);
        let direct =
            TruncatedCorrelation::new(&pair.plan, &spectra, &b, &Selection::all(pair.plan.modes()));
        let mut work = direct.workspace();
        let rotation = some_rotation();
        let grid = pair.correlate(&rotation).scores.to_vec();
        let largest = grid.iter().fold(1e-9f64, |a, b| a.max(b.abs()));
        for voxel in (0..grid.len()).step_by(grid.len() / 150) {
            let (value, _) = direct.gradient(&pair.pose(rotation, voxel), &mut work);
            let error = (grid[voxel] - value).abs() / largest;
            assert!(
                error < 1e-2,
                "spacing {spacing:?}, voxel {voxel}: {error:e}"
            );
        }
    }
}
