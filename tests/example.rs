//! The example pair end to end, as the README's first command docks it.

use std::path::{Path, PathBuf};

use assert_cmd::cargo::cargo_bin_cmd;
use knotdock::dock::scene::Scene;
use knotdock::options::DockOptions;
use knotdock::output::tables::poses::PoseTable;
use knotdock_scoring::engine::Plan;
use knotdock_scoring::exact::ExactScorer;
use knotdock_structures::molecule::{InputSpec, ReadOptions, read};
use serde_json::Value;

fn example(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .join(format!("structures/examples/1ppe_{name}.pdb"))
}

#[test]
fn a_near_native_pose_is_among_the_first_three() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("example");
    let output = cargo_bin_cmd!("knotdock")
        .arg("dock")
        .args([example("receptor_unbound"), example("ligand_unbound")])
        .arg("--native-receptor")
        .arg(example("receptor_bound"))
        .arg("--native-ligand")
        .arg(example("ligand_bound"))
        .arg("-o")
        .arg(&run)
        .arg("--json")
        .output()
        .unwrap();
    let reported: Value = serde_json::from_slice(&output.stdout).unwrap();
    let best = reported["best"].as_array().unwrap();
    assert_eq!(best.len(), 10);
    assert!(
        best.iter()
            .take(3)
            .any(|row| row["irmsd"].as_f64().unwrap() <= 2.5),
        "{best:?}"
    );

    // The printed poses score what is printed: to 1e-6 of the score, by the pair sum alone.
    let molecule = |name: &str| {
        let input = InputSpec::whole(example(name));
        read(&input, &ReadOptions::default()).unwrap()
    };
    let options = DockOptions::default();
    let (receptor, ligand) = (molecule("receptor_unbound"), molecule("ligand_unbound"));
    let Scene {
        receptor,
        ligand,
        terms,
        ..
    } = Scene::new(&receptor, &ligand, &options).unwrap();
    let engine = options.kernel.engine();
    let plan = Plan::with_effects(&receptor, &ligand, engine, engine.tolerance, terms).unwrap();
    let scorer =
        ExactScorer::with_effects(plan.kernel(), &receptor, &ligand, plan.effects()).unwrap();
    let path = run.join("poses.csv");
    let table = PoseTable::read(&path).unwrap();
    let mut scores = csv::Reader::from_path(&path).unwrap();
    let column = scores
        .headers()
        .unwrap()
        .iter()
        .position(|name| name == "search_score")
        .unwrap();
    let mut checked = 0;
    for (row, record) in table.rows().iter().zip(scores.records()).step_by(7) {
        let field = record.unwrap()[column].to_owned();
        // The best 200 rows are exact, and no other.
        assert_eq!(field.is_empty(), row.rank > 200);
        let Ok(printed) = field.parse::<f64>() else {
            continue;
        };
        let again = scorer.score(&row.pose).score;
        assert!(
            (again - printed).abs() <= 1e-6 * printed.abs().max(1.0),
            "rank {}: {again} is not {printed}",
            row.rank
        );
        checked += 1;
    }
    assert!(checked >= 28);
}
