//! Grown balls with separate weights: the engine of the product kernel against the sum over all pairs.

use crate::scene::{cloud, engine_options};
use knotdock_scoring::Precision;
use knotdock_scoring::engine::{CpuEngine, Plan, ReceptorSpectra};
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::kernel::Band;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::Vector3;
use std::sync::Arc;

/// Balls of 20 radii from 1 to 6, their weights, and others for the same balls grown.
fn body(count: usize, size: f64, seed: u64) -> Knots {
    let radii: Vec<f64> = (0..20).map(|i| 1.0 + 5.0 * f64::from(i) / 19.0).collect();
    let mut knots = cloud(count, size, &radii, seed);
    let weight = |i: usize, of: usize| 0.1 + (i * of % 17) as f64 / 17.0;
    knots.weights = (0..count).map(|i| weight(i, 7)).collect();
    let skin = (0..count).map(|i| weight(i, 5)).collect();
    knots.with_skin_weights(skin).unwrap()
}

fn turned() -> Pose {
    Pose::from_parts([0.3, -0.2, 0.8, 0.4], [0.0; 3])
}

/// Score and slices of all voxels are those of the exact sum, in whatever unit volumes are, compressed too.
#[test]
fn the_engine_is_the_pair_sum_of_both_sets_of_weights() {
    let (a, b) = (body(70, 9.0, 1), body(40, 6.0, 2));
    let options = engine_options(1e-3);
    let plan = Arc::new(Plan::product_in(&a, &b, options, Band::LowPass, 2.5).unwrap());
    assert_eq!(plan.shape_functions(), (40, 40));
    let exact = ExactSum::of(&plan, &a, &b).unwrap();
    let quantities = [0, 1, 2].map(Quantity::Slice);
    for quantity in [Quantity::Score].into_iter().chain(quantities) {
        let spectra = ReceptorSpectra::new(&plan, &a, &b, quantity, Precision::Double);
        for rank in [spectra.full_rank(), 12] {
            let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &b, rank);
            let mut work = engine.workspace();
            engine.correlate(&turned().rotation, &mut work);
            let (mut worst, mut largest) = (0.0f64, 0.0f64);
            for voxel in (0..work.scores.count()).step_by(503) {
                let place = plan.receptor_center() + engine.position(voxel);
                let pose = Pose::about(turned().rotation, plan.ligand_center(), place);
                let found = exact.score(&pose);
                let expected = match quantity {
                    Quantity::Slice(slice) => found.slices[slice],
                    _ => found.score,
                };
                worst = worst.max((work.scores.score(voxel) - expected).abs());
                largest = largest.max(expected.abs());
            }
            println!(
                "{quantity:?} at rank {rank}: {:.1e} of {largest:.1e}",
                worst / largest
            );
            assert!(
                worst < 1e-3 * largest,
                "{quantity:?} {rank}: {worst} of {largest}"
            );
        }
    }
}

/// Weights that are the same for grown balls change nothing: the layers are the double skin taken apart.
#[test]
fn equal_weights_are_one_double_skin() {
    let (mut a, mut b) = (body(50, 8.0, 3), body(30, 5.0, 4));
    a.skin_weights = a.weights.clone();
    b.skin_weights = b.weights.clone();
    let of = |a: &Knots, b: &Knots| {
        let plan = Plan::product_in(a, b, engine_options(1e-2), Band::LowPass, 1.0).unwrap();
        ExactSum::of(&plan, a, b).unwrap().score(&turned())
    };
    let apart = of(&a, &b);
    a.skin_weights.clear();
    b.skin_weights.clear();
    let whole = of(&a, &b);
    assert!((apart.score - whole.score).abs() < 1e-9 * whole.score.abs());
}

/// Force and torque are the derivatives of the score.
#[test]
fn gradients_are_differences_of_the_score() {
    let (a, b) = (body(50, 8.0, 5), body(30, 5.0, 6));
    let plan = Plan::product_in(&a, &b, engine_options(1e-2), Band::LowPass, 1.0).unwrap();
    let exact = ExactSum::of(&plan, &a, &b).unwrap();
    let pose = Pose {
        translation: Vector3::new(9.0, -3.0, 4.0),
        ..turned()
    };
    let (score, gradient) = exact.gradient(&pose);
    assert!((score - exact.score_only(&pose)).abs() < 1e-9 * score.abs());
    let h = 1e-4;
    for axis in 0..3 {
        let moved = |by: f64| {
            let mut translation = pose.translation;
            translation[axis] += by;
            exact.score_only(&Pose {
                translation,
                ..pose
            })
        };
        let slope = (moved(h) - moved(-h)) / (2.0 * h);
        let scale = gradient.force.norm();
        assert!(
            (slope - gradient.force[axis]).abs() < 1e-5 * scale,
            "{slope} {gradient:?}"
        );
        let turned = |by: f64| {
            let mut about = Vector3::zeros();
            about[axis] = by;
            let center = plan.ligand_center();
            let rotation = nalgebra::UnitQuaternion::new(about) * pose.rotation;
            let place = pose.rotation * center + pose.translation;
            exact.score_only(&Pose::about(rotation, center, place))
        };
        let slope = (turned(h) - turned(-h)) / (2.0 * h);
        let scale = gradient.torque.norm();
        assert!(
            (slope - gradient.torque[axis]).abs() < 1e-5 * scale,
            "{slope} {gradient:?}"
        );
    }
}
