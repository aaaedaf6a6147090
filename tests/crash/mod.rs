//! Crashes: each command is ended at every change that it makes to the disk, and every such change is made to fail.
//!
//! `KNOTDOCK_FAULT` (see `src/output/files/fault.rs`) does both, in builds with debug assertions. After each: the
//! user's files are as they were, the old or the new result stands whole, and a second call ends well and names what the
//! first one left.
#![cfg(debug_assertions)]

mod folder;
mod scenario;

use crate::molecules;
use crate::program::refused;
use std::fs;
use std::path::Path;

use folder::Snapshot;
use scenario::{Scenario, run};

/// Options of the smallest docking. No call is quiet: a quiet one warns of nothing.
const SMALL: &str = "--rotations 4 --poses 6 --resolution 12 --effects shape";

/// Writes the two molecules.
fn inputs(folder: &Path) {
    fs::write(folder.join("receptor.pdb"), molecules::receptor()).unwrap();
    fs::write(folder.join("ligand.pdb"), molecules::ligand()).unwrap();
}

/// The inputs, and a run of them by other options.
fn with_a_run(folder: &Path) {
    inputs(folder);
    let older = format!(
        "dock receptor.pdb ligand.pdb -o run --write-top 2 --no-cluster {SMALL} --per-rotation 2"
    );
    run(folder, &older);
}

/// The same, with the user's files in the run's directory.
fn with_a_run_and_notes(folder: &Path) {
    with_a_run(folder);
    fs::write(folder.join("run/notes.txt"), "mine").unwrap();
    fs::write(folder.join("run/top/session.cxs"), "mine").unwrap();
    fs::write(folder.join("run/top/rank_0002.pdb"), "edited").unwrap();
}

fn dock(extra: &str) -> String {
    format!("dock receptor.pdb ligand.pdb --write-top 2 {SMALL} {extra}")
}

#[test]
fn a_first_run() {
    Scenario::new(inputs, &dock("-o runs/run")).check();
}

/// The older run and the new one are exchanged at one stroke: one of the two is there after every crash.
#[test]
fn a_run_in_place_of_another() {
    let scenario = Scenario::new(with_a_run, &dock("-o run --force"));
    assert!(
        scenario
            .changes()
            .iter()
            .any(|change| change.starts_with("exchange"))
    );
    scenario.check();
}

/// A run is removed as a whole: one with the user's files in it, or with edited ones, is not removed at all.
#[test]
fn a_run_among_files_of_the_users() {
    let folder = tempfile::tempdir().unwrap();
    with_a_run_and_notes(folder.path());
    let before = Snapshot::of(folder.path());
    let error = refused(folder.path(), dock("-o run --force").split_whitespace());
    let message = error["message"].as_str().unwrap();
    for file in ["notes.txt", "top/rank_0002.pdb", "top/session.cxs"] {
        assert!(message.contains(file), "{file}: {message}");
    }
    assert_eq!(Snapshot::of(folder.path()).difference(&before), "");
}

fn without_an_exchange() -> Scenario {
    Scenario::new(with_a_run, &dock("-o run --force")).with_variable("KNOTDOCK_NO_EXCHANGE", "1")
}

/// There the older run goes aside first, and the next call puts it back if nothing came after.
#[test]
fn a_run_without_an_exchange() {
    without_an_exchange().check();
}

/// A command that only reads a run puts it back, too.
#[test]
fn a_run_that_is_aside_is_read() {
    let scenario = without_an_exchange();
    let is_taken = |change: &String| change.starts_with("rename") && !change.contains(".knotdock-");
    let taken = 1 + scenario.changes().iter().position(is_taken).unwrap();
    let root = tempfile::tempdir().unwrap();
    let folder = scenario.fresh(root.path());
    let old = Snapshot::of(&folder);
    scenario.call(&folder, &[("KNOTDOCK_FAULT", &format!("kill {taken}"))]);
    assert!(!folder.join("run").exists() && folder.join(".run.knotdock-old").exists());
    run(&folder, "export run --rank 1 -o out");
    assert!(!folder.join(".run.knotdock-old").exists());
    let found = Snapshot::of(&folder);
    assert_eq!(found.below("run").difference(&old.below("run")), "");
}

/// What is replaced as a whole cannot be the current folder, by whatever name, nor one above it.
#[test]
fn a_run_into_the_current_folder() {
    let folder = tempfile::tempdir().unwrap();
    inputs(folder.path());
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    let before = Snapshot::of(folder.path());
    for place in [".", "..", "../inner"] {
        let dock = format!("dock ../receptor.pdb ../ligand.pdb {SMALL} -o {place} --force");
        let error = refused(&inner, dock.split(' '));
        let remedy = error["remedy"].as_str().unwrap();
        assert!(remedy.contains("name a folder in it"), "{place}: {error}");
    }
    assert_eq!(Snapshot::of(folder.path()).difference(&before), "");
}

#[test]
fn complexes_of_a_run() {
    Scenario::new(with_a_run, "export run --rank 1-4")
        .additive()
        .check();
    Scenario::new(with_a_run, "export run --rank 3,4 -o out/complexes")
        .additive()
        .check();
}

/// Each file by itself is the old one or the new one.
#[test]
fn balls_of_a_mesh() {
    let mesh = |folder: &Path| {
        fs::write(folder.join("tetrahedron.obj"), folder::TETRAHEDRON).unwrap();
        for file in ["knots.csv", "balls.obj", "slices.svg"] {
            fs::write(folder.join(file), "old").unwrap();
        }
    };
    let sample = "sample tetrahedron.obj --grid 2^9 -o knots.csv --export balls.obj --picture slices.svg --force";
    Scenario::new(mesh, sample).by_file().check();
}

/// A table of collisions and the files of an obstacle, each in place of another.
#[test]
fn tables_and_files_of_solids() {
    let solids = |folder: &Path| {
        fs::write(folder.join("a.csv"), "0,0,0,1\n1.2,0,0,0.5\n").unwrap();
        for file in ["out.csv", "surface.obj", "depth.nrrd", "balls.svg"] {
            fs::write(folder.join(file), "old").unwrap();
        }
    };
    let collide = "collide a.csv a.csv -o out.csv --force --compute distance";
    Scenario::new(solids, collide).by_file().check();
    let obstacle = "obstacle a.csv a.csv -o out.csv --surface surface.obj --volume-grid depth.nrrd --picture balls.svg \
                    --cells 8 --force";
    Scenario::new(solids, obstacle).by_file().check();
}

/// Each pair has the old run, no run or the new one; the table has a row for each pair. What a run writes beside its
/// table is left to the tests of a run.
#[test]
fn a_batch() {
    let pairs = |folder: &Path| {
        inputs(folder);
        let table =
            "name,receptor,ligand\none,receptor.pdb,ligand.pdb\ntwo,ligand.pdb,receptor.pdb\n";
        fs::write(folder.join("pairs.csv"), table).unwrap();
    };
    let batch = format!("batch pairs.csv -o batch -j 1 -- --write-top 0 --no-report {SMALL}");
    Scenario::new(pairs, &batch)
        .by_directory(&["batch/one", "batch/two"])
        .check();
}

#[test]
fn a_sweep_of_settings() {
    let sweep = |folder: &Path| {
        inputs(folder);
        fs::create_dir(folder.join("sweep")).unwrap();
        let record = r#"{"program": "knotdock", "files": {}}"#;
        fs::write(folder.join("sweep/tradeoff.json"), record).unwrap();
    };
    let options = "--rotations 4 --poses 6 --resolution 12 --effects shape --parameters refine";
    let tradeoff = format!("tradeoff receptor.pdb ligand.pdb -o sweep --force {options}");
    Scenario::new(sweep, &tradeoff).measured().check();
}

#[test]
fn a_table_evaluated_in_place() {
    let evaluate = "evaluate run/poses.csv --native native.pdb -o run/poses.csv --force";
    let native = |folder: &Path| {
        with_a_run(folder);
        let complex = molecules::receptor().replace("END\n", "") + &molecules::ligand();
        fs::write(folder.join("native.pdb"), complex).unwrap();
    };
    Scenario::new(native, evaluate).by_file().check();
}

/// What is replaced is on the device before the older run goes: a power cut finds one of the two.
#[test]
fn a_run_is_on_the_device_before_another_goes() {
    for scenario in [
        Scenario::new(with_a_run, &dock("-o run --force")),
        without_an_exchange(),
        Scenario::new(inputs, &dock("-o run")),
    ] {
        let changes = scenario.changes();
        let place = |text: &str| changes.iter().position(|change| change.contains(text));
        let last_of = |text: &str| changes.iter().rposition(|change| change.contains(text));
        let taken = changes.iter().position(|change| {
            change.starts_with("exchange")
                || (change.starts_with("rename") && !change.contains(".knotdock-"))
        });
        let is_new = |change: &&String| {
            change.starts_with("create")
                && change.contains(".run.knotdock-")
                && !change.ends_with("-lock")
        };
        let new: Vec<&String> = changes.iter().filter(is_new).collect();
        assert!(new.len() > 4, "{changes:#?}");
        for written in new {
            let file = written.trim_start_matches("create");
            let synced = place(&format!("sync{file}"));
            assert!(
                synced.is_some() && synced < taken,
                "{written}: {changes:#?}"
            );
            assert!(synced > last_of(&format!("write{file}")), "{written}");
        }
        // The older files, and the lock, go after the folder that has the new ones is on the device, too.
        let removed = changes
            .iter()
            .position(|change| change.starts_with("unlink"));
        let folder = changes
            .iter()
            .rposition(|change| change.starts_with("sync") && !change.contains(".knotdock-"));
        assert!(folder > taken && folder < removed, "{changes:#?}");
    }
}

/// Files of a folder by their paths; only to see that the comparison can fail.
#[test]
fn snapshots_differ_where_files_do() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(
        at("run.json"),
        r#"{"program":"knotdock","timing":1,"machine":2,"x":3}"#,
    )
    .unwrap();
    let first = Snapshot::of(folder.path());
    fs::write(
        at("run.json"),
        r#"{"program":"knotdock","timing":7,"machine":8,"x":3}"#,
    )
    .unwrap();
    assert_eq!(first.difference(&Snapshot::of(folder.path())), "");
    fs::write(
        at("run.json"),
        r#"{"program":"knotdock","timing":7,"machine":8,"x":4}"#,
    )
    .unwrap();
    assert_ne!(first.difference(&Snapshot::of(folder.path())), "");
    let second = Snapshot::of(folder.path());
    fs::create_dir_all(at("in/.run.knotdock-abcdefghijkl/top")).unwrap();
    fs::write(at(".run.knotdock-lock"), "").unwrap();
    let third = Snapshot::of(folder.path());
    assert!(third.has_litter() && !second.has_litter());
    let left: Vec<&str> = third.leftovers().into_iter().collect();
    assert_eq!(left, ["in/.run.knotdock-abcdefghijkl"]);
}
