//! Hard cases of the knots themselves: coincident and duplicate ones, one against 100,000, radii of a ratio of 1e6,
//! coordinates at 1e6 Å, denormal numbers, input that must be refused.

use crate::scene::{
    Pair, RADII, cloud, engine_options, kernel_for, kernel_options, knots, some_rotation,
};
use knotdock_scoring::Precision;
use knotdock_scoring::engine::{EngineOptions, Plan, PlanError};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::kernel::{Band, KernelOptions, ProductKernel, ProductScorer, RankingKernel};
use knotdock_scoring::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::Vector3;

/// Knots with one weight for all.
fn weighted(knots: &Knots, weight: f64) -> Knots {
    Knots {
        weights: vec![weight; knots.len()],
        ..knots.clone()
    }
}

/// A pose that brings two clouds into touch.
fn touching() -> Pose {
    Pose::from_parts([0.3, -0.2, 0.8, 0.4], [9.0, -7.0, 5.0])
}

/// Knots on one place, n against m on another, score n m times one pair, by the pair sum and by the fast path. The
/// box has no extent, bounding boxes cannot be halved, and all windows overlap.
#[test]
fn coincident_knots_are_one_knot_many_times() {
    let one = knots(vec![[3.0, -1.0, 2.0]], &[1.7]);
    let (many, more) = (
        knots(vec![[3.0, -1.0, 2.0]; 300], &[1.7]),
        knots(vec![[0.5; 3]; 70], &[1.5]),
    );
    let other = knots(vec![[0.5; 3]], &[1.5]);
    let single = Pair::new(Precision::Single, &one, &other, engine_options(1e-2));
    let crowd = Pair::new(Precision::Single, &many, &more, engine_options(1e-2));
    let (a, b) = (
        single.correlate(&some_rotation()).scores.to_vec(),
        crowd.correlate(&some_rotation()).scores.to_vec(),
    );
    assert_eq!(single.plan.size(), crowd.plan.size());
    let best = a.iter().copied().fold(0.0, f64::max);
    for (voxel, (one, all)) in a.iter().zip(&b).enumerate() {
        // Sums of 21,000 equal terms in f32.
        assert!(
            (all / 21e3 - one).abs() < 1e-4 * best,
            "{voxel}: {all} {one}"
        );
        let pose = single.pose(some_rotation(), voxel);
        let (one, all) = (
            single.scorer.score(&pose).score,
            crowd.scorer.score(&pose).score,
        );
        assert!((all - 21e3 * one).abs() <= 1e-10 * 21e3 * (one.abs() + 1.0));
    }
}

/// A duplicated atom is an atom of weight 2, and a knot of weight 0 is none: for the fast path as for the pair sum
/// (whose own test is in its module).
#[test]
fn duplicate_atoms_are_weights() {
    let (a, b) = (cloud(80, 9.0, &RADII, 1), cloud(40, 6.0, &RADII, 2));
    let mut duplicated = a.clone();
    let mut weights = a.clone();
    for i in (0..a.len()).step_by(3) {
        duplicated.centers.push(a.centers[i]);
        duplicated.radii.push(a.radii[i]);
        duplicated.weights.push(a.weights[i]);
        weights.weights[i] *= 2.0;
    }
    // A weightless knot inside the box.
    weights.centers.push([0.3, 0.2, 0.1]);
    weights.radii.push(1.7);
    weights.weights.push(0.0);
    let grid = |receptor: &Knots, ligand: &Knots| {
        Pair::new(Precision::Double, receptor, ligand, engine_options(1e-3))
            .correlate(&some_rotation())
            .scores
            .to_vec()
    };
    for (first, second) in [
        (grid(&duplicated, &b), grid(&weights, &b)),
        (grid(&b, &duplicated), grid(&b, &weights)),
    ] {
        let largest = first.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        assert_eq!(first.len(), second.len());
        for (x, y) in first.iter().zip(&second) {
            assert!((x - y).abs() < 1e-12 * largest);
        }
    }
}

/// One knot against 100,000, each way round: a ligand (or receptor) without extent beside one 60 Å across, 100,000
/// windows in f32. The best score grows with the crowd, the tolerance holds against it.
#[test]
fn one_knot_against_a_hundred_thousand() {
    let (one, crowd) = (
        knots(vec![[5.0, 6.0, 7.0]], &[1.7]),
        cloud(100_000, 30.0, &RADII, 3),
    );
    for (a, b) in [(&crowd, &one), (&one, &crowd)] {
        let pair = Pair::new(Precision::Single, a, b, engine_options(1e-2));
        let (error, best) = pair.error(some_rotation(), 499, 100);
        let grid = pair.correlate(&some_rotation()).scores.to_vec();
        let largest = grid.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        println!("error {error:.2e}, best {best:.2e}, largest {largest:.2e}");
        assert!(error <= 1e-2 * best, "{error:e} of {best:e}");
    }
}

/// The pair sum with radii of a ratio of 1e6 against a plain loop over the kernels' definitions, low-passed and not,
/// in f64. The loop tabulates nothing, and all three sizes of pairs must come out, the smallest included.
#[test]
fn radii_of_a_ratio_of_a_million_are_exact_in_the_pair_sum() {
    let radii = [1e-4, 1.0, 100.0];
    let a = knots(cloud(12, 60.0, &[1.0], 4).centers, &radii);
    let b = knots(cloud(9, 60.0, &[1.0], 5).centers, &radii);
    let kernel = kernel_for(kernel_options(), &a, &b);
    let scorer = ExactScorer::new(&kernel, &a, &b).unwrap();
    let [w0, w1, w2] = kernel.options().slice_weights();
    for pose in [
        touching(),
        Pose::from_parts([1.0, 0.0, 0.3, 0.0], [130.0, 20.0, -60.0]),
    ] {
        let (mut slices, mut plain) = ([0.0; 3], [0.0; 3]);
        for (x, r) in a.centers.iter().zip(&a.radii) {
            for (y, s) in b.centers.iter().zip(&b.radii) {
                let d = (Vector3::from(pose.apply(*y)) - Vector3::from(*x)).norm();
                for (slice, offset) in kernel.options().slice_offsets().into_iter().enumerate() {
                    let sigma = r + s + offset;
                    plain[slice] += kernel.cone().value(d, sigma);
                    if d < kernel.reach() {
                        slices[slice] += kernel.value(d, sigma);
                    }
                }
            }
        }
        let ours = scorer.score(&pose);
        let scale = slices.iter().fold(1.0f64, |a, b| a.max(b.abs()));
        for (own, slice) in ours.slices.iter().zip(slices) {
            assert!(
                (own - slice).abs() < 1e-8 * scale,
                "{ours:?} against {slices:?}"
            );
        }
        let unfiltered = w0 * plain[0] + w1 * plain[1] + w2 * plain[2];
        assert!((ours.unfiltered - unfiltered).abs() < 1e-9 * w0.abs() * scale);
    }
    // Two of the smallest balls alone, half overlapping: unfiltered, their own kernel to the last digits.
    let small = knots(vec![[0.0; 3]], &[1e-4]);
    let kernel = kernel_for(kernel_options(), &small, &small);
    let scorer = ExactScorer::new(&kernel, &small, &small).unwrap();
    let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [1e-4, 0.0, 0.0]);
    let slice = |offset: f64| {
        let u: f64 = (1e-4 / (2e-4 + offset)).powi(2);
        (-u / (1.0 - u)).exp()
    };
    let expected = w0 * slice(0.0) + w1 * slice(2.0) + w2 * slice(4.0);
    assert!((scorer.score(&pose).unfiltered - expected).abs() < 1e-12 * w0.abs());
}

/// The engines name the balls that they cannot resolve: first they did not, and radii of 1e-4 Å beside 100 Å gave the
/// correlation of the large ones without a word. Protein atoms at docking's resolution are none of these.
#[test]
fn engines_name_the_balls_that_they_cannot_resolve() {
    let mixed = knots(cloud(12, 20.0, &[1.0], 6).centers, &[1e-5, 1.7, 10.0, 0.3]);
    let protein = cloud(12, 10.0, &RADII, 7);
    let named = |knots: &Knots, resolution: f64| {
        let mut options = engine_options(1e-2);
        options.kernel.resolution = resolution;
        options.kernel.pass_length = 2.0 * resolution;
        Plan::new(knots, knots, options).unwrap().unresolved(knots)
    };
    assert_eq!(named(&mixed, 4.0), [0, 3, 4, 7, 8, 11]);
    assert!(named(&protein, 4.5).is_empty());
    // Resolution is what the balls are measured by: at a tenth of it these are seen, at ten times none is.
    assert_eq!(named(&mixed, 0.4), [0, 4, 8]);
    assert_eq!(named(&protein, 45.0).len(), protein.len());
    let spaced = EngineOptions {
        spacing: Some(1.0),
        ..engine_options(1e-2)
    };
    let plan = Plan::product(&mixed, &protein, spaced, Band::Whole).unwrap();
    assert_eq!(plan.unresolved(&mixed), [0, 3, 4, 7, 8, 11]);
}

/// Files may put a molecule 1e6 Å from the origin. Coordinates here are multiples of 2^-20 Å and the shift is a power
/// of two, so that it loses no digit. The fast path must give the same bits, since it recentres before it rounds to
/// f32.
#[test]
fn a_million_angstrom_away_the_grid_has_the_same_bits() {
    let dyadic = |knots: &Knots, shift: [f64; 3]| {
        let scale = f64::from(1 << 20);
        let mut knots = knots.clone();
        for x in &mut knots.centers {
            *x = std::array::from_fn(|axis| (x[axis] * scale).round() / scale + shift[axis]);
        }
        knots
    };
    let (a, b) = (cloud(80, 9.0, &RADII, 8), cloud(40, 6.0, &RADII, 9));
    let far = f64::from(1 << 20);
    let near = Pair::new(
        Precision::Single,
        &dyadic(&a, [0.0; 3]),
        &dyadic(&b, [0.0; 3]),
        engine_options(1e-2),
    );
    let away = Pair::new(
        Precision::Single,
        &dyadic(&a, [far, -far, 0.0]),
        &dyadic(&b, [-far, 0.5 * far, far]),
        engine_options(1e-2),
    );
    let (first, second) = (
        near.correlate(&some_rotation()),
        away.correlate(&some_rotation()),
    );
    assert_eq!(first.scores, second.scores);
    // A pose's translation of 1e6 Å is good to 1e-10 Å.
    let best = first.scores.iter().fold(0.0, f64::max);
    for voxel in (0..first.scores.count()).step_by(97) {
        let (x, y) = (
            near.exact(some_rotation(), voxel),
            away.exact(some_rotation(), voxel),
        );
        assert!((x - y).abs() < 1e-7 * best, "{x} {y}");
    }
}

/// A ligand larger than the receptor, by 1 to 20: the box is the ligand's to fill, and its block the larger one.
#[test]
fn a_ligand_larger_than_its_receptor() {
    let (small, large) = (cloud(12, 3.0, &RADII, 10), cloud(900, 22.0, &RADII, 11));
    for tolerance in [1e-2, 1e-3] {
        let pair = Pair::new(Precision::Double, &small, &large, engine_options(tolerance));
        let (error, best) = pair.error(some_rotation(), 199, 100);
        println!("{tolerance:e}: {:.2e}", error / best);
        assert!(error <= tolerance * best, "{error:e} of {best:e}");
    }
}

/// Denormal numbers: coordinates at distances of 1e-310 Å, radii of 1e-310 Å, weights that underflow in a product.
/// Distances square to 0, weights vanish; no score may be anything but finite, and no gradient. First, radii of
/// 1e-310 Å without a skin had the score NaN (the inverse of a table's length overflowed): such a kernel is refused
/// now, by the pair sum as by the engines.
#[test]
fn denormal_numbers_stay_finite() {
    let close = knots(
        vec![[0.0; 3], [1e-310, 0.0, 0.0], [5e-324, 1e-160, 0.0]],
        &RADII,
    );
    let tiny = knots(vec![[0.0; 3], [1.0, 0.0, 0.0]], &[1e-310]);
    let sizes = [
        (close.clone(), close.clone()),
        (tiny.clone(), tiny.clone()),
        (tiny, cloud(10, 4.0, &RADII, 12)),
        (weighted(&close, 1e-200), weighted(&close, 1e-200)),
    ];
    for (index, (a, b)) in sizes.iter().enumerate() {
        for offset in [0.0, 2.0] {
            let options = KernelOptions {
                offset,
                ..kernel_options()
            };
            let (low, high) = (
                crate::scene::ends(a).0 + crate::scene::ends(b).0,
                crate::scene::ends(a).1 + crate::scene::ends(b).1,
            );
            let kernel = match RankingKernel::new(options, low, high, 1.0) {
                Ok(kernel) => kernel,
                Err(error) => {
                    assert!(index == 1 && offset == 0.0, "scene {index}: {error}");
                    assert!(
                        Plan::new(
                            a,
                            b,
                            EngineOptions {
                                kernel: options,
                                ..engine_options(1e-2)
                            }
                        )
                        .is_err()
                    );
                    continue;
                }
            };
            let scorer = ExactScorer::new(&kernel, a, b).unwrap();
            for translation in [[0.0; 3], [1e-310, 0.0, 0.0], [3.0, 0.0, 0.0]] {
                let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], translation);
                let score = scorer.score(&pose);
                let (value, gradient) = scorer.gradient(&pose);
                assert!(
                    score.score.is_finite() && score.unfiltered.is_finite() && value.is_finite()
                );
                assert!(
                    gradient
                        .force
                        .iter()
                        .chain(&gradient.torque)
                        .all(|x| x.is_finite())
                );
            }
            let mut engine = engine_options(1e-2);
            engine.kernel.offset = offset;
            match Plan::new(a, b, engine) {
                Ok(_) => {
                    let pair = Pair::new(Precision::Single, a, b, engine);
                    let grid = pair.correlate(&some_rotation()).scores.to_vec();
                    assert!(
                        grid.iter().all(|value| value.is_finite()),
                        "scene {index}, offset {offset}"
                    );
                }
                Err(error) => assert!(
                    matches!(error, PlanError::WeightRange(_)) && index == 3,
                    "scene {index}: {error}"
                ),
            }
        }
    }
}

/// Weights scale the score, bit for bit by powers of two, over the whole range that is accepted; beyond it they are
/// refused. First, weights of 1e30 on both bodies gave a grid of infinities and NaN in f32, and weights of 1e-30 one
/// of zeros.
#[test]
fn weights_scale_the_score_or_are_refused() {
    let (a, b) = (cloud(60, 8.0, &RADII, 13), cloud(30, 5.0, &RADII, 14));
    let grid = |x: f64, y: f64| {
        let pair = Pair::new(
            Precision::Single,
            &weighted(&a, x),
            &weighted(&b, y),
            engine_options(1e-2),
        );
        pair.correlate(&some_rotation()).scores.to_vec()
    };
    let plain = grid(1.0, 1.0);
    for (x, y) in [
        (2f64.powi(22), 2f64.powi(24)),
        (2f64.powi(-34), 2f64.powi(-33)),
        (-1.0, 0.25),
    ] {
        let scaled = grid(x, y);
        let factor = x * y;
        assert!(
            plain.iter().zip(&scaled).all(|(a, b)| a * factor == *b),
            "{x:e} {y:e}"
        );
    }
    for (x, y) in [
        (1e30, 1e30),
        (1e-30, 1e-30),
        (1e200, 1.0),
        (1.0, 1e-310),
        (1e9, 1e9),
    ] {
        let refused = Plan::new(&weighted(&a, x), &weighted(&b, y), engine_options(1e-2));
        assert!(
            matches!(refused, Err(PlanError::WeightRange(_))),
            "{x:e} {y:e}"
        );
    }
}

/// What is no set of balls is refused by every way to score, and says which knot.
#[test]
fn knots_that_are_none_are_refused_everywhere() {
    let good = cloud(5, 3.0, &RADII, 15);
    let with = |change: &dyn Fn(&mut Knots)| {
        let mut knots = good.clone();
        change(&mut knots);
        knots
    };
    let bad = [
        with(&|knots| *knots = Knots::default()),
        with(&|knots| knots.centers[3][1] = f64::NAN),
        with(&|knots| knots.centers[3][2] = f64::NEG_INFINITY),
        with(&|knots| knots.radii[3] = 0.0),
        with(&|knots| knots.radii[3] = -1.0),
        with(&|knots| knots.radii[3] = f64::INFINITY),
        with(&|knots| knots.weights[3] = f64::NAN),
        with(&|knots| {
            knots.radii.pop();
        }),
    ];
    let kernel = kernel_for(kernel_options(), &good, &good);
    let product = ProductKernel::new(kernel_options(), Band::Whole, 1.9, 1.0).unwrap();
    for (index, knots) in bad.iter().enumerate() {
        for (a, b) in [(knots, &good), (&good, knots)] {
            let reported = match Plan::new(a, b, engine_options(1e-2)) {
                Err(PlanError::Knots(error)) => error.to_string(),
                other => panic!("{index}: {other:?}"),
            };
            assert!(
                reported.contains("knot 3") || index == 0 || index == 7,
                "{reported}"
            );
            assert!(ExactScorer::new(&kernel, a, b).is_err());
            assert!(ProductScorer::new(&product, a, b).is_err());
        }
    }
    // A stray atom far away needs a box that no machine holds.
    let stray = with(&|knots| knots.centers[3][0] = 1e12);
    assert!(matches!(
        Plan::new(&stray, &good, engine_options(1e-2)),
        Err(PlanError::TooLarge(_))
    ));
}
