//! One configuration from chosen modes: against the engine's grid, finite differences, the exact sum, and the error
//! that it states.

use crate::scene;
use crate::scene::{RADII, engine_options as options};
use knotdock_scoring::Precision;
use knotdock_scoring::engine::ReceptorSpectra;
use knotdock_scoring::engine::{CpuEngine, Plan};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::transform::truncation::{Selection, rms_left_out, total};
use knotdock_scoring::truncated::TruncatedCorrelation;
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};
use std::sync::Arc;

/// A ball of knots off the origin.
fn cloud(count: usize, size: f64, radii: &[f64], seed: u64) -> Knots {
    let away = Pose {
        translation: Vector3::new(100.0, -20.0, 3.0),
        ..Pose::identity()
    };
    scene::moved(&scene::cloud(count, size, radii, seed), &away)
}

struct Pair {
    receptor: Knots,
    ligand: Knots,
    plan: Arc<Plan>,
    spectra: ReceptorSpectra,
}

impl Pair {
    fn new(receptor: Knots, ligand: Knots, tolerance: f64, quantity: Quantity) -> Self {
        let plan = Arc::new(Plan::new(&receptor, &ligand, options(tolerance)).unwrap());
        let spectra = ReceptorSpectra::new(&plan, &receptor, &ligand, quantity, Precision::Double);
        Self {
            receptor,
            ligand,
            plan,
            spectra,
        }
    }

    fn clouds(tolerance: f64, quantity: Quantity, seed: u64) -> Self {
        let receptor = cloud(70, 8.0, &RADII, seed);
        Self::new(
            receptor,
            cloud(29, 5.0, &RADII, seed + 1),
            tolerance,
            quantity,
        )
    }

    fn configuration(&self, selection: &Selection) -> TruncatedCorrelation {
        TruncatedCorrelation::new(&self.plan, &self.spectra, &self.ligand, selection)
    }

    fn whole(&self) -> TruncatedCorrelation {
        self.configuration(&Selection::all(self.plan.modes()))
    }

    /// The pose that puts the ligand's centre at `place` relative to the receptor's.
    fn pose(&self, rotation: UnitQuaternion<f64>, place: Vector3<f64>) -> Pose {
        Pose::about(
            rotation,
            self.plan.ligand_center(),
            self.plan.receptor_center() + place,
        )
    }

    fn engine(&self) -> CpuEngine {
        let rank = self.spectra.full_rank();
        CpuEngine::new(Arc::clone(&self.plan), &self.spectra, &self.ligand, rank)
    }
}

fn turn(seed: f64) -> UnitQuaternion<f64> {
    Pose::from_parts([0.3 + seed, -0.2, 0.8, 0.4 - seed], [0.0; 3]).rotation
}

#[test]
fn at_voxels_it_is_the_engines_grid() {
    let pair = Pair::clouds(1e-6, Quantity::Score, 1);
    let (engine, whole) = (pair.engine(), pair.whole());
    assert_eq!(whole.modes(), total(pair.plan.modes()));
    let (mut grid, mut work) = (engine.workspace(), whole.workspace());
    let rotation = turn(0.1);
    engine.correlate(&rotation, &mut grid);
    let best = grid.scores.iter().fold(0.0, f64::max);
    let prepared = whole.prepare(&rotation, &mut work);
    let mut worst = 0.0f64;
    for voxel in (0..grid.scores.count()).step_by(grid.scores.count() / 60) {
        let pose = pair.pose(rotation, engine.position(voxel));
        let (by_translation, _) = prepared.gradient(&pose.translation, &mut work);
        let (by_knots, _) = whole.gradient(&pose, &mut work);
        worst = worst.max((by_translation - grid.scores.score(voxel)).abs() / best);
        worst = worst.max((by_knots - grid.scores.score(voxel)).abs() / best);
    }
    println!("worst difference {worst:e} of the best score");
    assert!(worst < 1e-6);
}

/// Many radii: components come from the factored lifted axis. Both ways of summing must still agree with the exact sum.
#[test]
fn every_knot_its_own_radius() {
    let many: Vec<f64> = (0..90).map(|i| 1.5 + 0.4 * f64::from(i) / 89.0).collect();
    let pair = Pair::new(
        cloud(90, 9.0, &many, 5),
        cloud(40, 5.0, &many, 6),
        1e-3,
        Quantity::Score,
    );
    let (whole, engine) = (pair.whole(), pair.engine());
    let scorer = ExactScorer::new(pair.plan.kernel(), &pair.receptor, &pair.ligand).unwrap();
    let mut work = whole.workspace();
    let mut grid = engine.workspace();
    engine.correlate(&turn(0.0), &mut grid);
    let best = grid.scores.iter().fold(0.0, f64::max);
    let prepared = whole.prepare(&turn(0.0), &mut work);
    for i in 0..20 {
        let place = Vector3::new(13.0 - 0.3 * f64::from(i), 0.4 * f64::from(i), -2.0);
        let pose = pair.pose(turn(0.0), place);
        let exact = scorer.score(&pose).score;
        for value in [
            prepared.gradient(&pose.translation, &mut work).0,
            whole.gradient(&pose, &mut work).0,
        ] {
            assert!(
                (value - exact).abs() <= 1e-3 * best,
                "{value} is not {exact}"
            );
        }
    }
}

#[test]
fn gradients_are_the_slopes_of_the_value() {
    let pair = Pair::clouds(1e-3, Quantity::Score, 11);
    let modes = pair.plan.modes();
    let some = Selection::low_frequency(modes, 700);
    for selection in [Selection::all(modes), some] {
        let configuration = pair.configuration(&selection);
        let mut work = configuration.workspace();
        let pose = pair.pose(turn(0.2), Vector3::new(9.3, -4.1, 2.2));
        let (value, gradient) = configuration.gradient(&pose, &mut work);
        let prepared = configuration.prepare(&pose.rotation, &mut work);
        let (same, force) = prepared.gradient(&pose.translation, &mut work);
        let scale = gradient.force.norm() + gradient.torque.norm();
        assert!((value - same).abs() < 1e-10 * scale);
        assert!((force - gradient.force).norm() < 1e-10 * scale);
        let h = 1e-4;
        for axis in 0..3 {
            let step = Vector3::ith(axis, h);
            let at = |pose: Pose, work: &mut _| configuration.gradient(&pose, work).0;
            let moved = |sign: f64| Pose {
                translation: pose.translation + sign * step,
                ..pose
            };
            let slope = (at(moved(1.0), &mut work) - at(moved(-1.0), &mut work)) / (2.0 * h);
            assert!((slope - gradient.force[axis]).abs() < 1e-6 * scale);
            let center = pose.rotation * pair.plan.ligand_center() + pose.translation;
            let turned = |sign: f64| {
                let rotation = UnitQuaternion::new(sign * step) * pose.rotation;
                Pose::about(rotation, pair.plan.ligand_center(), center)
            };
            let slope = (at(turned(1.0), &mut work) - at(turned(-1.0), &mut work)) / (2.0 * h);
            assert!((slope - gradient.torque[axis]).abs() < 1e-6 * scale);
        }
    }
}

/// A ladder in both orders ends at the exact score; less is left out at every step.
#[test]
fn ladders_converge_to_the_exact_score() {
    let pair = Pair::clouds(1e-4, Quantity::Score, 21);
    let modes = pair.plan.modes();
    let scorer = ExactScorer::new(pair.plan.kernel(), &pair.receptor, &pair.ligand).unwrap();
    let whole = pair.whole();
    let mut work = whole.workspace();
    let rotation = turn(-0.3);
    let prepared = whole.prepare(&rotation, &mut work);
    let magnitudes = prepared.magnitudes(modes.count);
    let pose = pair.pose(rotation, Vector3::new(-3.0, 11.0, 1.0));
    let exact = scorer.score(&pose).score;
    let (full, _) = prepared.gradient(&pose.translation, &mut work);
    for order in [0, 1] {
        let mut last = f64::INFINITY;
        for most in [64, 256, 1024, 4096, 16_384, usize::MAX] {
            let selection = match order {
                0 => Selection::low_frequency(modes, most),
                _ => Selection::by_magnitude(modes, &magnitudes, most),
            };
            let few = pair.configuration(&selection);
            assert!(few.modes() <= most && few.modes() == selection.modes());
            let (value, _) = few
                .prepare(&rotation, &mut work)
                .gradient(&pose.translation, &mut work);
            let (by_knots, _) = few.gradient(&pose, &mut work);
            assert!((value - by_knots).abs() < 1e-9 * full.abs().max(1.0));
            let rms = rms_left_out(modes, &selection, &magnitudes);
            let error = (value - full).abs();
            println!(
                "order {order}, {:6} modes: {value:9.3}, error {error:.2e}, rms {rms:.2e}",
                few.modes()
            );
            assert!(rms <= last);
            last = rms;
        }
        assert!(
            (full - exact).abs() < 1e-3 * exact.abs(),
            "{full} is not {exact}"
        );
    }
}

/// By Parseval the stated rms is the root mean square of the grid's error to rounding, once modes of the product do not
/// alias. They do not alias here, as the grid holds every mode of the set.
#[test]
fn the_whole_correlation_truncated_has_the_rms_that_is_stated() {
    let mut pair = Pair::clouds(1e-6, Quantity::Score, 31);
    let whole = pair.whole();
    let mut work = whole.workspace();
    let rotation = turn(0.4);
    let magnitudes = whole
        .prepare(&rotation, &mut work)
        .magnitudes(pair.plan.modes().count);
    let engine = pair.engine();
    let mut full = engine.workspace();
    engine.correlate(&rotation, &mut full);
    let best = full.scores.iter().fold(0.0, f64::max);
    // From many modes to few, since those left out of the spectra spectra do not come back.
    for most in [20_000, 4096, 512, 65] {
        let plan = Arc::clone(&pair.plan);
        let selection = Selection::low_frequency(plan.modes(), most);
        pair.spectra.keep(&selection);
        let engine = pair.engine();
        let mut few = engine.workspace();
        engine.correlate(&rotation, &mut few);
        let errors = full
            .scores
            .iter()
            .zip(few.scores.iter())
            .map(|(a, b)| (a - b).powi(2));
        let rms = (errors.sum::<f64>() / few.scores.count() as f64).sqrt();
        let stated = rms_left_out(plan.modes(), &selection, &magnitudes);
        println!("{most}: rms {rms:.4e} of {stated:.4e}");
        // The engine transforms to 1e-6 of the best score, which the smallest of these are near.
        assert!((rms - stated).abs() < 1e-4 * stated + 1e-6 * best);

        // Cut to a ball, transforms and all, it is that ball's own low-frequency selection.
        let cut = Arc::new(plan.truncated(most));
        assert!(total(cut.modes()) <= most);
        let spectra = ReceptorSpectra::new(
            &cut,
            &pair.receptor,
            &pair.ligand,
            Quantity::Score,
            Precision::Double,
        );
        let engine = CpuEngine::new(
            Arc::clone(&cut),
            &spectra,
            &pair.ligand,
            spectra.full_rank(),
        );
        let mut ball = engine.workspace();
        engine.correlate(&rotation, &mut ball);
        let stated = rms_left_out(
            plan.modes(),
            &Selection::low_frequency(plan.modes(), total(cut.modes())),
            &magnitudes,
        );
        let errors = full
            .scores
            .iter()
            .zip(ball.scores.iter())
            .map(|(a, b)| (a - b) * (a - b));
        let rms = (errors.sum::<f64>() / ball.scores.count() as f64).sqrt();
        assert!((rms - stated).abs() < 1e-4 * stated + 1e-6 * best);
    }
}

/// The derivative dg/drho by differentiation along the lifted axis against finite differences of the exact kernel in
/// rho. All ligand radii grown and shrunk by h move every radius sum, as an offset does.
#[test]
fn offset_sensitivity_is_the_slope_of_the_exact_slices() {
    let h = 1e-3;
    let pairs = [
        Quantity::SliceByOffset(0),
        Quantity::SliceByOffset(1),
        Quantity::SliceByOffset(2),
        Quantity::ScoreByOffset,
    ]
    .map(|quantity| Pair::clouds(1e-5, quantity, 41));
    let first = &pairs[0];
    let grown = |by: f64| {
        let mut ligand = first.ligand.clone();
        ligand.radii.iter_mut().for_each(|radius| *radius += by);
        ExactScorer::new(first.plan.kernel(), &first.receptor, &ligand).unwrap()
    };
    let (more, less) = (grown(h), grown(-h));
    let mut worst = [0.0f64; 4];
    let mut largest = [0.0f64; 4];
    let configurations = [0, 1, 2, 3].map(|i| pairs[i].whole());
    let mut work = configurations[0].workspace();
    for i in 0..12 {
        let place = Vector3::new(14.0 - f64::from(i), 1.0, 0.3 * f64::from(i));
        let pose = first.pose(turn(0.05 * f64::from(i)), place);
        let (a, b) = (more.score(&pose), less.score(&pose));
        for part in 0..4 {
            let slope = match part {
                3 => (a.score - b.score) / (2.0 * h),
                _ => (a.slices[part] - b.slices[part]) / (2.0 * h),
            };
            let ours = configurations[part].gradient(&pose, &mut work).0;
            worst[part] = worst[part].max((ours - slope).abs());
            largest[part] = largest[part].max(slope.abs());
        }
    }
    println!("worst {worst:?} of {largest:?}");
    for part in 0..4 {
        assert!(worst[part] < 1e-4 * largest[part]);
    }
}

/// Beyond the box the polynomial repeats; the pair does not.
#[test]
fn a_ligand_far_away_scores_nothing() {
    let pair = Pair::clouds(1e-2, Quantity::Score, 51);
    let whole = pair.whole();
    let mut work = whole.workspace();
    let prepared = whole.prepare(&turn(0.0), &mut work);
    for far in [1.0, 2.0, 1e6] {
        let pose = pair.pose(
            turn(0.0),
            Vector3::new(far * pair.plan.modes().lengths[0], 0.0, 0.0),
        );
        assert_eq!(whole.gradient(&pose, &mut work), Default::default());
        assert_eq!(
            prepared.gradient(&pose.translation, &mut work),
            Default::default()
        );
    }
}
