//! `--engine gpu` as its users see it: the rows of the CPU's engine, the same bytes each time, and clear words where
//! it cannot be had.

#[path = "../scoring/tests/scene/adapter.rs"]
mod adapter;

use crate::dock_run::run::{comparable, number, place, rows, run};
use crate::docking_parts;
use adapter::adapter;
use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn example(name: &str) -> String {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("structures/examples");
    folder.join(name).display().to_string()
}

fn record(run: &Path) -> Value {
    serde_json::from_slice(&fs::read(run.join("run.json")).unwrap()).unwrap()
}

/// Runs with both engines and compares their rows. Every row of either is among the other's but for a few at the end,
/// where a rounding error decides what is kept. Rows that both have were scored by the same exact sum; the grid's
/// scores differ by single precision alone.
fn hold_to_cpu(folder: &Path, arguments: &str) {
    run(
        folder,
        &format!("dock {arguments} --diagnostics --write-top 0 -o cpu --quiet"),
    );
    run(
        folder,
        &format!("dock {arguments} --diagnostics --write-top 0 -o gpu --engine gpu --quiet"),
    );
    let (cpu, gpu) = (rows(&folder.join("cpu")), rows(&folder.join("gpu")));
    let best = cpu
        .iter()
        .map(|row| number(row, "score_grid").abs())
        .fold(0.0, f64::max);
    let key = |row: &std::collections::BTreeMap<String, String>| {
        ["rotation", "tx", "ty", "tz"].map(|column| row[column].clone())
    };
    let mut shared = 0;
    for row in &gpu {
        let Some(twin) = cpu.iter().find(|other| key(other) == key(row)) else {
            continue;
        };
        shared += 1;
        assert_eq!(row["search_score"], twin["search_score"]);
        let difference = number(row, "score_grid") - number(twin, "score_grid");
        assert!(difference.abs() < 1e-5 * best, "{difference} of {best}");
    }
    println!("{shared} of {} and {} rows", cpu.len(), gpu.len());
    assert!(!cpu.is_empty() && 50 * shared >= 49 * cpu.len().max(gpu.len()));
    let record = record(&folder.join("gpu"));
    assert_eq!(record["options"]["search"]["engine"], "gpu");
    assert!(record["machine"]["adapter"]["name"].is_string());
}

#[test]
fn all_effects_of_a_pair_of_proteins() {
    if adapter().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let pair = [
        example("1ppe_receptor_unbound.pdb"),
        example("1ppe_ligand_unbound.pdb"),
    ]
    .join(" ");
    hold_to_cpu(
        folder.path(),
        &format!("{pair} --rotations 48 --resolution 6 --poses 400 --no-cluster"),
    );
}

#[test]
fn coarse_to_fine_and_few_wanted_images() {
    if adapter().is_none() {
        return;
    }
    let folder = place();
    hold_to_cpu(
        folder.path(),
        "receptor.pdb ligand.pdb --effects shape --rotations 62 --fine-rotations 500 --no-cluster --per-rotation 7",
    );
}

#[test]
fn meshes() {
    if adapter().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let pair = docking_parts::peg_and_hole(0.05);
    for (name, part) in [("a.stl", &pair.receptor), ("b.stl", &pair.ligand)] {
        fs::write(folder.path().join(name), part.stl()).unwrap();
    }
    hold_to_cpu(
        folder.path(),
        "a.stl b.stl --rotations 40 --sample-grid 2^15 --no-cluster",
    );
}

/// Threads, another run and `--rerun` change no byte.
#[test]
fn the_same_bytes_each_time() {
    if adapter().is_none() {
        return;
    }
    let folder = place();
    let words = "dock receptor.pdb ligand.pdb --rotations 60 --engine gpu --quiet";
    run(folder.path(), &format!("{words} --threads 1 -o one"));
    run(folder.path(), &format!("{words} --threads 2 -o two"));
    run(folder.path(), "dock --rerun one/run.json -o again --quiet");
    let one = comparable(&folder.path().join("one"));
    for other in ["two", "again"] {
        assert_eq!(one, comparable(&folder.path().join(other)), "{other}");
    }
}

/// Where memory and not threads limits the rotations that cores would have in flight, the card still gets its share: all
/// of it used to be planned for the cores.
#[test]
fn cores_leave_the_card_its_share_of_the_memory() {
    if adapter().is_none() {
        return;
    }
    let folder = place();
    let words =
        "dock receptor.pdb ligand.pdb --rotations 60 --resolution 8 --engine gpu --quiet -o run";
    run(
        folder.path(),
        &format!("{words} --threads 1000 --memory 400M"),
    );
    let record = record(&folder.path().join("run"));
    let in_flight = record["machine"]["adapter"]["rotations_in_flight"].as_u64();
    assert!(in_flight.is_some_and(|count| count > 4), "{record}");
}

/// `auto` takes a card that can, and otherwise searches on the cores: to the bytes of `--engine cpu`, but for its name, and
/// with a warning if a card failed.
#[test]
fn auto_goes_on_without_a_card() {
    let Some(gpu) = adapter() else { return };
    let folder = place();
    let dock = |name: &str, arguments: &str| {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .env("WGPU_ADAPTER_NAME", name)
            .args("dock receptor.pdb ligand.pdb --rotations 40 --write-top 0".split(' '))
            .args(arguments.split(' '))
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        let run = arguments.rsplit(' ').next().unwrap();
        let rows = rows(&folder.path().join(run));
        let machine = record(&folder.path().join(run))["machine"].clone();
        (String::from_utf8(output.stderr).unwrap(), rows, machine)
    };
    let (_, of_cores, _) = dock(gpu.name(), "--engine cpu -o cpu");
    // What is named is taken, even a program that emulates a card.
    let (warnings, _, machine) = dock(gpu.name(), "--engine auto -o taken");
    assert_eq!(machine["adapter"]["name"], gpu.name());
    assert!(!warnings.contains("the cores searched"), "{warnings}");
    let (warnings, rows, machine) = dock("no such adapter", "--engine auto -o none");
    assert!(machine["adapter"].is_null(), "{machine}");
    let reason = machine["adapter_failure"].as_str().unwrap();
    assert!(reason.contains("no such adapter"), "{reason}");
    assert!(warnings.contains("the cores searched"), "{warnings}");
    assert_eq!(rows, of_cores);
    let (warnings, _, machine) = dock(gpu.name(), "--engine auto --precision double -o double");
    assert!(machine["adapter"].is_null() && machine["adapter_failure"].is_null());
    assert!(!warnings.contains("the cores searched"), "{warnings}");
}

/// With or without an adapter: nothing is left behind, and the words say what to do.
#[test]
fn what_cannot_be_had_is_refused() {
    let folder = place();
    for (command, arguments, code, said) in [
        ("dock", "", 1, "no such adapter"),
        ("dock", "--precision double", 2, "single"),
        ("dock", "--budget 5s", 2, "--budget"),
        ("dock", "--accuracy 1e-3", 2, "--accuracy"),
        ("tradeoff", "", 2, "processor time"),
    ] {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .env("WGPU_ADAPTER_NAME", "no such adapter")
            .arg(command)
            .args("receptor.pdb ligand.pdb --rotations 20 --json --engine gpu -o run".split(' '))
            .args(arguments.split_whitespace())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments}");
        let error: Value = serde_json::from_slice(&output.stdout).unwrap();
        let message = error["error"]["message"].as_str().unwrap();
        assert!(message.contains(said), "{message}");
        assert!(error["error"]["remedy"].is_string());
        assert!(!folder.path().join("run").exists(), "{arguments}");
    }
}
