//! Effects beside shape: each by the fast path, run alone, against its exact pair sum, that against a plain double
//! loop, and scenes whose answer is known.

use knotdock_scoring::Precision;
use knotdock_scoring::engine::{CpuEngine, EngineOptions, Plan, ReceptorSpectra};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::kernel::KernelOptions;
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::effect::contact::{self, Potential};
use knotdock_scoring::terms::effect::restraint::{ResidueRole, Weights};
use knotdock_scoring::terms::effect::{ActiveTerm, Effect, Term, electrostatics, restraint};
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};
use std::sync::Arc;

use crate::scene::Numbers;

fn options(tolerance: f64) -> EngineOptions {
    EngineOptions {
        kernel: KernelOptions {
            lambda: 10.0,
            ..KernelOptions::default()
        },
        spacing: None,
        tolerance,
    }
}

/// Labelled knots strewn over a ball: a third without charge, one in seven of no contact type.
fn cloud(count: usize, size: f64, seed: u64) -> Knots {
    let mut numbers = Numbers(seed);
    let mut next = || numbers.next();
    let mut centers = Vec::new();
    while centers.len() < count {
        let p: [f64; 3] = std::array::from_fn(|_| size * (2.0 * next() - 1.0));
        if p.iter().map(|x| x * x).sum::<f64>() < size * size {
            centers.push(p);
        }
    }
    let radii = [1.42, 1.64, 1.88];
    let charges = (0..count)
        .map(|i| if i % 3 == 0 { 0.0 } else { next() - 0.5 })
        .collect();
    let types = (0..count)
        .map(|i| (i % 7 != 0).then_some((i * 5 % 18) as u8))
        .collect();
    Knots::new(centers, (0..count).map(|i| radii[i % 3]).collect())
        .unwrap()
        .with_labels(charges, types)
        .unwrap()
}

/// The terms of labelled knots of which none is blocked.
fn free_terms(a: &Knots, b: &Knots) -> Vec<Term> {
    vec![
        electrostatics::term(a, b, 8.0),
        contact::term(a, b, 0.7, &Potential::default()),
    ]
}

/// The same, every fourth knot of the receptor and every fifth of the ligand blocked at half the weight of contact,
/// as the defaults have it, and as many active.
fn terms(a: &Knots, b: &Knots) -> Vec<Term> {
    let every = |knots: &Knots, step: usize| -> Vec<ResidueRole> {
        let mark = |count: usize| match count % step {
            0 => ResidueRole::Excluded,
            1 => ResidueRole::Active,
            _ => ResidueRole::Free,
        };
        (1..=knots.len()).map(mark).collect()
    };
    let mut terms = free_terms(a, b);
    let marks = [&every(a, 4)[..], &every(b, 5)];
    let weights = Weights {
        excluded: 0.35,
        active: 0.2,
    };
    terms.push(restraint::term(a, b, marks, weights));
    terms
}

fn planned(a: &Knots, b: &Knots, tolerance: f64, terms: Vec<Term>) -> Arc<Plan> {
    let options = options(tolerance);
    Arc::new(Plan::with_effects(a, b, options, tolerance, terms).unwrap())
}

fn plan(a: &Knots, b: &Knots, tolerance: f64) -> Arc<Plan> {
    planned(a, b, tolerance, terms(a, b))
}

fn scorer(plan: &Plan, a: &Knots, b: &Knots) -> ExactScorer {
    ExactScorer::with_effects(plan.kernel(), a, b, plan.effects()).unwrap()
}

fn turn() -> UnitQuaternion<f64> {
    Pose::from_parts([0.3, -0.2, 0.8, 0.4], [0.0; 3]).rotation
}

/// Largest error of `effect` alone, or of all, over the grid's best and a sweep of it. It is a share of the largest
/// exact value there; of a restraint, which is nowhere above 0, of the largest magnitude.
fn worst(
    precision: Precision,
    a: &Knots,
    b: &Knots,
    tolerance: f64,
    effect: Option<Effect>,
) -> f64 {
    let plan = plan(a, b, tolerance);
    let scorer = scorer(&plan, a, b);
    let mut spectra = ReceptorSpectra::new(&plan, a, b, Quantity::Score, precision);
    if let Some(effect) = effect {
        for other in Effect::ALL.into_iter().filter(|other| *other != effect) {
            spectra = spectra.without(other);
        }
    }
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, b, spectra.full_rank());
    let mut work = engine.workspace();
    engine.correlate(&turn(), &mut work);
    let mut order: Vec<usize> = (0..work.scores.count()).collect();
    order.sort_by(|&x, &y| {
        work.scores
            .score(y)
            .partial_cmp(&work.scores.score(x))
            .unwrap()
    });
    let sweep = order.iter().copied().step_by(order.len() / 200);
    let (mut error, mut best) = (0.0f64, 0.0f64);
    for voxel in order[..100].iter().copied().chain(sweep) {
        let place = plan.receptor_center() + engine.position(voxel);
        let exact = scorer.score(&Pose::about(turn(), plan.ligand_center(), place));
        let value = effect.map_or(exact.score, |effect| exact.terms[effect as usize]);
        error = error.max((value - work.scores.score(voxel)).abs());
        best = best.max(match effect {
            Some(Effect::Restraint) => value.abs(),
            _ => value,
        });
    }
    error / best
}

#[test]
fn each_term_alone_and_all_together_meet_the_requested_tolerance() {
    let (a, b) = (cloud(160, 12.0, 1), cloud(60, 8.0, 2));
    let alone = Effect::ALL.into_iter().skip(1).map(Some);
    for effect in alone.chain([None]) {
        for tolerance in [1e-2, 1e-4, 1e-6] {
            let error = worst(Precision::Double, &a, &b, tolerance, effect);
            assert!(error <= tolerance, "{effect:?} at {tolerance:e}: {error:e}");
        }
        for tolerance in [1e-2, 1e-4] {
            let error = worst(Precision::Single, &a, &b, tolerance, effect);
            assert!(
                error <= tolerance,
                "{effect:?}, f32 at {tolerance:e}: {error:e}"
            );
        }
    }
}

/// The tables and blocks of the exact sum against a double loop over the kernels' definition; terms add up to the
/// score; the gradient is that of central differences.
#[test]
fn the_exact_terms_are_the_plain_double_sum() {
    let (a, b) = (cloud(90, 10.0, 3), cloud(40, 7.0, 4));
    let plan = plan(&a, &b, 1e-2);
    let scorer = scorer(&plan, &a, &b);
    for shift in [[0.0, 0.0, 0.0], [9.0, -5.0, 6.0], [14.0, 9.0, -8.0]] {
        let pose = Pose::from_parts([0.3, -0.2, 0.8, 0.4], shift);
        let exact = scorer.score(&pose);
        for ActiveTerm { term, kernel } in plan.effects() {
            let mut plain = 0.0;
            for (y, ligand) in b.centers.iter().zip(&term.ligand) {
                let y = Vector3::from(pose.apply(*y));
                for (x, receptor) in a.centers.iter().zip(&term.receptor) {
                    let weight = receptor.value * ligand.value;
                    plain += weight
                        * term.matrix[receptor.class][ligand.class]
                        * kernel.value((y - Vector3::from(*x)).norm());
                }
            }
            let value = exact.terms[term.effect as usize];
            assert!((value - plain).abs() < 1e-7 * plain.abs().max(10.0));
        }
        assert!((exact.terms.iter().sum::<f64>() - exact.score).abs() < 1e-9);
        assert!((scorer.score_only(&pose) - exact.score).abs() < 1e-8 * exact.score.abs());
        let (value, gradient) = scorer.gradient(&pose);
        assert!((value - exact.score).abs() < 1e-8 * exact.score.abs());
        let h = 1e-5;
        for axis in 0..3 {
            let mut step = Vector3::zeros();
            step[axis] = h;
            let moved = |sign: f64| {
                let translation = pose.translation + step * sign;
                scorer.score_only(&Pose {
                    translation,
                    ..pose
                })
            };
            let turned = |sign: f64| {
                let turn = UnitQuaternion::new(step * sign);
                let arm = pose.rotation * scorer.ligand_center();
                scorer.score_only(&Pose {
                    rotation: turn * pose.rotation,
                    translation: pose.translation + arm - turn * arm,
                })
            };
            let slopes = [
                (moved(1.0) - moved(-1.0), gradient.force),
                (turned(1.0) - turned(-1.0), gradient.torque),
            ];
            for (difference, slope) in slopes {
                let error = difference / (2.0 * h) - slope[axis];
                assert!(error.abs() < 1e-5 * slope.norm(), "{error} of {slope}");
            }
        }
    }
}

/// The receptor's field, which adds up classes before it samples, reads the same score and slope.
#[test]
fn the_field_reads_all_terms() {
    let (a, b) = (cloud(160, 12.0, 5), cloud(60, 8.0, 6));
    let plan = plan(&a, &b, 1e-2);
    let scorer = scorer(&plan, &a, &b);
    let spectra = ReceptorSpectra::new(&plan, &a, &b, Quantity::Score, Precision::Single);
    let field = PotentialGrid::new(&plan, &spectra, &b);
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &b, spectra.full_rank());
    let mut work = engine.workspace();
    engine.correlate(&turn(), &mut work);
    let scale = work.scores.iter().fold(0.0, f64::max);
    // The plan's tolerance, against the exact sum; the grid's own error is a hundredth of it (potential_grid.rs).
    // Strewn knots touch in few places: their best score is a tenth of a protein's.
    let bound = 2e-2;
    for shift in [[15.0, -9.0, 6.0], [14.0, 9.0, -8.0], [0.0, 17.0, 5.0]] {
        let pose = Pose::from_parts([0.3, -0.2, 0.8, 0.4], shift);
        let ((value, slope), (exact, gradient)) = (field.gradient(&pose), scorer.gradient(&pose));
        assert!((value - exact).abs() < bound * scale, "{value} {exact}");
        assert!((slope.force - gradient.force).norm() < bound * gradient.force.norm().max(scale));
        // Torques are forces times arms of up to 8 Å.
        let torque = gradient.torque.norm().max(8.0 * scale);
        assert!((slope.torque - gradient.torque).norm() < bound * torque);
    }
}

/// All effects together are the sum of each alone: the grids at full rank, and the exact sums' terms.
#[test]
fn effects_add_up() {
    let (a, b) = (cloud(80, 10.0, 17), cloud(40, 7.0, 18));
    let plan = plan(&a, &b, 1e-2);
    let whole = ReceptorSpectra::new(&plan, &a, &b, Quantity::Score, Precision::Double);
    let grid = |spectra: &ReceptorSpectra| {
        let engine = CpuEngine::new(Arc::clone(&plan), spectra, &b, spectra.full_rank());
        let mut work = engine.workspace();
        engine.correlate(&turn(), &mut work);
        work.scores.to_vec()
    };
    let together = grid(&whole);
    let mut sum = vec![0.0; together.len()];
    for effect in Effect::ALL {
        let others = Effect::ALL.into_iter().filter(|other| *other != effect);
        let alone = others.fold(whole.clone(), |spectra, other| spectra.without(other));
        for (sum, value) in sum.iter_mut().zip(grid(&alone)) {
            *sum += value;
        }
    }
    let size = together
        .iter()
        .fold(0.0f64, |size, value| size.max(value.abs()));
    for (voxel, (sum, together)) in sum.iter().zip(&together).enumerate() {
        assert!(
            (sum - together).abs() < 1e-11 * size,
            "{voxel}: {sum} {together}"
        );
    }

    let pose = Pose::from_parts([0.3, -0.2, 0.8, 0.4], [11.0, -6.0, 4.0]);
    let exact = scorer(&plan, &a, &b).score(&pose);
    assert_eq!(exact.score, exact.terms.iter().sum::<f64>());
    for active in plan.effects() {
        let one = std::slice::from_ref(active);
        let alone = ExactScorer::with_effects(plan.kernel(), &a, &b, one).unwrap();
        let alone = alone.score(&pose).terms;
        for effect in [active.term.effect as usize, Effect::Shape as usize] {
            assert_eq!(alone[effect], exact.terms[effect]);
        }
    }
}

/// The sum of G over all voxels is the mode at frequency zero times their number, all effects included. That mode is
/// the sum over pairs of weights times the kernels' transforms at zero, over the volume of the box.
#[test]
fn the_sum_over_voxels_is_the_zero_mode() {
    let (a, b) = (cloud(60, 9.0, 19), cloud(30, 6.0, 20));
    let plan = plan(&a, &b, 1e-6);
    let spectra = ReceptorSpectra::new(&plan, &a, &b, Quantity::Score, Precision::Double);
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &b, spectra.full_rank());
    let mut work = engine.workspace();
    engine.correlate(&turn(), &mut work);

    let kernel = plan.kernel();
    let weights = kernel.options().slice_weights();
    let offsets = kernel.options().slice_offsets();
    let (mut zero_mode, mut size) = (0.0, 0.0);
    for r in &a.radii {
        for s in &b.radii {
            for (weight, offset) in weights.iter().zip(offsets) {
                let value = weight * kernel.spectrum_of(&kernel.profile(r + s + offset), 0.0);
                zero_mode += value;
                size += value.abs();
            }
        }
    }
    for ActiveTerm { term, kernel } in plan.effects() {
        let [at_zero] = kernel.spectrum_table(plan.modes().cut).value(0.0);
        for x in &term.receptor {
            for y in &term.ligand {
                zero_mode += x.value * term.matrix[x.class][y.class] * y.value * at_zero;
            }
        }
    }
    let voxels = work.scores.count() as f64;
    let sum: f64 = work.scores.iter().sum();
    let mean = sum / voxels * plan.modes().volume();
    let error = (mean - zero_mode).abs() / size;
    assert!(error < 1e-6, "{mean} {zero_mode}: {error:e}");
}

/// A label that no term reads changes not one bit, and neither does a term once it is taken out.
#[test]
fn an_effect_that_is_off_changes_not_one_bit() {
    let (a, b) = (cloud(80, 10.0, 7), cloud(40, 7.0, 8));
    let bare = |knots: &Knots| Knots::new(knots.centers.clone(), knots.radii.clone()).unwrap();
    let grid = |a: &Knots, b: &Knots| {
        let plan = Arc::new(Plan::new(a, b, options(1e-2)).unwrap());
        let spectra = ReceptorSpectra::new(&plan, a, b, Quantity::Score, Precision::Single);
        let engine = CpuEngine::new(Arc::clone(&plan), &spectra, b, spectra.full_rank());
        let mut work = engine.workspace();
        engine.correlate(&turn(), &mut work);
        (spectra.full_rank(), work.scores.to_vec())
    };
    let (rank, plain) = grid(&bare(&a), &bare(&b));
    assert_eq!(grid(&a, &b), (rank, plain));
    let plan = plan(&a, &b, 1e-2);
    let whole = ReceptorSpectra::new(&plan, &a, &b, Quantity::Score, Precision::Single);
    let without = whole
        .without(Effect::Contact)
        .without(Effect::Restraint)
        .without(Effect::Electrostatics);
    assert!(whole.full_rank() > rank);
    assert_eq!(without.full_rank(), rank);
}

/// One knot on each side, at some distance along x.
fn pair(charges: [f64; 2], types: [&str; 2], distance: f64) -> [f64; Effect::ALL.len()] {
    let kind = |name: &str| {
        contact::TYPES
            .iter()
            .position(|known| *known == name)
            .map(|i| i as u8)
    };
    let knot = |charge: f64, name: &str| {
        Knots::new(vec![[0.0; 3]], vec![1.7])
            .unwrap()
            .with_labels(vec![charge], vec![kind(name)])
            .unwrap()
    };
    let (a, b) = (knot(charges[0], types[0]), knot(charges[1], types[1]));
    let plan = planned(&a, &b, 1e-2, free_terms(&a, &b));
    let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [distance, 0.0, 0.0]);
    scorer(&plan, &a, &b).score(&pose).terms
}

/// Opposite charges raise the score, like ones lower it by as much, and less so at larger distances; a neutral knot
/// has no effect.
#[test]
fn opposite_charges_gain_and_like_charges_lose() {
    let electrostatics = Effect::Electrostatics as usize;
    let at = |charges, distance| pair(charges, ["N", "N"], distance)[electrostatics];
    let (near, far) = (at([1.0, -1.0], 4.0), at([1.0, -1.0], 7.0));
    assert!(near > far && far > 0.0, "{near} {far}");
    assert_eq!(at([1.0, 1.0], 4.0), -near);
    assert_eq!(at([0.0, 1.0], 4.0), 0.0);
    // -8 times the energy in kcal/mol; the low-pass to 4.5 Å takes some of it at this distance.
    let energy = -8.0 * (electrostatics::RADIAL.value)(4.0);
    assert!(
        (near + energy).abs() < 0.35 * energy.abs(),
        "{near} {energy}"
    );
}

/// Fat on fat scores, charge on fat and like charge on like do not, and beyond the contact's reach nothing does.
#[test]
fn contacts_know_their_types() {
    let contact = Effect::Contact as usize;
    let at = |types, distance| pair([0.0, 0.0], types, distance)[contact];
    assert!(at(["FCZ", "FCZ"], 4.0) > 0.0);
    assert!(at(["KNZ", "LCD"], 4.0) < 0.0);
    assert!(at(["KNZ", "KNZ"], 4.0) < at(["KNZ", "DOD"], 4.0));
    assert!(at(["FCZ", "FCZ"], 12.0).abs() < 0.05 * at(["FCZ", "FCZ"], 4.0));
}

/// A solid sphere of knots of one label, with a patch of another about +x.
fn patched(charge: [f64; 2], types: [&str; 2], patch: f64) -> Knots {
    let kind = |name: &str| {
        contact::TYPES
            .iter()
            .position(|known| *known == name)
            .map(|i| i as u8)
    };
    let shell = |(radius, count): (f64, usize)| {
        (0..count).map(move |k| {
            let height = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
            let side = (1.0 - height * height).sqrt();
            let turn = 2.399963 * k as f64;
            [side * turn.cos(), side * turn.sin(), height].map(|x| radius * x)
        })
    };
    let shells = [(11.0, 240), (8.0, 120), (5.0, 50), (2.0, 8)];
    let centers: Vec<[f64; 3]> = shells.into_iter().flat_map(shell).collect();
    let inside = |x: &[f64; 3]| usize::from(x[0] > patch);
    let charges = centers.iter().map(|x| charge[inside(x)]).collect();
    let kinds = centers.iter().map(|x| kind(types[inside(x)])).collect();
    let count = centers.len();
    Knots::new(centers, vec![1.8; count])
        .unwrap()
        .with_labels(charges, kinds)
        .unwrap()
}

/// The direction from the receptor's centre in which the best voxel of a correlation lies.
fn best_direction(a: &Knots, b: &Knots, terms: Vec<Term>) -> Vector3<f64> {
    let plan = planned(a, b, 1e-2, terms);
    let spectra = ReceptorSpectra::new(&plan, a, b, Quantity::Score, Precision::Single);
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, b, spectra.full_rank());
    let mut work = engine.workspace();
    engine.correlate(&UnitQuaternion::identity(), &mut work);
    let best = (0..work.scores.count())
        .max_by(|&x, &y| work.scores.score(x).total_cmp(&work.scores.score(y)))
        .unwrap();
    engine.position(best).normalize()
}

/// A ball of half the body's size, of one label.
fn ball(charge: f64, name: &str) -> Knots {
    let mut ball = patched([charge; 2], [name; 2], 0.0);
    for x in &mut ball.centers {
        *x = x.map(|x| 0.5 * x);
    }
    ball
}

/// Round bodies fit alike from everywhere: it is the effect that finds the patch.
#[test]
fn a_ball_finds_the_patch_that_is_made_for_it() {
    let best_direction = |a: &Knots, b: &Knots| best_direction(a, b, free_terms(a, b));
    // A greasy patch on a polar body, and a greasy ball.
    let body = patched([0.0; 2], ["DOD", "LCD"], 8.0);
    let found = best_direction(&body, &ball(0.0, "LCD"));
    assert!(found[0] > 0.9, "{found}");
    // A negative patch on a neutral body attracts a positive ball, and a negative one goes elsewhere.
    let body = patched([0.0, -0.3], ["SOG"; 2], 8.0);
    let (found, elsewhere) = (
        best_direction(&body, &ball(0.2, "SOG")),
        best_direction(&body, &ball(-0.2, "SOG")),
    );
    assert!(found[0] > 0.9, "{found}");
    assert!(elsewhere[0] < 0.5, "{elsewhere}");
}

/// A ball touches the body where nothing is blocked, whichever of the two the marked atoms belong to. That is at the
/// only free patch, away from a blocked one, and at an active one.
#[test]
fn a_ball_goes_where_nothing_is_blocked_and_to_the_active_patch() {
    let (body, ball) = (patched([0.0; 2], ["SOG"; 2], 8.0), ball(0.0, "SOG"));
    let marked = |inside: ResidueRole, outside: ResidueRole| -> Vec<ResidueRole> {
        let inside = |x: &[f64; 3]| if x[0] > 6.0 { inside } else { outside };
        body.centers.iter().map(inside).collect()
    };
    let weights = Weights {
        excluded: 2.0,
        active: 2.0,
    };
    let found = |marks: &[ResidueRole]| {
        let by_receptor = restraint::term(&body, &ball, [marks, &[]], weights);
        let by_ligand = restraint::term(&ball, &body, [&[], marks], weights);
        [
            best_direction(&body, &ball, vec![by_receptor]),
            -best_direction(&ball, &body, vec![by_ligand]),
        ]
    };
    for marks in [
        marked(ResidueRole::Free, ResidueRole::Excluded),
        marked(ResidueRole::Active, ResidueRole::Free),
    ] {
        for place in found(&marks) {
            assert!(place[0] > 0.9, "{place}");
        }
    }
    for place in found(&marked(ResidueRole::Excluded, ResidueRole::Free)) {
        assert!(place[0] < 0.5, "{place}");
    }
}
