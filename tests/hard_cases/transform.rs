//! Hard cases of the transforms: tiny and huge frequencies, bumps from a point to a sharp ball, sharply cut lens
//! volumes, nothing to transform.
//!
//! Numbers of another program are printed by scripts/reference/hard_case_reference.py (mpmath, 34 digits).

// The reference numbers stand as mpmath prints them.
#![allow(clippy::excessive_precision, clippy::approx_constant)]

use crate::scene::{Pair, RADII, cloud, engine_options, some_rotation};
use knotdock_scoring::Precision;
use knotdock_scoring::engine::{CpuEngine, EngineOptions, Plan, ReceptorSpectra};
use knotdock_scoring::kernel::product::lens_volume;
use knotdock_scoring::kernel::radial_transform::RadialTransform;
use knotdock_scoring::kernel::{Band, Bump, KernelOptions};
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Knots;
use std::f64::consts::PI;
use std::sync::Arc;

/// Rows of q, transform of the unit ball's indicator.
const BALL: [(f64, f64); 9] = [
    (8.6736173798840355e-19, 4.188790204786391),
    (9.5367431640625e-7, 4.188790204771351),
    (0.0009765625, 4.1887744341997473),
    (0.001953125, 4.1887271226942823),
    (0.125, 3.9360323255105033),
    (1.0, -0.31830988618379067),
    (37.25, 9.8014748007143057e-7),
    (1024.5, 3.0326773091354606e-7),
    (1048576.0, -2.8950115500610143e-13),
];

/// Rows of alpha, q, psi^(q).
const TRANSFORM: [(f64, f64, f64); 20] = [
    (0.125, 8.6736173798840355e-19, 0.0015310139974556421),
    (0.125, 0.25, 0.0015065214968357525),
    (0.125, 2.5, 0.00039444690498371983),
    (0.125, 20.0, 1.039224608138461e-6),
    (0.125, 200.0, 7.7832827904007224e-10),
    (1.0, 8.6736173798840355e-19, 0.51832988447318857),
    (1.0, 0.25, 0.46754333223912541),
    (1.0, 2.5, 0.00081845798378895734),
    (1.0, 20.0, 1.0228803912715852e-7),
    (1.0, 200.0, 1.0078591745442713e-11),
    (64.0, 8.6736173798840355e-19, 3.9682307858492243),
    (64.0, 0.25, 3.0999015585472386),
    (64.0, 2.5, 0.047882316053744436),
    (64.0, 20.0, 8.2230569372920836e-7),
    (64.0, 200.0, -8.7451149211165154e-8),
    (1024.0, 8.6736173798840355e-19, 4.1744285753000888),
    (1024.0, 0.25, 3.2331264931674692),
    (1024.0, 2.5, 0.05091622425803048),
    (1024.0, 20.0, -0.0007825955527141736),
    (1024.0, 200.0, -2.1724228726191892e-6),
];

/// Below z = 1e-5, sin z - z cos z keeps no digit, and a series replaces it. At q = 1e6 the sine's argument itself is
/// good to 1e-9 only.
#[test]
fn the_balls_transform_at_tiny_and_huge_frequencies() {
    let transform = RadialTransform::new(Bump::new(f64::INFINITY).unwrap(), 1.0);
    for (q, exact) in BALL {
        let ours = transform.value(q);
        // At most 1 / q^2 in size; its argument 2 pi q carries its own rounding error.
        let size = exact.abs().max((PI * q * q).recip().min(1.0));
        let bound = 1e-11 + 8.0 * f64::EPSILON * 2.0 * PI * q;
        assert!(
            (ours - exact).abs() <= bound * size,
            "q {q:e}: {ours:e} against {exact:e}"
        );
    }
    assert_eq!(transform.value(0.0), 4.0 * PI / 3.0);
    for q in [5e-324, 1e-300, 1e8, 1e100] {
        assert!(transform.value(q).is_finite());
    }
}

/// Bumps from a point to a ball. At alpha = 1/8 the bump is nearly a point, and its whole transform comes from a cusp
/// in the centre. At alpha = 1,024 it is nearly a sharp ball, with an edge of a thousandth. Quadrature must resolve
/// both, up to q = 200.
#[test]
fn bumps_from_a_point_to_a_sharp_ball() {
    for (alpha, q, exact) in TRANSFORM {
        let ours = RadialTransform::new(Bump::new(alpha).unwrap(), 200.0).value(q);
        assert!(
            (ours - exact).abs() < 1e-13,
            "alpha {alpha}, q {q:e}: {ours:e} against {exact:e}"
        );
    }
}

/// Spheres as exact references. The lifted engine cuts the product kernel of two sharp balls at half the inverse
/// spacing. So it loses what the lens volume's spectrum, w^-4, holds beyond, and the error falls like the spacing. No
/// Gibbs ringing stays behind, since the lens volume is continuous.
#[test]
fn two_sharp_balls_cut_in_frequency_tend_to_their_lens() {
    let ball = |radius: f64| Knots::new(vec![[0.0; 3]], vec![radius]).unwrap();
    let (one, other) = (ball(1.9), ball(1.5));
    let mut last = f64::INFINITY;
    for spacing in [0.5, 0.25, 0.125] {
        let options = EngineOptions {
            spacing: Some(spacing),
            kernel: KernelOptions {
                alpha: f64::INFINITY,
                ..engine_options(1e-4).kernel
            },
            ..engine_options(1e-4)
        };
        let plan = Arc::new(Plan::product(&one, &other, options, Band::Whole).unwrap());
        let spectra =
            ReceptorSpectra::new(&plan, &one, &other, Quantity::Slice(0), Precision::Double);
        let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &other, 1);
        let mut work = engine.workspace();
        engine.correlate(&Pose::identity().rotation, &mut work);
        let mut worst = 0.0f64;
        for (voxel, value) in work.scores.iter().enumerate() {
            let exact = lens_volume(1.9, 1.5, engine.position(voxel).norm());
            worst = worst.max((value - exact).abs());
        }
        let share = worst / lens_volume(1.9, 1.5, 0.0);
        println!("spacing {spacing}: {share:.2e}");
        assert!(share < 0.1 * spacing && share < 0.7 * last, "{share}");
        last = share;
    }
}

/// Weights that are all zero, and a body whose weights cancel on one place: the grid is zero, not NaN, though the
/// lifted axis has nothing to factor there.
#[test]
fn nothing_to_transform_scores_nothing() {
    let (a, b) = (cloud(40, 8.0, &RADII, 1), cloud(20, 5.0, &RADII, 2));
    let weighted = |knots: &Knots, weight: &dyn Fn(usize) -> f64| Knots {
        weights: (0..knots.len()).map(weight).collect(),
        ..knots.clone()
    };
    let nothing = weighted(&b, &|_| 0.0);
    let mut cancelling = b.clone();
    cancelling.centers = vec![[1.0, 2.0, 3.0]; b.len()];
    cancelling.radii = vec![1.7; b.len()];
    let cancelling = weighted(&cancelling, &|i| if i % 2 == 0 { 1.0 } else { -1.0 });
    for ligand in [nothing, cancelling] {
        for (receptor, ligand) in [(&a, &ligand), (&ligand, &a)] {
            let pair = Pair::new(Precision::Single, receptor, ligand, engine_options(1e-2));
            let work = pair.correlate(&some_rotation());
            assert!(work.scores.iter().all(|value| value.abs() < 1e-4));
            assert_eq!(pair.scorer.score_only(&Pose::identity()).abs(), 0.0);
        }
    }
}
