//! Tests of the exact score against plain loops, central differences and closed forms.

use super::*;
use crate::kernel::KernelOptions;
use crate::test_support::{AffinityKnots, Numbers};
use num_complex::Complex64;

fn kernel() -> RankingKernel {
    RankingKernel::new(KernelOptions::TEST, 3.0, 3.8, 1.0).unwrap()
}

fn cloud(count: usize, spread: f64, seed: u64) -> Knots {
    let mut numbers = Numbers(seed);
    let mut next = || numbers.next();
    let radii = [1.5, 1.65, 1.9];
    Knots::new(
        (0..count)
            .map(|_| std::array::from_fn(|_| spread * next()))
            .collect(),
        (0..count).map(|i| radii[i % 3]).collect(),
    )
    .unwrap()
}

fn some_pose() -> Pose {
    Pose::from_parts([0.3, -0.2, 0.8, 0.4], [4.0, -2.0, 7.0])
}

/// The cell list must change nothing against the plain double sum over the kernel's definition, and the one-array form
/// with complex weights must give the same score as the three slices.
#[test]
fn equals_the_plain_double_sum_and_the_complex_one_array_form() {
    let (kernel, a, b, pose) = (
        kernel(),
        cloud(60, 15.0, 1),
        cloud(40, 10.0, 2),
        some_pose(),
    );
    let scorer = ExactScorer::new(&kernel, &a, &b).unwrap();
    let ours = scorer.score(&pose);
    let (fa, fb) = (
        AffinityKnots::of(&a, 10.0, 2.0),
        AffinityKnots::of(&b, 10.0, 2.0),
    );
    let mut whole = Complex64::new(0.0, 0.0);
    let mut plain = Complex64::new(0.0, 0.0);
    for i in 0..fa.radii.len() {
        for j in 0..fb.radii.len() {
            let x = pose.apply(fb.centers[j]);
            let d = (0..3)
                .map(|k| (x[k] - fa.centers[i][k]).powi(2))
                .sum::<f64>()
                .sqrt();
            let sigma = fa.radii[i] + fb.radii[j];
            let weight = fa.weights[i] * fb.weights[j];
            whole += weight
                * if d < kernel.reach() {
                    kernel.value(d, sigma)
                } else {
                    0.0
                };
            plain += weight * kernel.cone().value(d, sigma);
        }
    }
    let scale = ours.score.abs().max(100.0);
    assert!(
        (whole.re - ours.score).abs() < 1e-7 * scale,
        "{whole} {ours:?}"
    );
    assert!(whole.im.abs() < 1e-7 * scale);
    assert!((plain.re - ours.unfiltered).abs() < 1e-9 * scale);
    assert!((scorer.gradient(&pose).0 - ours.score).abs() < 1e-9 * scale);
}

#[test]
fn gradient_matches_central_differences() {
    let (kernel, a, b, pose) = (
        kernel(),
        cloud(60, 15.0, 3),
        cloud(40, 10.0, 4),
        some_pose(),
    );
    let scorer = ExactScorer::new(&kernel, &a, &b).unwrap();
    let (_, gradient) = scorer.gradient(&pose);
    let h = 1e-5;
    for axis in 0..3 {
        let mut step = Vector3::zeros();
        step[axis] = h;
        let moved = |sign: f64| {
            let pose = Pose {
                translation: pose.translation + step * sign,
                ..pose
            };
            scorer.score(&pose).score
        };
        let slope = (moved(1.0) - moved(-1.0)) / (2.0 * h);
        assert!((slope - gradient.force[axis]).abs() < 1e-5 * gradient.force.norm());
        let turned = |sign: f64| {
            let turn = nalgebra::UnitQuaternion::new(step * sign);
            let arm = pose.rotation * scorer.ligand_center();
            let pose = Pose {
                rotation: turn * pose.rotation,
                translation: pose.translation + arm - turn * arm,
            };
            scorer.score(&pose).score
        };
        let slope = (turned(1.0) - turned(-1.0)) / (2.0 * h);
        assert!((slope - gradient.torque[axis]).abs() < 1e-5 * gradient.torque.norm());
    }
}

/// The sign of the score: a touching pair of balls beats an overlapping and a distant one (B&I's text after eq. 53).
#[test]
fn touching_beats_overlapping_and_distant() {
    let kernel = kernel();
    let ball = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
    let scorer = ExactScorer::new(&kernel, &ball, &ball).unwrap();
    let at = |x: f64| {
        scorer.score(&Pose {
            translation: Vector3::new(x, 0.0, 0.0),
            ..Pose::identity()
        })
    };
    let (overlapping, touching, distant) = (at(0.5), at(4.0), at(30.0));
    assert!(touching.score > 1.0 && touching.unfiltered > 1.0);
    assert!(overlapping.score < -10.0 && overlapping.unfiltered < -10.0);
    assert_eq!(distant.score, 0.0);
    // Closed form, no low-pass: centres coincide, all three slices are psi(0) = 1, G = -(lambda - 1)^2.
    assert_eq!(at(0.0).unfiltered, -81.0);
    // At d = sigma / sqrt 2 slice 0 is exp(-1).
    let d = 3.4 / 2f64.sqrt();
    let cone = kernel.cone();
    assert!((cone.value(d, 3.4) - (-1f64).exp()).abs() < 1e-14);
}

/// Hard case: file coordinates at 1e6 Å. Moving or turning an input must leave the score at the carried pose.
#[test]
fn carried_poses_keep_their_score() {
    let (kernel, a, b, pose) = (
        kernel(),
        cloud(60, 15.0, 5),
        cloud(40, 10.0, 6),
        some_pose(),
    );
    let first = ExactScorer::new(&kernel, &a, &b)
        .unwrap()
        .score(&pose)
        .score;
    for offset in [10.0, 1e4, 1e6] {
        let motion = Pose::from_parts([0.5, 0.1, -0.7, 0.3], [offset, -0.3 * offset, 0.7 * offset]);
        let moved = |knots: &Knots| {
            let mut knots = knots.clone();
            for x in &mut knots.centers {
                *x = motion.apply(*x);
            }
            knots
        };
        let carried = pose.after(&motion.inverse());
        let second = ExactScorer::new(&kernel, &a, &moved(&b))
            .unwrap()
            .score(&carried)
            .score;
        let third = ExactScorer::new(&kernel, &moved(&a), &b)
            .unwrap()
            .score(&motion.after(&pose))
            .score;
        // 1e6 Å at double precision leaves 1e-10 Å in a coordinate, times a slope of the score.
        let bound = first.abs().max(100.0) * f64::max(1e-9, 1e-14 * offset);
        assert!((second - first).abs() < bound, "{first} {second}");
        assert!((third - first).abs() < bound, "{first} {third}");
    }
}

/// Knots at given places with radii in turn.
fn knots(centers: Vec<[f64; 3]>, radii: &[f64]) -> Knots {
    let radii = (0..centers.len()).map(|i| radii[i % radii.len()]).collect();
    Knots::new(centers, radii).unwrap()
}

fn poses(count: usize, spread: f64) -> Vec<Pose> {
    let points = cloud(2 * count, 1.0, 99).centers;
    points
        .chunks(2)
        .map(|pair| {
            let [a, b, c] = pair[0].map(|x| x - 0.5);
            Pose::from_parts([0.1, a, b, c], pair[1].map(|x| spread * (2.0 * x - 1.0)))
        })
        .collect()
}

/// Pairs of clouds by name, with how far apart their poses are, Å.
fn hard_cases() -> [(&'static str, Knots, Knots, f64); 5] {
    let mut far = cloud(50, 12.0, 11);
    let shifted: Vec<[f64; 3]> = far.centers.iter().map(|x| x.map(|x| x + 1e6)).collect();
    far.centers.extend(shifted);
    let far = knots(far.centers, &[1.5, 1.9]);
    let protein = [1.5, 1.65, 1.9];
    [
        ("clouds", cloud(400, 25.0, 8), cloud(90, 14.0, 9), 20.0),
        (
            "coincident",
            knots(vec![[1.0; 3]; 40], &protein),
            knots(vec![[2.0; 3]; 9], &protein),
            3.0,
        ),
        ("distant", far, cloud(40, 10.0, 12), 15.0),
        ("crowded", cloud(5000, 9.0, 13), cloud(10, 9.0, 14), 10.0),
        (
            "ratio 1e6",
            knots(cloud(40, 150.0, 15).centers, &[1e-4, 1.0, 100.0]),
            knots(cloud(30, 80.0, 16).centers, &[1e-4, 100.0]),
            150.0,
        ),
    ]
}

/// Scores by a double loop over the kernel's distance tables.
fn plain_scores(
    kernel: &RankingKernel,
    receptor: &Knots,
    ligand: &Knots,
    poses: &[Pose],
) -> Vec<f64> {
    let (receptor_radii, receptor_class) = receptor.radius_classes();
    let (ligand_radii, ligand_class) = ligand.radius_classes();
    let tables: Vec<Vec<_>> = ligand_radii
        .iter()
        .map(|s| {
            receptor_radii
                .iter()
                .map(|r| kernel.distance_table(r + s))
                .collect()
        })
        .collect();
    let plain = |pose: &Pose| {
        let mut sum = 0.0;
        for (y, &s) in ligand.centers.iter().zip(&ligand_class) {
            let y = Vector3::from(pose.apply(*y));
            for (x, &r) in receptor.centers.iter().zip(&receptor_class) {
                sum += tables[s][r].value((y - Vector3::from(*x)).norm())[3];
            }
        }
        sum
    };
    poses.iter().map(plain).collect()
}

/// Score alone, score from slices, and a double loop over the kernel's own distance tables, which have other panels,
/// must agree to 1e-9 of the best score, and so must the gradient's. Hard cases: coincident knots, whose distance is 0;
/// knots at distances of 1e6 Å; more knots within reach than are collected at a time. Also radii of a ratio of 1e6,
/// whose tables reach far beyond the panels of small pairs.
#[test]
fn score_alone_slices_and_plain_loop_agree() {
    for (name, receptor, ligand, spread) in hard_cases() {
        let ends = |knots: &Knots| {
            let low = knots.radii.iter().copied().fold(f64::INFINITY, f64::min);
            (low, knots.radii.iter().copied().fold(0.0, f64::max))
        };
        let ((r_low, r_high), (s_low, s_high)) = (ends(&receptor), ends(&ligand));
        let kernel =
            RankingKernel::new(*kernel().options(), r_low + s_low, r_high + s_high, 1.0).unwrap();
        let scorer = ExactScorer::new(&kernel, &receptor, &ligand).unwrap();
        let poses = poses(12, spread);
        let expected: Vec<f64> = plain_scores(&kernel, &receptor, &ligand, &poses);
        // The best score stands for the scale; crowds that only overlap have none worth the name, there it is what a
        // pair can lose.
        let best = expected
            .iter()
            .fold(100.0f64, |best, &score| best.max(score));
        let pairs = receptor.len() as f64 * ligand.len() as f64;
        // Table errors add up over pairs at random: a crowd of pairs beyond a protein pair's has its own allowance.
        let bound = 1e-9 * best * (pairs / 1e4).sqrt().max(1.0);
        for (pose, expected) in poses.iter().zip(expected) {
            let (only, full) = (scorer.score_only(pose), scorer.score(pose));
            let rounding = 1e-12 * full.slices[0].abs().max(full.slices[1].abs()) * 100.0;
            let (gradient, _) = scorer.gradient(pose);
            println!(
                "{name}: {expected} {:e} {:e}",
                only - expected,
                full.score - only
            );
            assert!(
                (only - expected).abs() < bound,
                "{name}: {only} is not {expected}"
            );
            assert!(
                (full.score - only).abs() < rounding.max(1e-9),
                "{name}: {full:?} {only}"
            );
            assert!(
                (gradient - only).abs() < rounding.max(1e-9),
                "{name}: {gradient} {only}"
            );
        }
    }
}

/// A knot weight of zero removes a knot, a weight of two is two knots: the padding of blocks relies on it.
#[test]
fn weights_count() {
    let (kernel, ligand, pose) = (kernel(), cloud(20, 8.0, 21), some_pose());
    let a = cloud(33, 12.0, 22);
    let mut weighted = a.clone();
    let mut doubled = a.clone();
    for i in 0..a.len() {
        weighted.weights[i] = (i % 3) as f64;
    }
    let keep = |i: &usize| !i.is_multiple_of(3);
    let twice = (0..a.len()).filter(keep).flat_map(|i| vec![i; i % 3]);
    let members: Vec<usize> = twice.collect();
    doubled.centers = members.iter().map(|&i| a.centers[i]).collect();
    doubled.radii = members.iter().map(|&i| a.radii[i]).collect();
    doubled.weights = vec![1.0; members.len()];
    // The middles of the two sets differ, which is rounding only.
    let one = ExactScorer::new(&kernel, &weighted, &ligand).unwrap();
    let two = ExactScorer::new(&kernel, &doubled, &ligand).unwrap();
    let (one, two) = (one.score(&pose), two.score(&pose));
    assert!((one.score - two.score).abs() < 1e-9 * one.score.abs().max(100.0));
    assert!((one.unfiltered - two.unfiltered).abs() < 1e-9 * one.unfiltered.abs().max(100.0));
}
