//! Predicted models through every command: residues of low confidence are told of, left out where that is asked, and the choice is
//! recorded and followed.

mod molecules;
mod program;

use std::fs;
use std::path::Path;

use assert_cmd::cargo::cargo_bin_cmd;
use program::succeed;
use serde_json::Value;

/// The ligand as predicted: pLDDT 42, 47, 52 ... 97, two residues below 50.
fn predicted() -> String {
    let lines = molecules::ligand();
    let lines = lines.lines().map(|line| match line.get(22..26) {
        Some(number) => {
            let number: f64 = number.trim().parse().unwrap();
            line.replace(" 10.00 ", &format!("{:>6.2} ", 37.0 + 5.0 * number))
        }
        None => line.to_owned(),
    });
    lines.map(|line| line + "\n").collect()
}

fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("receptor.pdb"), molecules::receptor()).unwrap();
    fs::write(folder.path().join("ligand.pdb"), molecules::ligand()).unwrap();
    fs::write(folder.path().join("model.pdb"), predicted()).unwrap();
    let native = molecules::receptor().replace("END\n", "")
        + &molecules::ligand().replace(" ALA A", " ALA C");
    fs::write(folder.path().join("native.pdb"), native).unwrap();
    folder
}

fn json(folder: &Path, arguments: &str) -> Value {
    let output = succeed(folder, arguments.split_whitespace());
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn what_is_left_out_is_recorded_and_followed() {
    let folder = place();
    let folder = folder.path();
    let run = "dock receptor.pdb model.pdb --min-plddt 50 --rotations 20 --write-top 1 --native native.pdb -o run --quiet";
    succeed(folder, run.split_whitespace());
    let recorded = |name: &str| -> Value {
        serde_json::from_slice(&fs::read(folder.join(name).join("run.json")).unwrap()).unwrap()
    };
    let first = recorded("run");
    assert_eq!(first["options"]["min_plddt"], 50.0);
    let ligand = &first["inputs"]["ligand"];
    assert_eq!(ligand["atoms"], 50);
    assert_eq!(
        ligand["report"]["confidence"],
        serde_json::json!({"told_by": "values", "mean": 69.5, "residues": 12, "below_50": 2})
    );
    assert_eq!(
        first["inputs"]["receptor"]["report"]["confidence"],
        Value::Null
    );

    succeed(
        folder,
        "dock --from run/run.json -o again --quiet".split_whitespace(),
    );
    let bytes = |name: &str| fs::read(folder.join(name)).unwrap();
    assert_eq!(bytes("run/poses.csv"), bytes("again/poses.csv"));
    assert_eq!(recorded("again")["options"], first["options"]);
    succeed(
        folder,
        "complex run --rank 1 -o out --quiet".split_whitespace(),
    );
    assert_eq!(bytes("run/top/rank_0001.pdb"), bytes("out/rank_0001.pdb"));
    let matched = json(folder, "evaluate run --native native.pdb --json");
    assert_eq!(matched["match"], first["match"]);
    let named = "evaluate run/poses.csv --receptor receptor.pdb --ligand model.pdb --min-plddt 50 --native native.pdb --json";
    assert_eq!(json(folder, named), matched);
}

#[test]
fn inspect_says_how_sure_the_model_is() {
    let folder = place();
    let folder = folder.path();
    let told = json(folder, "inspect model.pdb --json");
    assert_eq!(told["input"]["atoms"], 60);
    assert_eq!(told["input"]["report"]["confidence"]["below_50"], 2);
    let warnings = told["input"]["report"]["warnings"].to_string();
    assert!(warnings.contains("--min-plddt 50"), "{warnings}");
    succeed(
        folder,
        "inspect model.pdb --min-plddt 50 --atoms atoms.csv --quiet".split_whitespace(),
    );
    let table = fs::read_to_string(folder.join("atoms.csv")).unwrap();
    let left_out = table
        .lines()
        .filter(|line| line.ends_with(",,low_confidence"));
    assert_eq!(left_out.count(), 10);
    assert_eq!(table.lines().count(), 61);
}

/// Where nothing is a prediction the limit would do nothing, which is no answer to who asked for it.
#[test]
fn a_limit_that_does_nothing_is_refused() {
    let folder = place();
    for command in [
        "dock receptor.pdb ligand.pdb --min-plddt 50 --json",
        "score receptor.pdb ligand.pdb --pose 1,0,0,0,0,0,0 --min-plddt 50 --json",
        "inspect ligand.pdb --min-plddt 50 --json",
        "tradeoff receptor.pdb ligand.pdb --min-plddt 50 --json",
    ] {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(command.split_whitespace())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{command}");
        let told: Value = serde_json::from_slice(&output.stdout).unwrap();
        let message = told["error"]["message"].as_str().unwrap();
        assert!(
            message.contains("--min-plddt is for predicted models"),
            "{message}"
        );
        assert!(
            told["error"]["remedy"]
                .as_str()
                .unwrap()
                .contains("_ma_qa_metric")
        );
    }
    succeed(
        folder.path(),
        "score receptor.pdb model.pdb --pose 1,0,0,0,0,0,0 --min-plddt 50 --quiet"
            .split_whitespace(),
    );
}
