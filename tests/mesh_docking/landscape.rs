//! The exact sum about the right pose: what the kernel makes of solids, before any search.

use super::parts::Pair;
use super::scenes::{broken, peg, solid, torus};
use knotdock::search::meshes::{
    GivenLengths, MeshOptions, MeshPair, PER_AXIS, SampleWeights, sample_pair,
};
use knotdock::search::{DockOptions, Scene};
use knotdock_scoring::engine::Plan;
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::se3::Pose;
use nalgebra::{UnitQuaternion, Vector3};

fn sampled(pair: &Pair, weights: SampleWeights) -> MeshPair {
    let options = MeshOptions {
        per_axis: PER_AXIS,
        offset: None,
        weights,
        alpha: 2.0,
    };
    sample_pair(&solid(&pair.receptor), &solid(&pair.ligand), &options).unwrap()
}

fn scorer(meshes: &MeshPair) -> ExactScorer {
    let mut options = DockOptions::default();
    meshes.defaults(&mut options, GivenLengths::default());
    let scene = Scene::of_meshes(meshes, &options).unwrap();
    let plan = Plan::new(&scene.receptor, &scene.ligand, options.engine()).unwrap();
    ExactScorer::new(&plan.kernel, &scene.receptor, &scene.ligand).unwrap()
}

/// A pose that turns the ligand about its middle and moves it.
fn displaced(scorer: &ExactScorer, axis: Vector3<f64>, angle: f64, shift: Vector3<f64>) -> Pose {
    let center = scorer.ligand_center();
    let turn = UnitQuaternion::new(axis.normalize() * angle);
    Pose::about(turn, center, center + shift)
}

#[test]
fn explore() {
    for (pair, clearance) in [peg(), torus(), broken()] {
        for weights in [SampleWeights::Fitted, SampleWeights::Unit] {
            let meshes = sampled(&pair, weights);
            let scorer = scorer(&meshes);
            let r0 = meshes.offset;
            println!(
                "{} {weights:?} r0 {r0:.4} c {:.4} knots {} {} features {:.4} {:.4} eps {:.4} {:.4} rms {:?} vol {:?}",
                pair.name,
                clearance,
                meshes.parts[0].balls,
                meshes.parts[1].balls,
                meshes.parts[0].feature_size,
                meshes.parts[1].feature_size,
                meshes.parts[0].epsilon,
                meshes.parts[1].epsilon,
                meshes.parts.each_ref().map(|p| p.weights.as_ref().map(|w| w.rms_fitted)),
                meshes.parts.each_ref().map(|p| p.weights.as_ref().map(|w| w.volume_fitted)),
            );
            let x = Vector3::x();
            let start = std::time::Instant::now();
            for axis in 0..3 {
                let mut direction = Vector3::zeros();
                direction[axis] = 1.0;
                let line = |values: Vec<f64>| {
                    values.iter().map(|v| format!("{v:8.0}")).collect::<Vec<_>>().join("")
                };
                let shifts = (-6..=6)
                    .map(|i| f64::from(i) * 0.25 * r0)
                    .map(|s| scorer.score_only(&displaced(&scorer, x, 0.0, direction * s)));
                println!("  shift {axis} by r0/4: {}", line(shifts.collect()));
                let turns = (-6..=6)
                    .map(|i| (f64::from(i) * 2.5).to_radians())
                    .map(|a| scorer.score_only(&displaced(&scorer, direction, a, Vector3::zeros())));
                println!("  turn  {axis} by 2.5 : {}", line(turns.collect()));
            }
            println!("  {:.2} ms a score", start.elapsed().as_secs_f64() * 1e3 / 78.0);
        }
    }
}
