//! The potential grid against the sum of the same modes, and its gradient against its own values.

use crate::scene::{Numbers, RADII, askew_cloud, cloud, engine_options};
use knotdock_scoring::Precision;
use knotdock_scoring::engine::{Plan, ReceptorSpectra};
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::transform::truncation::Selection;
use knotdock_scoring::truncated::TruncatedCorrelation;
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};

struct Pair {
    plan: Plan,
    potentials: PotentialGrid,
    modes: TruncatedCorrelation,
    /// The largest potential of one knot, to which errors of the whole ligand are relative.
    scale: f64,
}

impl Pair {
    fn new(a: &Knots, b: &Knots, tolerance: f64) -> Self {
        let plan = Plan::new(a, b, engine_options(tolerance)).unwrap();
        let spectra = ReceptorSpectra::new(&plan, a, b, Quantity::Score, Precision::Double);
        let potentials = PotentialGrid::new(&plan, &spectra, b);
        let all = Selection::all(plan.modes());
        let modes = TruncatedCorrelation::new(&plan, &spectra, b, &all);
        // One ligand knot of each radius, at the middle of the receptor and all about it.
        let mut largest = 0.0f64;
        for radius in RADII {
            let one = Knots::new(vec![[0.0; 3]], vec![radius]).unwrap();
            let plan =
                Plan::with_effects(a, &one, engine_options(tolerance), tolerance, Vec::new())
                    .unwrap();
            let spectra = ReceptorSpectra::new(&plan, a, &one, Quantity::Score, Precision::Double);
            let grid = PotentialGrid::new(&plan, &spectra, &one);
            for x in &a.centers {
                let pose = Pose {
                    translation: Vector3::from(*x),
                    ..Pose::identity()
                };
                largest = largest.max(grid.gradient(&pose).0.abs());
            }
        }
        Self {
            plan,
            potentials,
            modes,
            scale: largest,
        }
    }

    /// Poses about contact: the ligand's centre at 0.7 to 1.3 times the radii of both clouds.
    fn poses(&self, count: usize, seed: u64) -> Vec<Pose> {
        let mut numbers = Numbers(seed);
        let mut next = || 2.0 * numbers.next() - 1.0;
        (0..count)
            .map(|index| {
                let rotation =
                    Pose::from_parts([next(), next(), next(), next()], [0.0; 3]).rotation;
                let direction = Vector3::new(next(), next(), next()).normalize();
                let distance = 18.0 * (0.7 + 0.6 * index as f64 / count as f64);
                let place = self.plan.receptor_center() + distance * direction;
                Pose::about(rotation, self.plan.ligand_center(), place)
            })
            .collect()
    }
}

/// The grid's only errors are the window's and single precision's. Measured of the largest potential: scores 4e-5,
/// forces 8e-4 per Å, torques 2e-3 per radian.
#[test]
fn follows_the_sum_over_modes() {
    let (a, b) = (cloud(160, 12.0, &RADII, 1), cloud(60, 8.0, &RADII, 2));
    for tolerance in [1e-2, 1e-3] {
        let pair = Pair::new(&a, &b, tolerance);
        let mut work = pair.modes.workspace();
        let (mut value_error, mut slope_error, mut torque_error) = (0.0f64, 0.0f64, 0.0f64);
        for pose in pair.poses(60, 3) {
            let (value, slope) = pair.potentials.gradient(&pose);
            let (exact, gradient) = pair.modes.gradient(&pose, &mut work);
            value_error = value_error.max((value - exact).abs() / pair.scale);
            slope_error = slope_error.max((slope.force - gradient.force).norm() / pair.scale);
            torque_error = torque_error.max((slope.torque - gradient.torque).norm() / pair.scale);
        }
        println!(
            "{tolerance:e}: {value_error:.1e} {slope_error:.1e} {torque_error:.1e} of {:.1}",
            pair.scale
        );
        assert!(value_error < 1e-4 && slope_error < 2e-3 && torque_error < 5e-3);
    }
}

/// On a grid whose axes lie askew in the receptor's file, value, force and torque are the same vectors of the file but
/// for the tolerance of the plan.
#[test]
fn a_fitted_grid_has_the_same_potentials() {
    let (a, b) = (askew_cloud(160, 12.0, &RADII, 1), cloud(60, 8.0, &RADII, 2));
    let tolerance = 1e-4;
    let pair = Pair::new(&a, &b, tolerance);
    let fitted = pair.plan.fitted(&a).unwrap();
    assert!(fitted.frame().angle() > 0.1);
    let spectra = ReceptorSpectra::new(&fitted, &a, &b, Quantity::Score, Precision::Double);
    let potentials = PotentialGrid::new(&fitted, &spectra, &b);
    let mut nonzero = 0;
    for pose in pair.poses(60, 3) {
        let (value, slope) = potentials.gradient(&pose);
        let (expected, gradient) = pair.potentials.gradient(&pose);
        nonzero += usize::from(gradient.force.norm() > 0.1 * pair.scale);
        assert!((value - expected).abs() < 1e-3 * pair.scale);
        assert!((slope.force - gradient.force).norm() < 5e-3 * pair.scale);
        assert!((slope.torque - gradient.torque).norm() < 1e-2 * pair.scale);
    }
    assert!(nonzero > 20, "{nonzero}");
}

/// The gradient is that of the values: central differences over translation, and over rotation about the ligand's
/// centre.
#[test]
fn gradient_is_that_of_the_values() {
    let (a, b) = (cloud(160, 12.0, &RADII, 4), cloud(60, 8.0, &RADII, 5));
    let pair = Pair::new(&a, &b, 1e-2);
    let mut worst = [0.0f64; 2];
    for pose in pair.poses(20, 6) {
        let (_, gradient) = pair.potentials.gradient(&pose);
        for axis in 0..3 {
            let mut step = Vector3::zeros();
            step[axis] = 0.02;
            let moved = |sign: f64| {
                let translation = pose.translation + sign * step;
                pair.potentials
                    .gradient(&Pose {
                        translation,
                        ..pose
                    })
                    .0
            };
            // A knot moves by its arm of up to 8 Å times the angle.
            let turn = step / 8.0;
            let turned = |sign: f64| {
                let rotation = UnitQuaternion::new(sign * turn) * pose.rotation;
                let place = pose.rotation * pair.plan.ligand_center() + pose.translation;
                let pose = Pose::about(rotation, pair.plan.ligand_center(), place);
                pair.potentials.gradient(&pose).0
            };
            // Fourth order: a step of 0.02 Å is long for the second, and short for single precision.
            let slope = |at: &dyn Fn(f64) -> f64, h: f64| {
                (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h)
            };
            let force = (slope(&moved, 0.02) - gradient.force[axis]).abs() / pair.scale;
            let torque = (slope(&turned, 0.02 / 8.0) - gradient.torque[axis]).abs() / pair.scale;
            worst = [worst[0].max(force), worst[1].max(torque)];
        }
    }
    println!("{worst:?}");
    assert!(worst[0] < 1e-3 && worst[1] < 5e-3, "{worst:?}");
}
