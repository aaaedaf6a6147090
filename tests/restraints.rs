//! Distance restraints: search and ranking by them, the files of a run, and the inputs that are refused.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use assert_cmd::cargo::cargo_bin_cmd;
use knotdock_scoring::se3::Pose;
use serde_json::Value;

use crate::dock_run::run::{comparable, number, rows, run};
use crate::program::succeed;

/// Trypsin's catalytic serine and the residue of the inhibitor that enters its pocket.
const PAIR: &str = "receptor,ligand,upper\nA:195.CA,B:5.CA,10\n";

fn example(name: &str) -> String {
    format!(
        "{}/structures/examples/1ppe_{name}.pdb",
        concat!(env!("CARGO_MANIFEST_DIR"), "/..")
    )
}

/// Docks the example pair into `run` with a file of restraints and further options.
fn dock(folder: &Path, file: &str, text: &str, options: &str) -> Vec<BTreeMap<String, String>> {
    fs::write(folder.join(file), text).unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let mut words = vec!["dock", &receptor, &ligand, "--restraints", file];
    let always =
        "--rotations 96 --poses 60 --no-cluster --sharp off --write-top 0 -o run --force --quiet";
    words.extend(always.split(' ').chain(options.split_whitespace()));
    succeed(folder, words);
    rows(&folder.join("run"))
}

/// Position of a CA atom in an example file.
fn alpha(name: &str, chain: &str, number: &str) -> [f64; 3] {
    let text = fs::read_to_string(example(name)).unwrap();
    let is_it = |line: &&str| {
        line.starts_with("ATOM")
            && line[12..16].trim() == "CA"
            && line[21..22] == *chain
            && line[22..26].trim() == number
    };
    let line = text.lines().find(is_it).unwrap();
    [30, 38, 46].map(|from| line[from..from + 8].trim().parse().unwrap())
}

fn distance(a: [f64; 3], b: [f64; 3], row: &BTreeMap<String, String>) -> f64 {
    let quaternion = ["qw", "qx", "qy", "qz"].map(|part| number(row, part));
    let pose = Pose::from_parts(quaternion, ["tx", "ty", "tz"].map(|part| number(row, part)));
    let moved = pose.apply(b);
    let square = |axis: usize| (a[axis] - moved[axis]).powi(2);
    (square(0) + square(1) + square(2)).sqrt()
}

/// Every pose can satisfy the restraint within what the samples leave open, pays 400 for each Å that it does not, and
/// is listed with its distance. A record repeats the run without the file.
#[test]
fn poses_that_cannot_satisfy_a_restraint_are_not_searched() {
    let folder = tempfile::tempdir().unwrap();
    let found = dock(folder.path(), "known.csv", PAIR, "");
    assert!(found.len() > 20);
    let ends = [
        alpha("receptor_unbound", "A", "195"),
        alpha("ligand_unbound", "B", "5"),
    ];
    let mut listed = csv::Reader::from_path(folder.path().join("run/restraints.csv")).unwrap();
    let listed: Vec<BTreeMap<String, String>> =
        listed.deserialize().map(|row| row.unwrap()).collect();
    assert_eq!(listed.len(), found.len());
    let mut met = 0;
    for (row, listed) in found.iter().zip(&listed) {
        let distance = distance(ends[0], ends[1], row);
        assert!(distance < 18.0, "{distance}");
        let penalty = -400.0 * (distance - 10.0).max(0.0);
        assert!((number(row, "restraints_penalty") - penalty).abs() < 1e-6);
        assert_eq!(listed["rank"], row["rank"]);
        assert!((number(listed, "distance") - distance).abs() < 1e-9);
        assert_eq!(listed["met"], (distance <= 10.0).to_string());
        assert_eq!(
            row["restraints_met"],
            u8::from(distance <= 10.0).to_string()
        );
        met += usize::from(distance <= 10.0);
    }
    assert!(met > 5, "{met}");

    let before = comparable(&folder.path().join("run"));
    fs::remove_file(folder.path().join("known.csv")).unwrap();
    run(
        folder.path(),
        "dock --rerun run/run.json -o again --threads 1 --quiet",
    );
    assert_eq!(before, comparable(&folder.path().join("again")));
}

/// Poses that score less than the two apart are kept only where restraints leave nothing else.
#[test]
fn overlap_is_kept_where_there_is_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let scores = |text: &str| -> Vec<f64> {
        let found = dock(folder.path(), "known.csv", text, "");
        found
            .iter()
            .map(|row| number(row, "search_score"))
            .collect()
    };
    let buried = scores("receptor,ligand,upper\nA:228.CA,B:16.CA,1\n");
    assert!(buried.len() > 20 && buried.iter().all(|score| *score < 0.0));
    let near = scores(PAIR);
    assert!(near.len() > 20 && near.iter().all(|score| *score > 0.0));
}

/// Of several restraints some may be false. Where too many have to hold, no pose is left, and the message says so.
#[test]
fn some_restraints_may_be_false() {
    let folder = tempfile::tempdir().unwrap();
    let two = format!("{PAIR}A:244.CA,B:5.CA,1\n");
    let found = dock(folder.path(), "known.csv", &two, "--restraints-need 1");
    let mut best = 0;
    for row in &found {
        let met: u32 = row["restraints_met"].parse().unwrap();
        best = best.max(met);
        assert!(met <= 1);
    }
    assert_eq!(best, 1);
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder.path())
        .args([
            "dock",
            &example("receptor_unbound"),
            &example("ligand_unbound"),
        ])
        .args("--restraints known.csv --rotations 96 -o none --json".split(' '))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let error: Value = serde_json::from_slice(&output.stdout).unwrap();
    let message = error["error"]["message"].as_str().unwrap();
    assert!(
        message.contains("can satisfy 2 of the 2 restraints"),
        "{message}"
    );
    assert!(!folder.path().join("none").exists());
}

/// A cross-link without a bound has that of its reagent, and the same restraint as a statement gives the same table.
/// Bounds of one residue to three far ones contradict each other: poses come near, none meets all, and the run warns.
#[test]
fn restraints_that_no_pose_satisfies_are_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let contradictory = "receptor,ligand,upper\nA:16,B:5,3\nA:57,B:5,3\nA:245,B:5,3\n";
    fs::write(folder.path().join("all.csv"), contradictory).unwrap();
    fs::write(folder.path().join("one.csv"), PAIR).unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let said = |file: &str, options: &str| {
        let mut words = vec!["dock", &receptor, &ligand, "--restraints", file];
        let always = "--rotations 96 --poses 60 --sharp off --write-top 0 -o run --force";
        words.extend(always.split(' ').chain(options.split_whitespace()));
        let output = succeed(folder.path(), words);
        String::from_utf8(output.stderr).unwrap()
    };
    let warning = "no pose satisfies all 3 restraints, at most 1";
    let contradicted = said("all.csv", "");
    assert!(contradicted.contains(warning), "{contradicted}");
    for met in [said("all.csv", "--restraints-need 1"), said("one.csv", "")] {
        assert!(!met.contains("no pose satisfies"), "{met}");
    }
}

#[test]
fn presets_and_statements_mean_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let table = "receptor,ligand\nA:60,B:28\n";
    let of_table = dock(folder.path(), "known.csv", table, "--crosslink dss");
    // HADDOCK adds distances within a molecule, which docking does not change.
    let statement = "! a cross-link\nassign (segid A and resid 60 and name CA) (segid B and resid 28 and name CA) 30 30 0\n\
        assign (segid A and resid 60 and name CA) (segid A and resid 97 and name CA) 14.1 1.0 1.0\n";
    let of_statement = dock(folder.path(), "known.tbl", statement, "");
    assert_eq!(of_table, of_statement);
}

/// Files that cannot be used are refused at their line, with a remedy.
#[test]
fn what_cannot_be_used_is_refused_at_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, text: &str, options: &[&str]| -> Value {
        fs::write(folder.path().join(name), text).unwrap();
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args([
                "dock",
                &example("receptor_unbound"),
                &example("ligand_unbound"),
            ])
            .args(["--restraints", name, "-o", "none", "--json"])
            .args(options)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(!folder.path().join("none").exists());
        let mut object: Value = serde_json::from_slice(&output.stdout).unwrap();
        object["error"].take()
    };
    for (name, text, line, said) in [
        (
            "a.csv",
            "receptor,ligand,upper\nA:195,B:5,ten\n",
            2,
            "upper is `ten`",
        ),
        (
            "a.csv",
            "receptor,ligand,upper\n# known\nA:9999,B:5,9\n",
            3,
            "9999",
        ),
        ("a.csv", "receptor,ligand\nA:195,B:5\n", 2, "upper"),
        (
            "a.csv",
            "receptor,ligand,lower,upper\nA:195,B:5,9,8\n",
            2,
            "9",
        ),
        ("a.csv", "receptor,ligand,uper\nA:195,B:5,8\n", 1, "`uper`"),
        (
            "a.tbl",
            "assign (segid A and resid 195)\n (segid B and resid 5 2 2 0\n",
            2,
            "",
        ),
        (
            "a.tbl",
            "\nassign (segid A and resid 195) (segid Q) 2 2 0\n",
            2,
            "Q",
        ),
        (
            "a.tbl",
            "assign (segid A and resid 195) (segid A and resid 57) 2 2 0\n",
            1,
            "",
        ),
    ] {
        let error = refused(name, text, &[]);
        assert_eq!(error["line"], line, "{error}");
        assert!(error["file"].as_str().unwrap().ends_with(name), "{error}");
        assert!(error["message"].as_str().unwrap().contains(said), "{error}");
        assert!(!error["remedy"].as_str().unwrap().is_empty());
    }
    for (options, said) in [
        (
            &["--restraints-need", "2"][..],
            "2 restraints have to be satisfied, and there are 1",
        ),
        (
            &["--restraints-need", "0"],
            "a number of restraints such as 3",
        ),
        (&["--crosslink", "glue"], "glue"),
    ] {
        let error = refused("a.csv", PAIR, options);
        assert!(error["message"].as_str().unwrap().contains(said), "{error}");
    }
}
