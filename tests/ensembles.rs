//! Several conformations of a side: every pair docked, one ranking, and its later uses.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use assert_cmd::cargo::cargo_bin_cmd;
use knotdock_scoring::se3::Pose;
use serde_json::Value;

use crate::dock_run::run::{comparable_report, files, number, rows, run};
use crate::program::refused;

fn example(name: &str) -> String {
    let file = format!("structures/examples/1ppe_{name}.pdb");
    fs::read_to_string(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(file)).unwrap()
}

/// The atom records of an example with every atom moved.
fn moved(name: &str, motion: &Pose) -> String {
    let text = example(name);
    let records = text.lines().filter(|line| line.starts_with("ATOM"));
    let record = |line: &str| {
        let position = [30, 38, 46].map(|from| line[from..from + 8].trim().parse().unwrap());
        let [x, y, z] = motion.apply(position);
        format!("{}{x:8.3}{y:8.3}{z:8.3}{}\n", &line[..30], &line[54..])
    };
    records.map(record).collect()
}

fn motion() -> Pose {
    Pose::from_parts([0.8, 0.2, -0.5, 0.1], [12.0, -7.0, 30.0])
}

/// A folder with the unbound receptor, and the ligand in two models, the second of which is the first moved.
fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    write("receptor.pdb", example("receptor_unbound"));
    write("copy.pdb", example("receptor_unbound"));
    write("ligand.pdb", example("ligand_unbound"));
    let models = [Pose::identity(), motion()].map(|motion| moved("ligand_unbound", &motion));
    write(
        "models.pdb",
        format!(
            "MODEL        1\n{}ENDMDL\nMODEL        2\n{}ENDMDL\nEND\n",
            models[0], models[1]
        ),
    );
    write("bound_receptor.pdb", example("receptor_bound"));
    write("bound_ligand.pdb", example("ligand_bound"));
    folder
}

const SHORT: &str = "--rotations 120 --poses 150 --sharp off --write-top 2 --quiet";

fn pose(row: &BTreeMap<String, String>) -> Pose {
    let quaternion = ["qw", "qx", "qy", "qz"].map(|part| number(row, part));
    Pose::from_parts(quaternion, ["tx", "ty", "tz"].map(|part| number(row, part)))
}

/// All files but the parts of records that differ from run to run.
fn comparable(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = files(folder);
    for (name, bytes) in &mut found {
        if name.ends_with(".json") {
            let mut record: Value = serde_json::from_slice(bytes).unwrap();
            for part in ["timing", "machine", "command"] {
                record.as_object_mut().unwrap().remove(part);
            }
            *bytes = record.to_string().into_bytes();
        }
        if name.ends_with("report.html") {
            *bytes = comparable_report(bytes);
        }
    }
    found
}

/// Twice the same conformation: each cluster is found twice, and scores T ln 2 more than in one run.
#[test]
fn the_same_conformation_twice_doubles_every_cluster() {
    let folder = place();
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.pdb {SHORT} --exact all --raw -o one"),
    );
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.pdb --receptor-also copy.pdb {SHORT} -o two"),
    );
    let (one, two) = (
        rows(&folder.path().join("one")),
        rows(&folder.path().join("two")),
    );
    for member in ["r1_l1", "r2_l1"] {
        let members = folder.path().join("two/members").join(member);
        assert_eq!(rows(&members), one);
    }
    let best = one.iter().map(|row| number(row, "pose_score"));
    let expected = 0.1 * best.fold(f64::MIN, f64::max) * 2f64.ln();
    let mut doubled = 0;
    for row in &two {
        let own = number(row, "member_rank") as usize;
        let of_one = &one[own - 1];
        assert_eq!(pose(row), pose(of_one));
        // Poses that stand for two clusters may lie within one.
        if number(row, "cluster_size") == 2.0 * number(of_one, "cluster_size") {
            let more = number(row, "score") - number(of_one, "score");
            assert!((more - expected).abs() < 1e-6, "{more} {expected}");
            doubled += 1;
        }
    }
    assert!(doubled * 10 > 8 * one.len(), "{doubled} of {}", one.len());
}

/// Models are laid on the first, whose clusters the poses of all join; complexes hold the model of their row, and a
/// known complex is matched with each.
#[test]
fn models_of_a_file_are_ranked_together() {
    let folder = place();
    let command = format!(
        "dock receptor.pdb models.pdb --ligand-models all --native-receptor bound_receptor.pdb --native-ligand \
         bound_ligand.pdb {SHORT} -o run"
    );
    run(folder.path(), &command);
    let directory = folder.path().join("run");
    let record: Value =
        serde_json::from_slice(&fs::read(directory.join("ensemble.json")).unwrap()).unwrap();
    let back = record["ligand"][1]["to_first"].as_array().unwrap();
    let back: Vec<f64> = back.iter().map(|part| part.as_f64().unwrap()).collect();
    let back = Pose::from_parts(back[..4].try_into().unwrap(), back[4..].try_into().unwrap());
    // Coordinates have three decimals.
    assert!(back.after(&motion()).angle_to(&Pose::identity()) < 1e-3);
    assert!(back.after(&motion()).translation.norm() < 1e-2);
    assert!(record["ligand"][1]["rmsd_from_first"].as_f64().unwrap() < 2e-3);

    let found = rows(&directory);
    let models: Vec<&str> = found
        .iter()
        .map(|row| row["ligand_model"].as_str())
        .collect();
    assert!(models.contains(&"1") && models.contains(&"2"));
    let of_members: usize = ["r1_l1", "r1_l2"]
        .map(|member| rows(&directory.join("members").join(member)).len())
        .iter()
        .sum();
    assert!(found.len() < of_members, "no cluster is of both");

    // A complex has the ligand of its model, in the place of its row.
    let row = found
        .iter()
        .position(|row| row["ligand_model"] == "2")
        .unwrap();
    run(
        folder.path(),
        &format!("export run --rank {},1 --raw -o out", row + 1),
    );
    let complex = fs::read_to_string(folder.path().join(format!("out/rank_{:04}.pdb", row + 1)));
    let first = moved("ligand_unbound", &pose(&found[row]).after(&motion()));
    let place = |line: &str| -> Vec<f64> {
        [30, 38, 46]
            .map(|at| line[at..at + 8].trim().parse().unwrap())
            .to_vec()
    };
    let complex = complex.unwrap();
    let last = |text: &str| place(text.lines().rfind(|line| line.starts_with("ATOM")).unwrap());
    for (a, b) in last(&complex).iter().zip(last(&first)) {
        assert!((a - b).abs() < 5e-3, "{a} {b}");
    }

    // Measured again, each row has what its member's evaluation gave it, and the native chains beside it.
    run(folder.path(), "evaluate run -o again.csv --quiet");
    let again = fs::read_to_string(folder.path().join("again.csv")).unwrap();
    let measured = fs::read_to_string(directory.join("poses.csv")).unwrap();
    assert_eq!(again.lines().count(), measured.lines().count());
    for (again, measured) in again.lines().skip(1).zip(measured.lines().skip(1)) {
        assert_eq!(again.strip_suffix(",\"A:A,B:B\""), Some(measured));
    }
}

/// An ensemble that was stopped goes on where it was, and neither that nor the number of threads changes a byte.
#[test]
fn a_stopped_ensemble_goes_on() {
    let folder = place();
    let command = format!("dock receptor.pdb models.pdb --ligand-models 1-2 {SHORT} -o run");
    run(folder.path(), &format!("{command} --threads 2"));
    let directory = folder.path().join("run");
    let whole = comparable(&directory);
    for file in [
        "ensemble.json",
        "poses.csv",
        "view.pml",
        "view.cxc",
        "report.html",
    ] {
        fs::remove_file(directory.join(file)).unwrap();
    }
    fs::remove_dir_all(directory.join("top")).unwrap();
    fs::remove_dir_all(directory.join("members/r1_l2")).unwrap();
    run(folder.path(), &format!("{command} --threads 1"));
    assert_eq!(comparable(&directory), whole);
    let record: Value =
        serde_json::from_slice(&fs::read(directory.join("ensemble.json")).unwrap()).unwrap();
    assert_eq!(record["timing"]["members_kept"], 1);
    // Done once, it is not replaced unless that is requested.
    let again = |more: &str| {
        let words = format!("{command} {more}");
        cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(words.split_whitespace())
            .output()
            .unwrap()
    };
    assert_eq!(again("").status.code(), Some(2));
    assert!(again("--force").status.success());
    assert_eq!(comparable(&directory), whole);
    // One with a user's file is not, wherever that is, finished or started.
    let notes = directory.join("members/r1_l2/notes.txt");
    fs::write(&notes, "mine").unwrap();
    let refused = again("--force");
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(said.contains("members/r1_l2/notes.txt"), "{said}");
    fs::remove_file(&notes).unwrap();
    assert_eq!(comparable(&directory), whole);
    fs::remove_file(directory.join("ensemble.json")).unwrap();
    fs::write(directory.join("notes.txt"), "mine").unwrap();
    let begun = files(&directory);
    for force in ["", "--force"] {
        let refused = again(force);
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        assert!(files(&directory) == begun, "{force}");
    }
}

/// One model of a file is an ordinary run, and its record repeats it.
#[test]
fn one_model_is_an_ordinary_run() {
    let folder = place();
    run(
        folder.path(),
        &format!("dock receptor.pdb models.pdb --ligand-models 2 {SHORT} -o run"),
    );
    assert!(!folder.path().join("run/members").exists());
    run(folder.path(), "dock --rerun run/run.json -o again --quiet");
    assert_eq!(
        rows(&folder.path().join("run")),
        rows(&folder.path().join("again"))
    );
    run(
        folder.path(),
        &format!("dock receptor.pdb models.pdb --model 2 {SHORT} -o other"),
    );
    assert_eq!(
        rows(&folder.path().join("run")),
        rows(&folder.path().join("other"))
    );
}

/// A batch holds ensembles as it holds runs, and does none twice.
#[test]
fn a_batch_docks_ensembles() {
    let folder = place();
    fs::write(
        folder.path().join("pairs.csv"),
        "name,receptor,ligand,ligand_models\nboth,receptor.pdb,models.pdb,all\n",
    )
    .unwrap();
    let batch = format!(
        "batch pairs.csv -o out --json -- {}",
        SHORT.replace(" --quiet", "")
    );
    let status = |text: String| {
        let object: Value = serde_json::from_str(&text).unwrap();
        object["pairs"][0]["status"].as_str().unwrap().to_owned()
    };
    assert_eq!(status(run(folder.path(), &batch)), "docked");
    assert_eq!(status(run(folder.path(), &batch)), "kept");
    assert!(
        folder
            .path()
            .join("out/both/members/r1_l2/run.json")
            .is_file()
    );
}

/// What is no ensemble is refused with a remedy, and nothing is written.
#[test]
fn what_is_no_ensemble_is_refused() {
    let folder = place();
    fs::write(
        folder.path().join("ball.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    )
    .unwrap();
    for (options, said) in [
        (
            "receptor.pdb models.pdb --ligand-models 3",
            "there is no model 3",
        ),
        (
            "receptor.pdb models.pdb --ligand-models 2-1",
            "no list of models",
        ),
        (
            "receptor.pdb models.pdb --ligand-models 0",
            "no list of models",
        ),
        (
            "receptor.pdb ligand.pdb --receptor-also ligand.pdb",
            "another molecule",
        ),
        (
            "receptor.pdb ligand.pdb --receptor-also receptor.pdb",
            "named twice",
        ),
        (
            "receptor.pdb ligand.pdb --receptor-also none.pdb",
            "there is no such file",
        ),
        (
            "receptor.pdb ligand.pdb --receptor-also ball.obj",
            "only molecules",
        ),
        (
            "receptor.pdb --symmetry C2 --receptor-models all",
            "cannot be used with",
        ),
        (
            "receptor.pdb models.pdb --ligand-models all --model 2",
            "cannot be used with",
        ),
        (
            "receptor.pdb models.pdb --ligand-models all --budget 5s",
            "cannot be used with",
        ),
    ] {
        let words = format!("dock {options} --rotations 24 -o none");
        let error = refused(folder.path(), words.split(' '));
        assert!(!folder.path().join("none").exists());
        let message = error["message"].as_str().unwrap();
        assert!(message.contains(said), "{options}: {message}");
    }
    // A run and an ensemble do not share a directory, and commands that read one run report that this is an ensemble.
    run(
        folder.path(),
        &format!("dock receptor.pdb models.pdb --ligand-models all {SHORT} -o run"),
    );
    for (command, expected) in [
        (
            "dock receptor.pdb ligand.pdb --force -o run",
            "holds no run of knotdock",
        ),
        ("refine run --ranks 1", "ensemble"),
        ("dock --rerun run/ensemble.json -o again", "ensemble"),
    ] {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(command.split(' '))
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{command}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(expected), "{said}");
    }
}
