//! Poses handed back to structure predictors: `knotdock export --format boltz|chai|protenix`.

use std::fs;

use crate::molecules;
use crate::program::{refused, succeed};
use serde_json::Value;

fn docked() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("receptor.pdb"), molecules::receptor()).unwrap();
    fs::write(folder.path().join("ligand.pdb"), molecules::ligand()).unwrap();
    let words =
        "dock receptor.pdb ligand.pdb -o run --quiet --rotations 60 --poses 60 --write-top 0";
    succeed(folder.path(), words.split(' '));
    folder
}

/// The sequences are those of the files, the contacts are as many as requested, and a second call changes nothing.
#[test]
fn a_pose_becomes_an_input_of_each_predictor() {
    let folder = docked();
    let export = |words: &str| {
        succeed(
            folder.path(),
            format!("export run {words} --json").split(' '),
        )
    };
    let read =
        |name: &str| fs::read_to_string(folder.path().join("run/predict").join(name)).unwrap();
    export("--rank 1-2 --format boltz --contacts 2");
    let yaml = read("rank_0001.yaml");
    let sequences = yaml
        .lines()
        .filter_map(|line| line.trim().strip_prefix("sequence: "));
    // Two helices, and the ligand.
    assert_eq!(
        sequences.map(str::len).collect::<Vec<_>>()[..2],
        [16, 14],
        "{yaml}"
    );
    assert_eq!(yaml.matches("- contact:").count(), 2, "{yaml}");
    let output = export("--rank 1 --format protenix");
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        object["files"],
        serde_json::json!(["run/predict/rank_0001.json"])
    );
    let json: Value = serde_json::from_str(&read("rank_0001.json")).unwrap();
    assert_eq!(json[0]["sequences"].as_array().unwrap().len(), 3);
    export("--rank 1 --format chai");
    let restraints = read("rank_0001_restraints.csv");
    let mut rows = csv::Reader::from_reader(restraints.as_bytes());
    assert!(rows.records().all(|row| row.unwrap()[2].starts_with('A')));
    export("--rank 1-2 --format boltz --contacts 2");
    assert_eq!(read("rank_0001.yaml"), yaml);
    // Files that the run lists are replaced with it.
    let words = "dock receptor.pdb ligand.pdb -o run --force --quiet --rotations 50 --write-top 0";
    succeed(folder.path(), words.split(' '));
    assert!(!folder.path().join("run/predict").exists());
}

/// Rings and meshes have no two partners with sequences.
#[test]
fn rings_and_meshes_are_refused() {
    let folder = docked();
    let words =
        "dock receptor.pdb --symmetry C2 -o ring --quiet --rotations 20 --poses 20 --write-top 0";
    succeed(folder.path(), words.split(' '));
    let error = refused(
        folder.path(),
        "export ring --rank 1 --format boltz".split(' '),
    );
    assert!(
        error["message"].as_str().unwrap().contains("ring"),
        "{error}"
    );
    for (name, size) in [("a.obj", 10), ("b.obj", 6)] {
        let tetrahedron = format!(
            "v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
        );
        fs::write(folder.path().join(name), tetrahedron).unwrap();
    }
    let words = "dock a.obj b.obj -o parts --quiet --rotations 20 --sample-grid 2^12 --write-top 0";
    succeed(folder.path(), words.split(' '));
    let error = refused(
        folder.path(),
        "export parts --rank 1 --format chai".split(' '),
    );
    assert!(
        error["message"].as_str().unwrap().contains("molecules"),
        "{error}"
    );
}
