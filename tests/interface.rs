//! `knotdock interface`: contacts by going through all pairs, surface and score beside `knotdock score`, and complexes of
//! a run beside its table.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

use crate::dock_run::run::{number, rows, run};
use crate::program::refused;

fn example(name: &str) -> String {
    let file = format!("structures/examples/1ppe_{name}_bound.pdb");
    fs::read_to_string(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(file)).unwrap()
}

/// A folder with the known complex, whole and as two files.
fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (atoms("receptor", 'E'), atoms("ligand", 'I'));
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("receptor.pdb", &receptor);
    write("ligand.pdb", &ligand);
    write("complex.pdb", &(receptor + &ligand));
    folder
}

/// The atoms of a side under a chain.
fn atoms(name: &str, chain: char) -> String {
    let text = example(name);
    let records = text.lines().filter(|line| line.starts_with("ATOM"));
    records
        .map(|line| format!("{}{chain}{}\n", &line[..21], &line[22..]))
        .collect()
}

fn described(folder: &Path, words: &str) -> Value {
    let text = run(folder, &format!("interface {words} --json"));
    serde_json::from_str::<Value>(&text).unwrap()["complexes"].take()
}

#[test]
fn contacts_are_those_of_all_pairs() {
    let folder = place();
    let found = described(folder.path(), "complex.pdb");
    let places = |name: &str| -> Vec<(String, [f64; 3])> {
        let text = atoms(name, 'X');
        let heavy = text.lines().filter(|line| line[76..78].trim() != "H");
        let number = |line: &str, at: usize| line[at..at + 8].trim().parse().unwrap();
        heavy
            .map(|line| {
                (
                    line[22..27].trim().to_owned(),
                    [30, 38, 46].map(|at| number(line, at)),
                )
            })
            .collect()
    };
    let (receptor, ligand) = (places("receptor"), places("ligand"));
    let mut expected = BTreeSet::new();
    for (a, x) in &receptor {
        for (b, y) in &ligand {
            if (0..3).map(|k| (x[k] - y[k]).powi(2)).sum::<f64>() <= 25.0 {
                expected.insert((a.as_str(), b.as_str()));
            }
        }
    }
    let pairs = found[0]["pairs"].as_array().unwrap();
    let of = |pair: &'_ Value, side: usize| {
        pair["residues"][side]["number"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    let listed: BTreeSet<(String, String)> = pairs
        .iter()
        .map(|pair| (of(pair, 0), of(pair, 1)))
        .collect();
    assert_eq!(listed.len(), pairs.len());
    assert!(
        expected
            .iter()
            .all(|(a, b)| listed.contains(&((*a).to_owned(), (*b).to_owned())))
    );
    assert_eq!(listed.len(), expected.len());
    // ARG 5 of the inhibitor lies in the specificity pocket, on ASP 189.
    let bridge = pairs
        .iter()
        .find(|pair| of(pair, 0) == "189" && of(pair, 1) == "5")
        .unwrap();
    assert_eq!(bridge["salt_bridge"], true);
    assert!(found[0]["hydrogen_bonds"].as_u64().unwrap() >= 5);
}

/// Surface and terms are those of `knotdock score` where the molecules stand, whichever way the sides are named.
#[test]
fn surface_and_score_are_those_of_the_pose_in_place() {
    let folder = place();
    let scored = run(
        folder.path(),
        "score receptor.pdb ligand.pdb --pose 1,0,0,0,0,0,0 --config kernel.resolution=16 --json",
    );
    let scored: Value = serde_json::from_str(&scored).unwrap();
    for words in ["complex.pdb", "complex.pdb E I"] {
        let words = format!("{words} --config kernel.resolution=16");
        let found = &described(folder.path(), &words)[0];
        let close = |name: &str, expected: &Value| {
            let (a, b) = (found[name].as_f64().unwrap(), expected.as_f64().unwrap());
            assert!((a - b).abs() <= 1e-9 * b.abs(), "{name}: {a} {b}");
        };
        close("buried_area", &scored["geometry"]["buried_area"]);
        close("pose_score", &scored["pose_score"]);
        close("search_score", &scored["exact"]);
        for term in ["shape", "contact", "electrostatics"] {
            close(term, &scored["terms"][term]);
        }
        close("atom_pair", &scored["atom_pair"]);
    }
}

/// Complexes of a run name their sides, and score what the table says, but for the third decimal of coordinates.
#[test]
fn complexes_of_a_run_score_as_its_rows() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 120 --poses 100 --write-top 3 --raw --sharp off -o run --quiet",
    );
    let table = rows(&folder.path().join("run"));
    let words = "run/top/rank_0001.pdb run/top/rank_0002.pdb run/top/rank_0003.pdb -o all.csv --contacts pairs.csv";
    let found = described(folder.path(), words);
    for (row, found) in table.iter().zip(found.as_array().unwrap()) {
        let (expected, score) = (
            number(row, "pose_score"),
            found["pose_score"].as_f64().unwrap(),
        );
        assert!(
            (score - expected).abs() < 0.02 * expected.abs(),
            "{score} {expected}"
        );
    }
    let mut reader = csv::Reader::from_path(folder.path().join("all.csv")).unwrap();
    assert_eq!(reader.records().count(), 3);
    let mut reader = csv::Reader::from_path(folder.path().join("pairs.csv")).unwrap();
    let pairs = reader.records().map(Result::unwrap);
    let contacts: u64 = (0..3)
        .map(|at| found[at]["contacts"].as_u64().unwrap())
        .sum();
    assert_eq!(pairs.count() as u64, contacts);
}

/// What cannot be described is refused with a remedy; of many files the others are.
#[test]
fn what_is_no_complex_is_refused() {
    let folder = place();
    let three = atoms("receptor", 'E') + &atoms("ligand", 'I') + &atoms("ligand", 'J');
    fs::write(folder.path().join("three.pdb"), three).unwrap();
    for (words, said) in [
        ("three.pdb", "the file has E, I, J"),
        ("receptor.pdb", "the file has one chain, E"),
        ("complex.pdb E", "chains of one side"),
        ("complex.pdb E Z", "Z"),
        ("none.pdb", "no such file"),
        ("three.pdb I J E", "chains of 3 sides"),
        ("complex.pdb -o complex.pdb", "one of the input files"),
    ] {
        let words = format!("interface {words}");
        let error = refused(folder.path(), words.split(' '));
        let message = error["message"].as_str().unwrap();
        assert!(message.contains(said), "{words}: {message}");
    }
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder.path())
        .args(["interface", "receptor.pdb", "complex.pdb", "--json"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["complexes"].as_array().unwrap().len(), 1);
}
