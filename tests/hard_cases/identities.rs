//! Identities of the score, of the fast path over whole grids and of the pair sum against closed forms.
//!
//! Other identities are tested elsewhere:
//!
//! - tests/dock_run checks in a run's CSV that its columns add up: shape = -lambda^2 slice_0 + 2 lambda slice_r0 -
//!   slice_2r0.
//! - scoring/tests/identities.rs checks what holds for the pair sum alone (r0 = 0, a split knot, doubled lengths).

use crate::scene::{Pair, RADII, cloud, engine_options, kernel_for, kernel_options, some_rotation};
use knotdock_scoring::Precision;
use knotdock_scoring::engine::{CpuEngine, ReceptorSpectra};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::grid_turn::GridTurn;
use knotdock_scoring::kernel::KernelOptions;
use knotdock_scoring::lifted_axis::RadiusBasis;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::Vector3;

/// The grid of one quantity in f64.
fn grid(pair: &Pair, a: &Knots, b: &Knots, quantity: Quantity) -> Vec<f64> {
    let spectra = ReceptorSpectra::new(&pair.plan, a, b, quantity, Precision::Double);
    let engine = CpuEngine::new(pair.plan.clone(), &spectra, b, spectra.full_rank());
    let mut work = engine.workspace();
    engine.correlate(&some_rotation(), &mut work);
    work.scores.to_vec()
}

fn largest(grid: &[f64]) -> f64 {
    grid.iter().fold(0.0, |a, b| a.max(b.abs()))
}

/// The correlation of the score is the weighted sum of its three slices' correlations, over the whole grid. With r0 =
/// 0 the slices are equal, and it is -(lambda - 1)^2 times one of them.
#[test]
fn the_grid_of_the_score_is_the_weighted_sum_of_the_slices() {
    let (a, b) = (cloud(80, 9.0, &RADII, 1), cloud(40, 6.0, &RADII, 2));
    for (lambda, offset) in [(10.0, 2.0), (0.0, 2.0), (1e3, 2.0), (10.0, 0.0), (1e3, 0.0)] {
        let mut options = engine_options(1e-3);
        options.kernel = KernelOptions {
            lambda,
            offset,
            ..options.kernel
        };
        let pair = Pair::new(Precision::Double, &a, &b, options);
        let score = grid(&pair, &a, &b, Quantity::Score);
        let slices = [0, 1, 2].map(|slice| grid(&pair, &a, &b, Quantity::Slice(slice)));
        let [w0, w1, w2] = options.kernel.slice_weights();
        let size = (1.0 + lambda).powi(2) * largest(&slices[2]);
        for voxel in 0..score.len() {
            let [g0, g1, g2] = [0, 1, 2].map(|slice| slices[slice][voxel]);
            let sum = w0 * g0 + w1 * g1 + w2 * g2;
            assert!(
                (score[voxel] - sum).abs() < 1e-11 * size,
                "lambda {lambda}, r0 {offset}"
            );
            if offset == 0.0 {
                let single = -(lambda - 1.0).powi(2) * g0;
                assert!((score[voxel] - single).abs() < 1e-11 * size);
            }
        }
    }
}

/// With lambda = 1 the score is a second difference, and as r0 -> 0 tends to -r0^2 d2g / d rho2. For alpha = 2 that
/// derivative has a closed form. Let u = (d / sigma)^2 and psi = exp(-u / (1 - u)). Then `d ln psi / d sigma = 2 u /
/// (sigma (1 - u)^2)`. The error must fall like r0^3 (first order relative to r0^2), until the digits of the
/// difference end.
#[test]
fn without_a_preference_for_contact_the_score_is_a_second_derivative() {
    let (a, b) = (cloud(60, 8.0, &RADII, 3), cloud(30, 5.0, &RADII, 4));
    let pose = Pose::from_parts([0.5, 0.1, -0.4, 0.7], [7.0, -6.0, 4.0]);
    let second = |d: f64, sigma: f64| {
        if d >= sigma {
            return 0.0;
        }
        let u = (d / sigma).powi(2);
        let psi = (-u / (1.0 - u)).exp();
        let slope = 2.0 * u / (sigma * (1.0 - u).powi(2));
        // d slope / d sigma, from du / d sigma = -2 u / sigma.
        let curve = -6.0 * u / (sigma * sigma * (1.0 - u).powi(2))
            - 8.0 * u * u / (sigma * sigma * (1.0 - u).powi(3));
        psi * (slope * slope + curve)
    };
    let mut limit = 0.0;
    for (x, r) in a.centers.iter().zip(&a.radii) {
        for (y, s) in b.centers.iter().zip(&b.radii) {
            let d = (Vector3::from(pose.apply(*y)) - Vector3::from(*x)).norm();
            limit -= second(d, r + s);
        }
    }
    let mut last = f64::INFINITY;
    for offset in [0.1, 0.01, 1e-3] {
        let options = KernelOptions {
            lambda: 1.0,
            offset,
            ..kernel_options()
        };
        let scorer = ExactScorer::new(&kernel_for(options, &a, &b), &a, &b).unwrap();
        let error = (scorer.score(&pose).unfiltered / (offset * offset) / limit - 1.0).abs();
        println!("r0 = {offset}: {error:.2e}");
        assert!(
            error < 4.0 * offset && error < 0.2 * last,
            "r0 = {offset}: {error:e}"
        );
        last = error;
    }
}

/// The mean over all translations is the mode at frequency zero, sum_ij c_i d_j times the pair kernels' volumes over
/// the box's: whatever the rotation, half-turns included. The volumes come from the kernel's definition, not from the
/// engine's lifted modes.
#[test]
fn the_grids_mean_is_the_same_for_all_rotations() {
    let (a, b) = (cloud(80, 9.0, &RADII, 5), cloud(40, 6.0, &RADII, 6));
    let pair = Pair::new(Precision::Double, &a, &b, engine_options(1e-3));
    let kernel = pair.plan.kernel();
    let weights = kernel.options().slice_weights();
    let (mut expected, mut size) = (0.0, 0.0);
    for r in &a.radii {
        for s in &b.radii {
            for (weight, offset) in weights.into_iter().zip(kernel.options().slice_offsets()) {
                let volume = volume(kernel, r + s + offset);
                expected += weight * volume;
                size += (weight * volume).abs();
            }
        }
    }
    let volume = pair.plan.modes().volume();
    let mut work = pair.engine.workspace();
    let mut first = None;
    for turn in 0..5 {
        let rotation = Pose::from_parts([0.4, 0.3 * f64::from(turn), -0.5, 0.2], [0.0; 3]).rotation;
        pair.engine.transform_ligand(&rotation, &mut work);
        for half_turn in GridTurn::HALF_TURNS {
            pair.engine.correlate_turned(half_turn, &mut work);
            let mean = work.scores.iter().sum::<f64>() / work.scores.count() as f64;
            // The spreading window is good to the plan's tolerance; its own error turns with the knots.
            let share = (mean - expected / volume).abs() / (size / volume);
            assert!(share < 1e-5, "turn {turn}, {half_turn:?}: {share:e}");
            let first = *first.get_or_insert(mean);
            assert!((mean - first).abs() < 1e-5 * size / volume);
        }
    }
}

/// Volume under a slice by its definition. Every sum of radii occurs many times.
fn volume(kernel: &knotdock_scoring::kernel::RankingKernel, sigma: f64) -> f64 {
    use std::cell::RefCell;
    use std::collections::HashMap;
    thread_local!(static KNOWN: RefCell<HashMap<u64, f64>> = RefCell::default());
    KNOWN.with(|known| {
        *known
            .borrow_mut()
            .entry(sigma.to_bits())
            .or_insert_with(|| kernel.spectrum_of(&kernel.profile(sigma), 0.0))
    })
}

/// The ligand enters the lifted axis through its radii alone. With q distinct radii rank q is exact, and rank q - 1
/// is not. That holds even if the receptor has too many radii for classes, and the modes of the axis themselves are the
/// basis.
#[test]
fn as_many_components_as_distinct_radii_are_exact() {
    let many: Vec<f64> = (0..80).map(|i| 1.4 + f64::from(i) / 130.0).collect();
    let (a, b) = (cloud(80, 9.0, &many, 7), cloud(45, 6.0, &RADII, 8));
    let pair = Pair::new(Precision::Double, &a, &b, engine_options(1e-2));
    assert_eq!(*pair.plan.basis(), RadiusBasis::Modes);
    let spectra = ReceptorSpectra::new(&pair.plan, &a, &b, Quantity::Score, Precision::Double);
    let at = |rank: usize| {
        let engine = CpuEngine::new(pair.plan.clone(), &spectra, &b, rank);
        let mut work = engine.workspace();
        engine.correlate(&some_rotation(), &mut work);
        work.scores.to_vec()
    };
    let whole = at(spectra.full_rank());
    let off = |grid: &[f64]| {
        let errors = grid.iter().zip(&whole).map(|(a, b)| (a - b).abs());
        errors.fold(0.0, f64::max) / largest(&whole)
    };
    let (two, three) = (off(&at(2)), off(&at(3)));
    println!(
        "rank 2: {two:.1e}, rank 3: {three:.1e} of {}",
        spectra.full_rank()
    );
    assert!(three < 1e-9 && two > 1e2 * three);
}
