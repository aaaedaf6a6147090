//! Effects on demand: effects that auto turns on, output that an effect that is off leaves untouched, and effects that
//! cannot be forced.

mod flexible_regions;
mod known_residues;
mod rescoring;

use crate::molecules;
use std::fs;
use std::path::Path;

use crate::program::succeed;
use assert_cmd::cargo::cargo_bin_cmd;
use knotdock::dock::scene::Scene;
use knotdock::options::DockOptions;
use knotdock_scoring::engine::Plan;
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::{POSE_TERMS, Workspace};
use knotdock_structures::molecule::{InputSpec, ReadOptions, read};
use serde_json::Value;

fn example(name: &str) -> String {
    format!(
        "{}/structures/examples/1ppe_{name}.pdb",
        concat!(env!("CARGO_MANIFEST_DIR"), "/..")
    )
}

/// Runs the program in a folder; it must succeed. Returns standard output and standard error.
fn run(folder: &Path, arguments: &[&str]) -> (String, String) {
    let output = succeed(folder, arguments.iter().copied());
    [output.stdout, output.stderr]
        .map(|bytes| String::from_utf8(bytes).unwrap())
        .into()
}

/// Docks and returns the JSON object with the bytes of the table.
fn dock(folder: &Path, receptor: &str, ligand: &str, options: &[&str]) -> (Value, String) {
    let mut arguments = vec!["dock", receptor, ligand];
    arguments.extend("--write-top 0 -o run --force --json".split(' '));
    arguments.extend(options);
    let (object, _) = run(folder, &arguments);
    let table = fs::read_to_string(folder.join("run/poses.csv")).unwrap();
    (serde_json::from_str(&object).unwrap(), table)
}

/// An effect that is off changes not one bit, whatever its weight; one that is on does.
#[test]
fn an_effect_that_is_off_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let table = |options: &[&str]| {
        let mut all = vec!["--rotations", "24", "--poses", "40", "--refine", "5"];
        all.extend(options);
        dock(folder.path(), &receptor, &ligand, &all).1
    };
    let weights = [
        "--config",
        "terms.electrostatics_weight=77",
        "--config",
        "terms.contact_weight=3",
        "--ph",
        "2",
    ];
    let shape = table(&["--effects", "shape"]);
    let mut others = vec!["--effects", "shape"];
    others.extend(weights);
    assert_eq!(shape, table(&others));
    assert_ne!(shape, table(&["--effects", "shape,electrostatics"]));
    assert_ne!(shape, table(&["--effects", "shape,contact"]));
    // Columns of effects that are off are empty.
    let mut reader = csv::Reader::from_reader(shape.as_bytes());
    for row in reader.deserialize::<std::collections::BTreeMap<String, String>>() {
        let row = row.unwrap();
        assert_eq!(
            (row["electrostatics"].as_str(), row["contact"].as_str()),
            ("", "")
        );
    }
}

/// A protein pair turns everything on, and every reported row adds up and scores the same again.
#[test]
fn a_protein_pair_calls_for_all_and_a_reported_pose_scores_the_same_again() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    // The ladder of modes, of which nothing is read here, takes half as long at this resolution.
    let resolution = ["--resolution", "8"];
    let options = ["--rotations", "24", "--poses", "40", "--refine", "5"];
    let options = [&options[..], &resolution].concat();
    let (object, _) = dock(folder.path(), &receptor, &ligand, &options);
    let effects = object["run"]["effects"].as_array().unwrap();
    let names: Vec<&Value> = effects.iter().map(|effect| &effect["effect"]).collect();
    assert_eq!(names, ["shape", "electrostatics", "contact", "restraint"]);
    // Neither is an antibody.
    for effect in effects {
        assert_eq!(effect["on"], effect["effect"] != "restraint", "{effect}");
    }
    // Bovine trypsin has 14 lysines and 2 arginines against 6 aspartates and 4 glutamates; its ends cancel.
    assert_eq!(object["run"]["plan"]["labels"][0]["net_charge"], 6.0);
    let number = |value: &Value| value.as_f64().unwrap();
    for row in object["best"].as_array().unwrap().iter().take(1) {
        let terms = ["shape", "electrostatics", "contact"].map(|name| number(&row[name]));
        let score = number(&row["search_score"]);
        assert!((terms.iter().sum::<f64>() - score).abs() < 1e-9 * score.abs());
        let pose: Vec<String> = ["qw", "qx", "qy", "qz", "tx", "ty", "tz"]
            .iter()
            .map(|part| row[part].to_string())
            .collect();
        let pose = pose.join(",");
        let command = ["score", &receptor, &ligand, "--pose", &pose, "--json"];
        let (again, _) = run(folder.path(), &[&command[..], &resolution].concat());
        let again: Value = serde_json::from_str(&again).unwrap();
        for name in ["unresolved_residues", "terminus_residues"] {
            assert_eq!(again[name], object["run"]["plan"][name]);
            assert!(again[name][0]["residues"].is_number());
        }
        assert!((number(&again["exact"]) - score).abs() < 1e-6 * score.abs());
        for (name, term) in ["shape", "electrostatics", "contact"].iter().zip(terms) {
            assert!((number(&again["terms"][name]) - term).abs() < 1e-6 * score.abs());
        }
        let shown = POSE_TERMS.iter().filter(|term| term.is_shown_always);
        let ids = shown.map(|term| term.id);
        for name in ids.clone().chain(["pose_score"]) {
            assert!((number(&again[name]) - number(&row[name])).abs() < 1e-6 * score.abs());
        }
        let sum = ids
            .map(|id| number(&row[id]))
            .reduce(|sum, value| sum + value);
        assert_eq!(number(&row["pose_score"]), score + sum.unwrap());
    }
}

/// A ligand without amino acids has no contact types, and one of neutral atoms no charges: auto leaves them off and
/// says why, and to force them is an error.
#[test]
fn what_the_inputs_cannot_feed_is_off_and_cannot_be_forced() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("receptor.pdb"), molecules::receptor()).unwrap();
    let atoms: String = (1..=12)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::FRAC_PI_6;
            let (x, y) = (2.6 * angle.cos(), 2.6 * angle.sin());
            format!(
                "HETATM{k:5} C{k:<2}  LIG A   1    {x:8.3}{y:8.3}{:8.3}  1.00  0.00           C\n",
                0.0
            )
        })
        .collect();
    fs::write(folder.path().join("ring.pdb"), atoms + "END\n").unwrap();
    fs::write(folder.path().join("helix.pdb"), molecules::ligand()).unwrap();
    let options = ["--rotations", "8", "--poses", "10", "--refine", "0"];
    let (object, _) = dock(folder.path(), "receptor.pdb", "helix.pdb", &options);
    for effect in object["run"]["effects"].as_array().unwrap() {
        assert_eq!(effect["on"], effect["effect"] != "restraint", "{effect}");
    }
    let (object, _) = dock(folder.path(), "receptor.pdb", "ring.pdb", &options);
    for effect in &object["run"]["effects"].as_array().unwrap()[1..3] {
        assert_eq!(effect["on"], false);
        assert!(
            effect["reason"].as_str().unwrap().contains("ligand"),
            "{effect}"
        );
        assert_eq!(effect["functions"], 0.0);
    }
    for name in ["electrostatics", "contact"] {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(["dock", "receptor.pdb", "ring.pdb", "-o", "forced", "--json"])
            .args(["--effects", name])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        let error: Value = serde_json::from_slice(&output.stdout).unwrap();
        let message = error["error"]["message"].as_str().unwrap();
        assert!(
            message.contains(name) && message.contains("ligand"),
            "{message}"
        );
        assert!(!folder.path().join("forced").exists());
    }
}
