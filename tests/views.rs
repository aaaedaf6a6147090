//! Results to look at: scripts for viewers, and complexes in other formats.

use std::collections::BTreeSet;
use std::fs;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

use crate::dock_run::run::{place, rows, run};

const SMALL: &str = "--rotations 36 --poses 60 --no-cluster --write-top 3 --quiet";

/// The scripts load what is there, in both programs, and go with the run that is replaced.
#[test]
fn scripts_name_the_complexes_of_the_run() {
    let folder = place();
    let dock = format!("dock receptor.pdb ligand.pdb {SMALL} -o run");
    run(folder.path(), &dock);
    let directory = folder.path().join("run");
    for (script, word) in [("view.pml", "load "), ("view.cxc", "open ")] {
        let text = fs::read_to_string(directory.join(script)).unwrap();
        let loaded = text.lines().filter_map(|line| line.strip_prefix(word));
        let loaded: Vec<&str> = loaded
            .map(|rest| rest.split([',', ' ']).next().unwrap())
            .collect();
        assert_eq!(loaded.len(), 3, "{text}");
        assert!(loaded.iter().all(|file| directory.join(file).is_file()));
        let complex = fs::read_to_string(directory.join(loaded[0])).unwrap();
        let chains: BTreeSet<&str> = complex
            .lines()
            .filter(|line| line.starts_with("ATOM"))
            .map(|line| &line[21..22])
            .collect();
        for chain in chains {
            let named = [format!("chain \"{chain}\""), format!("#1/{chain}")];
            assert!(
                named.iter().any(|name| text.contains(name)),
                "{chain}: {text}"
            );
        }
    }
    run(
        folder.path(),
        &format!("{dock} --force --write-top 0").replace(" --write-top 3", ""),
    );
    assert!(!directory.join("view.pml").exists());
    assert!(!directory.join("top").exists());
}

/// Complexes as models of one file are those of single files, and go with the run.
#[test]
fn complexes_are_exported_as_models() {
    let folder = place();
    let dock = format!("dock receptor.pdb ligand.pdb {SMALL} -o run");
    run(folder.path(), &dock);
    run(folder.path(), "export run --rank 5,2-3 --format ensemble");
    run(folder.path(), "export run --rank 2-3,5 -o single");
    run(folder.path(), "export run --rank 2 --format cif -o single");
    let text = fs::read_to_string(folder.path().join("run/top/ensemble.pdb")).unwrap();
    let atoms = |text: &str| -> Vec<String> {
        let atoms = text.lines().filter(|line| line.starts_with("ATOM"));
        atoms.map(str::to_owned).collect()
    };
    let models: Vec<&str> = text.split("MODEL     ").skip(1).collect();
    assert_eq!(models.len(), 3);
    for (model, rank) in models.iter().zip([5, 2, 3]) {
        let single = fs::read_to_string(folder.path().join(format!("single/rank_000{rank}.pdb")));
        assert_eq!(atoms(model), atoms(&single.unwrap()), "rank {rank}");
    }
    let cif = fs::read_to_string(folder.path().join("single/rank_0002.cif")).unwrap();
    assert_eq!(atoms(&cif).len(), atoms(models[1]).len());
    // What was exported into the run is the run's, and goes when that is replaced.
    run(folder.path(), &format!("{dock} --force"));
    assert!(!folder.path().join("run/top/ensemble.pdb").exists());
}

/// If the table lists every pose, the best of each cluster can be exported alone.
#[test]
fn the_best_of_each_cluster_is_exported() {
    let folder = place();
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.pdb {SMALL} -o run"),
    );
    let table = rows(&folder.path().join("run"));
    let mut seen = BTreeSet::new();
    let firsts: Vec<u64> = table
        .iter()
        .filter(|row| seen.insert(row["cluster"].clone()))
        .map(|row| row["rank"].parse().unwrap())
        .collect();
    assert!(firsts.len() < table.len());
    let all = format!(
        "export run --rank 1-{} --best-of-cluster -o best --json",
        table.len()
    );
    let object: Value = serde_json::from_str(&run(folder.path(), &all)).unwrap();
    let files = object["files"].as_array().unwrap().iter();
    let ranks: Vec<u64> = files.map(|file| file["rank"].as_u64().unwrap()).collect();
    assert_eq!(ranks, firsts);
    // A format is chosen of those that there are.
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder.path())
        .args(["export", "run", "--rank", "1", "--format", "mol2"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
}
