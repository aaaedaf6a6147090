//! Identities of the exact score that hold whatever the knots are.

use crate::scene;
use knotdock_scoring::exact::{ExactScore, ExactScorer};
use knotdock_scoring::kernel::KernelOptions;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Knots;
use proptest::prelude::*;

fn options(lambda: f64, offset: f64) -> KernelOptions {
    KernelOptions {
        lambda,
        offset,
        ..scene::kernel_options()
    }
}

fn score(options: KernelOptions, a: &Knots, b: &Knots, pose: &Pose) -> ExactScore {
    let kernel = scene::kernel_for(options, a, b);
    ExactScorer::new(&kernel, a, b).unwrap().score(pose)
}

fn knots() -> impl Strategy<Value = Knots> {
    let knot = (prop::array::uniform3(-6.0..6.0f64), 0usize..3);
    prop::collection::vec(knot, 1..12).prop_map(|list| {
        let radii = [1.4, 1.65, 1.9];
        Knots::new(
            list.iter().map(|knot| knot.0).collect(),
            list.iter().map(|knot| radii[knot.1]).collect(),
        )
        .unwrap()
    })
}

fn pose() -> impl Strategy<Value = Pose> {
    let parts = (
        prop::array::uniform4(0.05..1.0f64),
        prop::array::uniform3(-12.0..12.0f64),
    );
    parts.prop_map(|(q, t)| Pose::from_parts(q, t))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// The score is the sum of its slices, finite, and the same when the bodies change places under the inverse pose.
    #[test]
    fn finite_summed_and_symmetric(a in knots(), b in knots(), pose in pose()) {
        let ours = score(options(10.0, 2.0), &a, &b, &pose);
        let [g0, g1, g2] = ours.slices;
        prop_assert_eq!(ours.score, -100.0 * g0 + 20.0 * g1 - g2);
        prop_assert!(ours.score.is_finite() && ours.unfiltered.is_finite());
        let exchanged = score(options(10.0, 2.0), &b, &a, &pose.inverse());
        let scale = 1e2 * (a.len() * b.len()) as f64;
        prop_assert!((ours.score - exchanged.score).abs() < 1e-9 * scale);
        prop_assert!((ours.unfiltered - exchanged.unfiltered).abs() < 1e-9 * scale);
    }

    /// Hard case r0 = 0: the three slices fall together and G = -(lambda - 1)^2 g(0).
    #[test]
    fn without_a_skin_only_overlap_is_left(a in knots(), b in knots(), pose in pose(), lambda in 0.0..1e3f64) {
        let ours = score(options(lambda, 0.0), &a, &b, &pose);
        let expected = -(lambda - 1.0).powi(2) * ours.slices[0];
        let scale = (1.0 + lambda * lambda) * (a.len() * b.len()) as f64;
        prop_assert!((ours.score - expected).abs() < 1e-12 * scale);
    }

    /// B&I's Lemma 2: two solids meet where the lifted solid of one meets the r-mirrored lifted solid of the other, and
    /// the correlation without a skin is not zero exactly there. Unmirrored, the lifted solids always meet, farther
    /// down.
    #[test]
    fn solids_meet_where_their_mirrored_cones_do(a in knots(), b in knots(), pose in pose()) {
        let placed: Vec<[f64; 3]> = b.centers.iter().map(|&y| pose.apply(y)).collect();
        // Whether slices at height h meet: balls of radius r - h, and s + h or, unmirrored, s - h.
        let meet = |h: f64, mirror: f64| {
            (0..a.len()).any(|i| (0..b.len()).any(|j| {
                let d = (0..3).map(|k| (a.centers[i][k] - placed[j][k]).powi(2)).sum::<f64>().sqrt();
                let (r, s) = (a.radii[i] - h, b.radii[j] - mirror * h);
                r > 0.0 && s > 0.0 && d < r + s
            }))
        };
        let gap = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| (i, j))).map(|(i, j)| {
            let d = (0..3).map(|k| (a.centers[i][k] - placed[j][k]).powi(2)).sum::<f64>().sqrt();
            d - a.radii[i] - b.radii[j]
        }).fold(f64::INFINITY, f64::min);
        // Nearer to contact than this, heights round differently and the bump underflows.
        prop_assume!(gap.abs() > 0.01);
        let heights = (-60..=60).map(|step| 0.05 * f64::from(step));
        let lifted = heights.clone().any(|h| meet(h, -1.0));
        prop_assert_eq!(meet(0.0, -1.0), gap < 0.0);
        prop_assert_eq!(lifted, gap < 0.0);
        prop_assert!(meet(-100.0, 1.0));
        let overlap = score(options(10.0, 0.0), &a, &b, &pose).unfiltered;
        prop_assert_eq!(overlap != 0.0, gap < 0.0, "{} {}", overlap, gap);
    }

    /// A knot split into two halves on the same place changes nothing (duplicate and coincident knots).
    #[test]
    fn split_knots_change_nothing(a in knots(), b in knots(), pose in pose()) {
        let whole = score(options(10.0, 2.0), &a, &b, &pose);
        let mut split = a.clone();
        split.weights[0] *= 0.5;
        split.centers.push(a.centers[0]);
        split.radii.push(a.radii[0]);
        split.weights.push(split.weights[0]);
        let halves = score(options(10.0, 2.0), &split, &b, &pose);
        let scale = 1e2 * (a.len() * b.len()) as f64;
        prop_assert!((whole.score - halves.score).abs() < 1e-11 * scale);
    }

    /// Doubling every length keeps every bit of the score: no constant in Å hides in the code.
    #[test]
    fn doubling_every_length_keeps_the_bits(a in knots(), b in knots(), pose in pose()) {
        let doubled = |knots: &Knots| Knots::new(
            knots.centers.iter().map(|x| x.map(|v| 2.0 * v)).collect(),
            knots.radii.iter().map(|r| 2.0 * r).collect(),
        ).unwrap();
        let twice = KernelOptions { resolution: 8.0, pass_length: 16.0, ..options(10.0, 4.0) };
        let moved = Pose { translation: 2.0 * pose.translation, ..pose };
        let small = score(options(10.0, 2.0), &a, &b, &pose);
        let large = score(twice, &doubled(&a), &doubled(&b), &moved);
        prop_assert_eq!(small.score.to_bits(), large.score.to_bits());
        prop_assert_eq!(small.unfiltered.to_bits(), large.unfiltered.to_bits());
    }
}
