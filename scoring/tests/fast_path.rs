//! The fast path against the exact pair sum and the 4D direct transform, over swept tolerances.
//!
//! Errors of G are relative to the best exact score, errors of a slice to its largest value.

use crate::scene;
use crate::scene::{Pair, RADII, askew_cloud, cloud, engine_options as options};
use knotdock_scoring::Precision;
use knotdock_scoring::engine::ReceptorSpectra;
use knotdock_scoring::engine::{CpuEngine, EngineOptions, Plan};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::grid_turn::GridTurn;
use knotdock_scoring::kernel::Trim;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::transform::ndft::ndft_4d;
use knotdock_structures::Knots;
use nalgebra::Vector3;
use num_complex::Complex64;
use std::f64::consts::PI;
use std::sync::Arc;

/// Worst error over a sweep of voxels and the best ones, as a share of the best exact value.
fn worst(precision: Precision, a: &Knots, b: &Knots, tolerance: f64, quantity: Quantity) -> f64 {
    worst_after(precision, a, b, tolerance, quantity, GridTurn::NONE)
}

/// The same where a half-turn of the grid follows the rotation, so that the ligand's transform is read mirrored.
fn worst_after(
    precision: Precision,
    a: &Knots,
    b: &Knots,
    tolerance: f64,
    quantity: Quantity,
    half_turn: GridTurn,
) -> f64 {
    worst_of(precision, a, b, options(tolerance), quantity, half_turn)
}

/// The same of any options.
fn worst_of(
    precision: Precision,
    a: &Knots,
    b: &Knots,
    options: EngineOptions,
    quantity: Quantity,
    half_turn: GridTurn,
) -> f64 {
    let plan = Arc::new(Plan::new(a, b, options).unwrap());
    let scorer = ExactScorer::new(plan.kernel(), a, b).unwrap();
    let spectra = ReceptorSpectra::new(&plan, a, b, quantity, precision);
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, b, spectra.full_rank());
    let mut work = engine.workspace();
    let turned = Pose::from_parts([0.3, -0.2, 0.8, 0.4], [0.0; 3]).rotation;
    engine.transform_ligand(&turned, &mut work);
    engine.correlate_turned(half_turn, &mut work);
    let rotation = half_turn.after(&turned);
    let mut order: Vec<usize> = (0..work.scores.count()).collect();
    order.sort_by(|&x, &y| {
        work.scores
            .score(y)
            .partial_cmp(&work.scores.score(x))
            .unwrap()
    });
    let sweep = order.iter().copied().step_by(order.len() / 150);
    let (mut error, mut best) = (0.0f64, 0.0f64);
    for voxel in order[..100].iter().copied().chain(sweep) {
        let place = plan.receptor_center() + engine.position_after(half_turn, voxel);
        let exact = scorer.score(&Pose::about(rotation, plan.ligand_center(), place));
        let value = match quantity {
            Quantity::Score => exact.score,
            Quantity::Slice(slice) => exact.slices[slice],
            other => unreachable!("the exact sum has no {other:?}"),
        };
        error = error.max((value - work.scores.score(voxel)).abs());
        best = best.max(value);
    }
    error / best
}

#[test]
fn scores_meet_the_requested_tolerance() {
    let (a, b) = (cloud(160, 12.0, &RADII, 1), cloud(60, 8.0, &RADII, 2));
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
        let error = worst(Precision::Double, &a, &b, tolerance, Quantity::Score);
        println!("f64 {tolerance:e}: {error:.2e}");
        assert!(error <= tolerance, "f64 at {tolerance:e}: {error:e}");
    }
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let error = worst(Precision::Single, &a, &b, tolerance, Quantity::Score);
        println!("f32 {tolerance:e}: {error:.2e}");
        assert!(error <= tolerance, "f32 at {tolerance:e}: {error:e}");
    }
}

/// With B&I's trim the lifted series once had the flat top's period, and errors of 3e-4 to 1e-2 at any tolerance.
#[test]
fn scores_meet_the_tolerance_with_the_trim_of_behandish_and_ilies() {
    let (a, b) = (cloud(160, 12.0, &RADII, 1), cloud(60, 8.0, &RADII, 2));
    for length in [4.5, 7.0] {
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let mut options = options(tolerance);
            options.kernel.trim = Trim::BehandishIlies { length };
            let error = worst_of(
                Precision::Double,
                &a,
                &b,
                options,
                Quantity::Score,
                GridTurn::NONE,
            );
            println!("{length} {tolerance:e}: {error:.2e}");
            assert!(error <= tolerance, "{length} at {tolerance:e}: {error:e}");
        }
    }
}

/// A search for a spacing that fits into memory plans grids alone; such a plan must equal a new one.
#[test]
fn a_plan_with_another_spacing_is_the_plan_made_for_it() {
    let (a, b) = (cloud(160, 12.0, &RADII, 1), cloud(60, 8.0, &RADII, 2));
    let first = Plan::new(&a, &b, options(1e-2)).unwrap();
    let spaced = EngineOptions {
        spacing: Some(2.7),
        ..options(1e-2)
    };
    let made = Plan::new(&a, &b, spaced).unwrap();
    let changed = first.with_spacing(2.7).unwrap();
    assert_eq!(changed.options(), made.options());
    assert_eq!(changed.spacing(), made.spacing());
    assert_eq!(changed.size(), made.size());
    assert_eq!(changed.fine(), made.fine());
    assert_eq!(changed.modes().columns, made.modes().columns);
    assert_eq!(changed.axis().modes(), made.axis().modes());
    assert!(first.with_spacing(f64::NAN).is_err() && first.with_spacing(1e-4).is_err());
}

#[test]
fn slices_meet_the_requested_tolerance() {
    let (a, b) = (cloud(160, 12.0, &RADII, 3), cloud(60, 8.0, &RADII, 4));
    for tolerance in [1e-2, 1e-4, 1e-6] {
        for slice in 0..3 {
            let error = worst(Precision::Double, &a, &b, tolerance, Quantity::Slice(slice));
            assert!(
                error <= tolerance,
                "slice {slice} at {tolerance:e}: {error:e}"
            );
        }
    }
}

/// Below 1e-2 the grid's spacing comes from a bound on the sum of the modes beyond it, with a slack that whole sums
/// have never used up. Cases: small bodies, whose few pairs may be off in phase, offsets near zero, where skins and
/// cores nearly cancel, and kernels with a cusp or an edge. For larger bodies, the slowest and the least delicate,
/// every two of offset, kernel and tolerance are combined; `KNOTDOCK_WHOLE=1` combines all three.
#[test]
fn cut_modes_stay_within_the_tolerance() {
    let whole = std::env::var_os("KNOTDOCK_WHOLE").is_some();
    let (mut worst_share, mut counted) = (0.0f64, 0);
    for (receptor, ligand) in [(1, 1), (4, 2), (20, 10), (160, 60)] {
        let size = 2.0 * f64::from(receptor).cbrt();
        let a = cloud(receptor as usize, size, &RADII, 21);
        let b = cloud(ligand, 0.8 * size, &RADII, 22);
        for (i, offset) in [0.0, 1.0, 2.0].into_iter().enumerate() {
            for (j, alpha) in [0.5, 2.0, f64::INFINITY].into_iter().enumerate() {
                for (k, tolerance) in [5e-3, 1e-4, 1e-6].into_iter().enumerate() {
                    if receptor >= 20 && (i + j + k) % 3 != 0 && !whole {
                        continue;
                    }
                    let mut options = options(tolerance);
                    (options.kernel.offset, options.kernel.alpha) = (offset, alpha);
                    let pair = scene::Pair::new(Precision::Double, &a, &b, options);
                    let voxels = pair.plan.size().iter().product::<usize>();
                    let (error, best) = pair.error(scene::some_rotation(), voxels / 100, 50);
                    let share = error / (tolerance * best);
                    println!("{receptor} {offset} {alpha} {tolerance:e}: {share:.3}");
                    assert!(
                        share <= 1.0,
                        "{receptor} balls, offset {offset}, alpha {alpha}, {tolerance:e}: {share}"
                    );
                    worst_share = worst_share.max(share);
                    counted += 1;
                }
            }
        }
    }
    println!("{counted} plans, at most {worst_share:.2} of the tolerance");
}

/// Four rotations share one transform of the ligand; the clouds have no symmetry that could hide a wrong reading of it.
#[test]
fn half_turns_read_the_same_transform() {
    let (a, b) = (cloud(160, 12.0, &RADII, 1), cloud(60, 8.0, &RADII, 2));
    for half_turn in GridTurn::HALF_TURNS {
        for tolerance in [1e-2, 1e-4] {
            let error = worst_after(
                Precision::Double,
                &a,
                &b,
                tolerance,
                Quantity::Score,
                half_turn,
            );
            assert!(
                error <= tolerance,
                "{half_turn:?} at {tolerance:e}: {error:e}"
            );
        }
    }
}

/// Eight rotations share one transform where the grid is as long in y as in z, and its axes may lie askew in the
/// receptor's file: poses are of the files all the same.
#[test]
fn turns_of_a_fitted_grid_read_the_same_transform() {
    let (a, b) = (askew_cloud(160, 12.0, &RADII, 1), cloud(60, 8.0, &RADII, 2));
    for tolerance in [1e-2, 1e-4] {
        let pair = Pair::fitted(Precision::Double, &a, &b, options(tolerance));
        let (frame, engine) = (pair.plan.frame(), &pair.engine);
        assert!(frame.angle() > 0.1, "{}", frame.angle());
        assert_eq!(engine.turns(), GridTurn::ALL);
        let turned = Pose::from_parts([0.3, -0.2, 0.8, 0.4], [0.0; 3]).rotation;
        let mut together = engine.workspace_of(4);
        engine.transform_ligand(&turned, &mut together);
        let mut one = engine.workspace();
        engine.transform_ligand(&turned, &mut one);
        engine.correlate_each(&GridTurn::ALL, &mut together, &mut |place, scores| {
            let turn = GridTurn::ALL[place];
            engine.correlate_turned(turn, &mut one);
            assert_eq!(&one.scores, scores, "{turn:?}: alone and with others");
            let rotation = frame.inverse() * turn.after(&(frame * turned));
            let mut order: Vec<usize> = (0..scores.count()).collect();
            order.sort_by(|&x, &y| scores.score(y).total_cmp(&scores.score(x)));
            let sweep = order.iter().copied().step_by(order.len() / 150);
            let (mut error, mut best) = (0.0f64, 0.0f64);
            for voxel in order[..100].iter().copied().chain(sweep) {
                let place = pair.plan.receptor_center() + engine.position_after(turn, voxel);
                let pose = Pose::about(rotation, pair.plan.ligand_center(), place);
                let exact = pair.scorer.score_only(&pose);
                error = error.max((exact - scores.score(voxel)).abs());
                best = best.max(exact);
            }
            assert!(error <= tolerance * best, "{turn:?}: {:e}", error / best);
        });
    }
}

/// Every knot its own radius: the lifted modes themselves carry the radii.
#[test]
fn continuous_radii_go_through_the_lifted_modes() {
    let many: Vec<f64> = (0..90).map(|i| 1.5 + 0.4 * f64::from(i) / 89.0).collect();
    let (a, b) = (cloud(90, 10.0, &many, 5), cloud(40, 6.0, &many, 6));
    for tolerance in [1e-2, 1e-3] {
        let error = worst(Precision::Double, &a, &b, tolerance, Quantity::Score);
        assert!(error <= tolerance, "at {tolerance:e}: {error:e}");
    }
}

/// G^(w) by the uncompressed 4D direct transform of design: sum_k K C rhoA conj(rhoB), and G at poses by summing its
/// modes.
#[test]
fn grid_equals_the_4d_direct_transform() {
    let (a, b) = (cloud(40, 6.0, &RADII, 7), cloud(20, 4.0, &RADII, 8));
    let plan = Arc::new(Plan::new(&a, &b, options(1e-3)).unwrap());
    let spectra = ReceptorSpectra::new(&plan, &a, &b, Quantity::Score, Precision::Double);
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &b, spectra.full_rank());
    let mut work = engine.workspace();
    let rotation = Pose::from_parts([0.9, 0.3, -0.1, 0.4], [0.0; 3]).rotation;
    engine.correlate(&rotation, &mut work);
    let centred = |knots: &Knots, center: Vector3<f64>| -> Vec<[f64; 3]> {
        let relative = knots.centers.iter().map(|&x| Vector3::from(x) - center);
        relative.map(|x| x.into()).collect()
    };
    let x = centred(&a, plan.receptor_center());
    let y: Vec<[f64; 3]> = centred(&b, plan.ligand_center())
        .into_iter()
        .map(|y| (rotation * Vector3::from(y)).into())
        .collect();
    // The r-mirrored ligand: radii enter with the other sign.
    let mirrored: Vec<f64> = b.radii.iter().map(|s| -s).collect();
    let modes = plan.axis().modes() as i64;
    let mut spectrum = Vec::new();
    plan.modes().for_each(|_, w, multiplicity| {
        let length = w.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut sum = Complex64::new(0.0, 0.0);
        for k in -modes..=modes {
            let eta = plan.axis().eta(k);
            sum += plan.axis().coefficient(plan.kernel(), length, k)
                * plan.axis().fold_factor(plan.kernel(), Quantity::Score, k)
                * ndft_4d(&x, &a.radii, &a.weights, w, eta)
                * ndft_4d(&y, &mirrored, &b.weights, w, eta).conj();
        }
        spectrum.push((w, sum * multiplicity / plan.modes().volume()));
    });
    let best = work.scores.iter().fold(0.0, f64::max);
    for voxel in (0..work.scores.count()).step_by(work.scores.count() / 60) {
        let t = engine.position(voxel);
        let direct: f64 = spectrum
            .iter()
            .map(|(w, value)| {
                let turns = w[0] * t[0] + w[1] * t[1] + w[2] * t[2];
                (value * Complex64::cis(2.0 * PI * turns)).re
            })
            .sum();
        let error = (direct - work.scores.score(voxel)).abs() / best;
        assert!(
            error <= 1e-3,
            "voxel {voxel}: {direct} against {}",
            work.scores.score(voxel)
        );
    }
}

/// B&I eq. 53 from the complex affinity functions themselves (eq. 51), in the engine's order of operations. Both are 4D
/// points, the ligand r-mirrored with conjugated phases; then come the product for each mode, the sum over eta, and the
/// inverse transform.
///
/// The weights must not be conjugated. Conjugating one, as eq. 52 prints it, gives the score with the other sign.
#[test]
fn complex_affinity_functions_multiply_to_the_score() {
    let (a, b) = (cloud(8, 4.0, &RADII, 7), cloud(4, 2.5, &RADII, 8));
    let plan = Arc::new(Plan::new(&a, &b, options(1e-3)).unwrap());
    let spectra = ReceptorSpectra::new(&plan, &a, &b, Quantity::Score, Precision::Double);
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &b, spectra.full_rank());
    let mut work = engine.workspace();
    let rotation = Pose::from_parts([0.9, 0.3, -0.1, 0.4], [0.0; 3]).rotation;
    engine.correlate(&rotation, &mut work);

    let kernel = plan.kernel().options();
    let affinity =
        |solid| scene::test_support::AffinityKnots::of(solid, kernel.lambda, kernel.offset);
    let (receptor, ligand) = (affinity(&a), affinity(&b));
    let about = |x: &[f64; 3], center: Vector3<f64>| Vector3::from(*x) - center;
    let x: Vec<[f64; 3]> = receptor
        .centers
        .iter()
        .map(|x| about(x, plan.receptor_center()).into())
        .collect();
    let y: Vec<[f64; 3]> = ligand
        .centers
        .iter()
        .map(|y| (rotation * about(y, plan.ligand_center())).into())
        .collect();
    let mirrored: Vec<f64> = ligand.radii.iter().map(|s| -s).collect();
    let conjugated: Vec<Complex64> = ligand.weights.iter().map(|d| d.conj()).collect();
    let modes = plan.axis().modes() as i64;
    let spectrum_with = |weights: &[Complex64]| {
        let mut spectrum = Vec::new();
        plan.modes().for_each(|_, w, multiplicity| {
            let length = w.iter().map(|x| x * x).sum::<f64>().sqrt();
            let mut sum = Complex64::new(0.0, 0.0);
            for k in -modes..=modes {
                let eta = plan.axis().eta(k);
                sum += plan.axis().coefficient(plan.kernel(), length, k)
                    * ndft_4d(&x, &receptor.radii, &receptor.weights, w, eta)
                    * ndft_4d(&y, &mirrored, weights, w, eta).conj();
            }
            spectrum.push((w, sum * multiplicity / plan.modes().volume()));
        });
        spectrum
    };
    // The conjugate of the whole transform conjugates the weights once more.
    let (product, as_printed) = (spectrum_with(&conjugated), spectrum_with(&ligand.weights));
    let best = work.scores.iter().fold(0.0, f64::max);
    for voxel in (0..work.scores.count()).step_by(work.scores.count() / 40) {
        let t = engine.position(voxel);
        let at = |spectrum: &[([f64; 3], Complex64)]| -> f64 {
            let value = |(w, value): &([f64; 3], Complex64)| {
                let turns = w[0] * t[0] + w[1] * t[1] + w[2] * t[2];
                (value * Complex64::cis(2.0 * PI * turns)).re
            };
            spectrum.iter().map(value).sum()
        };
        let (score, fast) = (at(&product), work.scores.score(voxel));
        assert!(
            (score - fast).abs() <= 1e-3 * best,
            "voxel {voxel}: {score} against {fast}"
        );
        assert!((score + at(&as_printed)).abs() <= 1e-9 * best.max(score.abs()));
    }
}

/// A lower rank cut out of a full engine is the engine built at that rank, to the bit, and its error falls as the rank
/// rises.
#[test]
fn a_truncated_engine_is_the_one_of_lower_rank() {
    let (a, b) = (cloud(60, 8.0, &RADII, 15), cloud(30, 5.0, &RADII, 16));
    let plan = Arc::new(Plan::new(&a, &b, options(1e-2)).unwrap());
    let spectra = ReceptorSpectra::new(&plan, &a, &b, Quantity::Score, Precision::Double);
    let full = CpuEngine::new(Arc::clone(&plan), &spectra, &b, spectra.full_rank());
    let turned = Pose::from_parts([0.1, 0.6, -0.5, 0.2], [0.0; 3]).rotation;
    let grid = |engine: &CpuEngine| {
        let mut work = engine.workspace();
        engine.correlate(&turned, &mut work);
        work.scores.to_vec()
    };
    let exact = grid(&full);
    assert!(full.rank() > 2);
    let errors: Vec<f64> = (1..full.rank())
        .map(|rank| {
            let cut = full.truncated(rank);
            assert_eq!(cut.rank(), rank);
            let values = grid(&cut);
            assert_eq!(
                values,
                grid(&CpuEngine::new(Arc::clone(&plan), &spectra, &b, rank))
            );
            let differences = values.iter().zip(&exact).map(|(x, y)| (x - y).abs());
            differences.fold(0.0, f64::max)
        })
        .collect();
    assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
    assert_eq!(grid(&full.truncated(full.rank() + 1)), exact);
}

/// Turning or moving an input must leave the fast score at the carried pose within the tolerance: the grid falls
/// elsewhere on the molecules, so any dependence on it would show.
#[test]
fn moved_inputs_keep_their_fast_scores() {
    let (a, b) = (cloud(100, 9.0, &RADII, 9), cloud(40, 6.0, &RADII, 10));
    let motion = Pose::from_parts([0.5, 0.1, -0.7, 0.3], [1e4, -300.0, 77.7]);
    let mut moved = a.clone();
    for x in &mut moved.centers {
        *x = motion.apply(*x);
    }
    let error = worst(Precision::Double, &moved, &b, 1e-3, Quantity::Score);
    assert!(error <= 1e-3, "{error:e}");
}

/// No pose may score through the periodic image: beside the box's far face both the receptor and its image are near,
/// and the exact sum, which has no image, must agree there too.
#[test]
fn nothing_scores_through_the_periodic_image() {
    let (a, b) = (cloud(80, 8.0, &RADII, 11), cloud(60, 9.0, &RADII, 12));
    let plan = Arc::new(Plan::new(&a, &b, options(1e-2)).unwrap());
    let spectra = ReceptorSpectra::new(&plan, &a, &b, Quantity::Score, Precision::Double);
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &b, spectra.full_rank());
    let scorer = ExactScorer::new(plan.kernel(), &a, &b).unwrap();
    let mut work = engine.workspace();
    let rotation = Pose::identity().rotation;
    engine.correlate(&rotation, &mut work);
    let best = work.scores.iter().fold(0.0, f64::max);
    let mut checked = 0;
    for voxel in 0..work.scores.count() {
        let t = engine.position(voxel);
        let far =
            (0..3).any(|axis| 0.5 * plan.modes().lengths[axis] - t[axis].abs() < plan.spacing());
        if far && voxel % 7 == 0 {
            let pose = Pose::about(rotation, plan.ligand_center(), plan.receptor_center() + t);
            let error = (work.scores.score(voxel) - scorer.score(&pose).score).abs() / best;
            assert!(error <= 1e-2, "at {t:?}: {error:e}");
            checked += 1;
        }
    }
    assert!(checked > 100);
}
