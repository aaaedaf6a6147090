//! Properties of all knots, radii, weights, offsets and poses:
//!
//! - Nothing is NaN or infinite.
//! - The score is the same when the bodies change places under the inverse pose.
//! - Nothing scores through the periodic image.
//! - The fast path is within its tolerance of the pair sum.

use crate::scene::{Pair, engine_options};
use knotdock_scoring::Precision;
use knotdock_scoring::engine::{EngineOptions, Plan, ReceptorSpectra};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::kernel::{KernelOptions, RankingKernel};
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::transform::truncation::Selection;
use knotdock_scoring::truncated::TruncatedCorrelation;
use knotdock_structures::Knots;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::sync::Arc;

/// Knots of up to three radii between 0.3 and 6 Å, with weights of either sign, some of them zero.
fn knots() -> impl Strategy<Value = Knots> {
    let weight = prop_oneof![3 => Just(1.0), 2 => -2.0..2.0f64, 1 => Just(0.0)];
    let knot = (prop::array::uniform3(-9.0..9.0f64), 0usize..3, weight);
    let radii = prop::array::uniform3(-1.2..1.8f64);
    let place = prop::array::uniform3(-1e4..1e4f64);
    (prop::collection::vec(knot, 1..13), radii, place).prop_map(|(list, radii, place)| {
        let center = |x: [f64; 3]| std::array::from_fn(|axis| x[axis] + place[axis]);
        Knots::with_weights(
            list.iter().map(|knot| center(knot.0)).collect(),
            list.iter().map(|knot| radii[knot.1].exp()).collect(),
            list.iter().map(|knot| knot.2).collect(),
        )
        .unwrap()
    })
}

/// A rotation, and where it puts the ligand's centre relative to the receptor's, Å.
fn pose() -> impl Strategy<Value = ([f64; 4], [f64; 3])> {
    (
        prop::array::uniform4(-1.0..1.0f64).prop_filter("no rotation", |q| {
            q.iter().map(|x| x * x).sum::<f64>() > 1e-2
        }),
        prop::array::uniform3(-16.0..16.0f64),
    )
}

fn options() -> impl Strategy<Value = EngineOptions> {
    let lambda = prop_oneof![Just(0.0), Just(1.0), 2.0..20.0f64, Just(1e3)];
    let offset = prop_oneof![1 => Just(0.0), 4 => 0.0..5.0f64, 1 => Just(15.0)];
    let alpha = prop_oneof![3 => Just(2.0), 2 => 0.5..20.0f64, 1 => Just(f64::INFINITY)];
    (lambda, offset, alpha, 3.0..6.0f64, 1.3..3.0f64).prop_map(
        |(lambda, offset, alpha, resolution, ratio)| EngineOptions {
            kernel: KernelOptions {
                lambda,
                offset,
                alpha,
                resolution,
                pass_length: ratio * resolution,
                ..engine_options(1e-3).kernel
            },
            ..engine_options(1e-3)
        },
    )
}

/// The pose that puts the ligand's centre at `place` from the receptor's.
fn posed(plan: &Plan, (rotation, place): ([f64; 4], [f64; 3])) -> Pose {
    let rotation = Pose::from_parts(rotation, [0.0; 3]).rotation;
    Pose::about(
        rotation,
        plan.ligand_center(),
        plan.receptor_center() + nalgebra::Vector3::from(place),
    )
}

/// What rounding errors of the pair sum are measured by: all pairs on one place, all slices of one sign.
fn size(kernel: &RankingKernel, a: &Knots, b: &Knots) -> f64 {
    1.6 * (1.0 + kernel.options().lambda).powi(2) * pairs(a, b)
}

/// Scale of the fast path's errors: all pairs in touch, each at the most that it can earn. If the kernel rewards
/// nothing, it is a tenth of a pair's loss in overlap: with lambda = 0 an error of 3.5e-4 of the overlap was met
/// at a tolerance of 1e-2.
fn best(plan: &Plan, a: &Knots, b: &Knots) -> f64 {
    let widest = crate::scene::ends(a).1 + crate::scene::ends(b).1;
    let table = plan.kernel().distance_table(widest);
    plan.kernel()
        .peak_score(&table)
        .max(0.1 * table.value(0.0)[3].abs())
        * pairs(a, b)
}

fn pairs(a: &Knots, b: &Knots) -> f64 {
    let sum = |knots: &Knots| knots.weights.iter().map(|c| c.abs()).sum::<f64>();
    sum(a) * sum(b)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 24,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    /// The pair sum: finite in score, slices, gradient; and the same when the bodies change places under the inverse
    /// pose.
    #[test]
    fn the_pair_sum_is_finite_and_symmetric(a in knots(), b in knots(), options in options(), place in pose()) {
        let plan = Plan::new(&a, &b, options).unwrap();
        let pose = posed(&plan, place);
        let scorer = ExactScorer::new(plan.kernel(), &a, &b).unwrap();
        let (score, (_, gradient)) = (scorer.score(&pose), scorer.gradient(&pose));
        prop_assert!(score.score.is_finite() && score.unfiltered.is_finite());
        prop_assert!(score.slices.iter().all(|slice| slice.is_finite()));
        prop_assert!(gradient.force.iter().chain(&gradient.torque).all(|x| x.is_finite()));
        let exchanged = ExactScorer::new(plan.kernel(), &b, &a).unwrap().score(&pose.inverse());
        let bound = 1e-9 * size(plan.kernel(), &a, &b);
        prop_assert!((score.score - exchanged.score).abs() <= bound);
        prop_assert!((score.unfiltered - exchanged.unfiltered).abs() <= bound);
    }

    /// The fast path, summed from its modes at any pose: finite, symmetric, and at the pair sum's score, to the
    /// tolerance relative to the most that all pairs in touch could earn. Poses reach to the faces of small boxes, so
    /// that an image would show.
    #[test]
    fn the_fast_path_is_finite_and_symmetric(a in knots(), b in knots(), options in options(), place in pose()) {
        let summed = |a: &Knots, b: &Knots, pose: &Pose| {
            let plan = Arc::new(Plan::new(a, b, options).unwrap());
            let spectra = ReceptorSpectra::new(&plan, a, b, Quantity::Score, Precision::Double);
            let whole = TruncatedCorrelation::new(&plan, &spectra, b, &Selection::all(plan.modes()));
            let (value, gradient) = whole.gradient(pose, &mut whole.workspace());
            assert!(gradient.force.iter().chain(&gradient.torque).all(|x| x.is_finite()));
            value
        };
        let plan = Plan::new(&a, &b, options).unwrap();
        let pose = posed(&plan, place);
        let exact = ExactScorer::new(plan.kernel(), &a, &b).unwrap().score_only(&pose);
        let (value, exchanged) = (summed(&a, &b, &pose), summed(&b, &a, &pose.inverse()));
        let bound = 1e-3 * best(&plan, &a, &b);
        prop_assert!((value - exact).abs() <= bound, "{value} {exact} {bound}");
        prop_assert!((exchanged - exact).abs() <= bound, "{exchanged} {exact} {bound}");
    }

    /// Whole grids in f32: finite everywhere, and on every voxel at the faces of the box, halfway between receptor
    /// and image, no more than the pair sum says.
    #[test]
    fn grids_are_finite_and_nothing_scores_through_the_image(
        a in knots(), b in knots(), options in options(), place in pose()
    ) {
        let options = EngineOptions { tolerance: 1e-2, ..options };
        let pair = Pair::new(Precision::Single, &a, &b, options);
        let rotation = Pose::from_parts(place.0, [0.0; 3]).rotation;
        let work = pair.correlate(&rotation);
        let half = pair.plan.modes().lengths.map(|length| 0.5 * length);
        let bound = 1e-2 * best(&pair.plan, &a, &b);
        for (voxel, value) in work.scores.iter().enumerate() {
            prop_assert!(value.is_finite());
            let t = pair.engine.position(voxel);
            if voxel % 5 == 0 && (0..3).any(|axis| half[axis] - t[axis].abs() < pair.plan.spacing()) {
                let exact = pair.exact(rotation, voxel);
                prop_assert!((value - exact).abs() <= bound, "{value} {exact} at {t:?}");
            }
        }
    }
}
