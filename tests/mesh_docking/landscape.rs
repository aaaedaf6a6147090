//! The exact sum about the right pose: what the kernel makes of solids, before any search.

use super::parts::{Pair, Part};
use super::scenes::{broken, peg, solid, torus};
use knotdock::dock::pair::{GivenDefaults, sampled_defaults};
use knotdock::dock::scene::Scene;
use knotdock::mesh::samplers::lattice::RADIUS;
use knotdock::mesh::samplers::{RESOLUTION, Sampler, bi};
use knotdock::mesh::{MeshOptions, MeshPair, sample_pair};
use knotdock::options::{DockOptions, SampleGrid, SampleWeights};
use knotdock_scoring::engine::Plan;
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::kernel::RankingKernel;
use knotdock_scoring::kernel::smooth_step_down;
use knotdock_scoring::se3::Pose;
use knotdock_structures::numeric::Bump;
use nalgebra::{UnitQuaternion, Vector3};

fn sampled(pair: &Pair) -> MeshPair {
    let options = MeshOptions {
        per_axis: SampleGrid::default().per_axis,
        sampler: Sampler::default(),
        offset: None,
        weights: SampleWeights::Fitted,
        alpha: 2.0,
        lambda: 9.0,
        resolution: None,
        pass_length: None,
        memory: None,
    };
    {
        let solids = [solid(&pair.receptor), solid(&pair.ligand)];
        sample_pair(solids.each_ref().map(Into::into), &options).unwrap()
    }
}

fn scorer(meshes: &MeshPair) -> ExactScorer {
    let mut options = DockOptions::default();
    sampled_defaults(meshes, &mut options, GivenDefaults::default());
    let scene = Scene::of_meshes(meshes, &options).unwrap();
    let plan = Plan::new(&scene.receptor, &scene.ligand, options.kernel.engine()).unwrap();
    ExactScorer::new(plan.kernel(), &scene.receptor, &scene.ligand).unwrap()
}

/// A pose that turns the ligand about its middle by a rotation vector and moves it.
fn displaced(scorer: &ExactScorer, turn: Vector3<f64>, shift: Vector3<f64>) -> Pose {
    let center = scorer.ligand_center();
    Pose::about(UnitQuaternion::new(turn), center, center + shift)
}

fn mesh_volume(part: &Part) -> f64 {
    knotdock_structures::mesh::from_triangles(&part.positions, &part.triangles)
        .unwrap()
        .0
        .volume()
}

/// About the right pose the exact sum falls whichever way the ligand is moved by an offset, further on by one and a
/// half, or turned by 8 degrees.
#[test]
fn the_right_pose_is_the_top_of_the_landscape() {
    for (pair, clearance) in [peg(), torus(), broken()] {
        let meshes = sampled(&pair);
        let scorer = scorer(&meshes);
        let r0 = meshes.offset;
        let none = Vector3::zeros();
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let right = scorer.score_only(&displaced(&scorer, none, none));
        println!(
            "{}: clearance {clearance:.4}, r0 {r0:.4}, {} and {} balls, score {right:.0}",
            pair.name, meshes.parts[0].balls, meshes.parts[1].balls
        );
        assert!(right > 0.0);
        for axis in axes {
            for sign in [-1.0, 1.0] {
                let shifted = [1.0, 1.5].map(|share| {
                    scorer.score_only(&displaced(&scorer, none, sign * share * r0 * axis))
                });
                let angle = (sign * 8f64).to_radians();
                let turned = scorer.score_only(&displaced(&scorer, angle * axis, none));
                println!(
                    "  {axis:?} {sign}: shifted {shifted:.0?}, turned by 8 degrees {turned:.0}"
                );
                assert!(shifted[0] < right && shifted[1] < shifted[0], "{shifted:?}");
                assert!(turned < right, "{turned}");
            }
        }
    }
}

/// With fitted weights the summed bumps hold the volume of the solid, so that sums over pairs are integrals over
/// volumes.
#[test]
fn weights_are_volumes() {
    let (pair, _) = broken();
    let meshes = sampled(&pair);
    for (part, solid) in meshes.parts.iter().zip([&pair.receptor, &pair.ligand]) {
        let fit = part.weights.as_ref().unwrap();
        let volume = mesh_volume(solid);
        let integral: f64 = part
            .knots
            .radii
            .iter()
            .zip(&part.knots.weights)
            .map(|(radius, weight)| weight * radius.powi(3) * Bump::new(2.0).unwrap().volume())
            .sum();
        assert!(
            (integral / volume - 1.0).abs() < 0.08,
            "{integral} {volume}"
        );
        assert!((fit.volume_fitted - integral / volume).abs() < 1e-6);
        // Weights of one count it several times.
        assert!(fit.volume_unit > 1.5, "{fit:?}");
    }
}

/// Basis of the lengths of [`knotdock::mesh`]: two flat faces score most at a gap of one offset, above half of that
/// from 0.65 to 1.55 offsets, and below zero under 0.3.
#[test]
fn flat_faces_are_drawn_to_a_gap_of_one_offset() {
    let r0 = 0.037;
    let options = DockOptions::default().changed(|options| {
        options.kernel.offset = r0;
        options.kernel.resolution = RESOLUTION * r0;
    });
    let sum = 2.0 * RADIUS * r0;
    let kernel = RankingKernel::new(options.kernel.engine().kernel, sum, sum, 1.15).unwrap();
    let table = kernel.distance_table(sum);
    let steps = 4000;
    let step = kernel.reach() / f64::from(steps);
    let score = |gap: f64| -> f64 {
        (0..steps)
            .map(|i| (f64::from(i) + 0.5) * step)
            .filter(|&d| d > gap)
            .map(|d| std::f64::consts::PI * table.value(d)[3] * d * (d - gap).powi(2) * step)
            .sum()
    };
    let scores: Vec<f64> = (0..=60).map(|i| score(0.05 * f64::from(i) * r0)).collect();
    check_gaps(&scores, [13, 31, 6]);
}

/// The same of the product kernel: below zero under half an offset.
#[test]
fn double_skins_are_drawn_to_a_gap_of_one_offset() {
    check_gaps(&double_skin_scores(), [14, 29, 9]);
}

/// Scores of two flat faces per area, in offsets, at gaps from 0 in twentieths of an offset: the correlation of the
/// profiles of their double skins through the low-pass.
pub fn double_skin_scores() -> Vec<f64> {
    let (lambda, depth) = (9.0, 4.0);
    // A body's profile in offsets: 1 - lambda up to CORE beyond its face, then 1 as deep as the skin.
    let profile = |x: f64| match x {
        _ if x < -depth || x >= bi::CORE + bi::SKIN => 0.0,
        _ if x < bi::CORE => 1.0 - lambda,
        _ => 1.0,
    };
    let step = 0.01;
    let cells = |low: f64, high: f64| {
        let count = ((high - low) / step).round() as i32;
        (0..count).map(move |i| low + (f64::from(i) + 0.5) * step)
    };
    let sharp = |gap: f64| -> f64 {
        let places = cells(-depth, depth);
        -places
            .map(|x| profile(x) * profile(gap - x) * step)
            .sum::<f64>()
    };
    // All gaps at which the two overlap or touch: the low-pass reaches far.
    let (low, high) = (-2.0 * depth, 2.0);
    let sharp: Vec<(f64, f64)> = cells(low, high).map(|gap| (gap, sharp(gap))).collect();
    // The low-pass across a face is that along one axis.
    let filter = |x: f64| -> f64 {
        let (stop, count) = (1.0 / RESOLUTION, 200);
        let wave = |i: i32| {
            let w = stop * (f64::from(i) + 0.5) / f64::from(count);
            smooth_step_down(w, 0.5 * stop, stop) * (2.0 * std::f64::consts::PI * w * x).cos()
        };
        2.0 * stop / f64::from(count) * (0..count).map(wave).sum::<f64>()
    };
    let gaps = (0..=60).map(|i| 0.05 * f64::from(i));
    let score = |gap: f64| {
        let parts = sharp.iter();
        parts
            .map(|(at, value)| value * filter(gap - at) * step)
            .sum()
    };
    gaps.map(score).collect()
}

/// Checks that scores at gaps from 0 in twentieths of an offset are best at one offset, above half of that from `from`
/// to `to`, and below zero up to `below`.
fn check_gaps(scores: &[f64], [from, to, below]: [usize; 3]) {
    let best = (0..scores.len())
        .max_by(|&a, &b| scores[a].total_cmp(&scores[b]))
        .unwrap();
    assert!(
        (18..=22).contains(&best),
        "best at {} r0",
        0.05 * best as f64
    );
    for (i, &value) in scores.iter().enumerate() {
        if (from..=to).contains(&i) {
            assert!(value > 0.5 * scores[best], "{i}: {value}");
        }
        if i <= below {
            assert!(value < 0.0, "{i}: {value}");
        }
    }
}
