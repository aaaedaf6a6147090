//! Complex files of several models, and natives of several interfaces, through `evaluate` and `interface`.

use std::fs;
use std::path::Path;

use crate::program::succeed;
use serde_json::{Value, json};

/// Records of an example, all of the chain given, moved along x.
fn atoms(name: &str, chain: char, shift: f64) -> String {
    let file = format!("structures/examples/1ppe_{name}.pdb");
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(file);
    let text = fs::read_to_string(path).unwrap();
    let records = text.lines().filter(|line| line.starts_with("ATOM"));
    let moved = |line: &str| {
        let x: f64 = line[30..38].trim().parse().unwrap();
        let (head, tail) = (&line[22..30], &line[38..]);
        format!("{}{chain}{head}{:8.3}{tail}\n", &line[..21], x + shift)
    };
    records.map(moved).collect()
}

/// A folder with these files.
fn place(files: &[(&str, String)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn said(folder: &Path, command: &str) -> (Value, String) {
    let output = succeed(folder, command.split_whitespace().chain(["--json"]));
    (
        serde_json::from_slice(&output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

/// Trypsin and its inhibitor as two models, the first 9 Å apart.
fn models() -> String {
    let trypsin = atoms("receptor_bound", 'A', 0.0);
    let [apart, native] = [-9.0, 0.0].map(|x| atoms("ligand_bound", 'B', x));
    format!(
        "MODEL        1\n{trypsin}{apart}ENDMDL\nMODEL        2\n{trypsin}{native}ENDMDL\nEND\n"
    )
}

fn native() -> String {
    atoms("receptor_bound", 'A', 0.0) + &atoms("ligand_bound", 'B', 0.0)
}

/// Found with sets of CAPRI and HADDOCK, whose files hold ten models: the first one alone was measured, without a word.
#[test]
fn every_model_of_a_file_has_a_row() {
    let folder = place(&[("models.pdb", models()), ("native.pdb", native())]);
    let evaluate = "evaluate models.pdb A B --native native.pdb";
    let (found, _) = said(folder.path(), evaluate);
    let rows = found["complexes"].as_array().unwrap();
    let of = |row: &Value, name: &str| row[name].as_f64().unwrap();
    assert_eq!(
        [&rows[0]["model"], &rows[1]["model"]],
        [&json!(1), &json!(2)]
    );
    assert!(of(&rows[0], "dockq") < 0.5 && of(&rows[0], "lrmsd") > 8.9);
    assert!((of(&rows[1], "dockq") - 1.0).abs() < 1e-9);
    let (one, _) = said(folder.path(), &format!("{evaluate} --model 2"));
    assert_eq!(one["complexes"].as_array().unwrap()[..], rows[1..]);
    let interface = "interface models.pdb A B --contacts contacts.csv";
    let (found, _) = said(folder.path(), interface);
    let rows = found["complexes"].as_array().unwrap();
    assert_eq!(
        [&rows[0]["model"], &rows[1]["model"]],
        [&json!(1), &json!(2)]
    );
    assert!(rows[0]["contacts"].as_u64() < rows[1]["contacts"].as_u64());
    let table = fs::read_to_string(folder.path().join("contacts.csv")).unwrap();
    assert!(table.starts_with("file,model,") && table.contains("models.pdb,2,A,"));
}

/// Words of the reader are shown, once for all models.
#[test]
fn warnings_of_the_reader_are_shown() {
    let displaced = models().replacen("ATOM      1 ", "ATOM     1 ", 1);
    let folder = place(&[("models.pdb", displaced), ("native.pdb", models())]);
    let (_, words) = said(folder.path(), "evaluate models.pdb A B --native native.pdb");
    assert!(
        words.contains("models.pdb: 1 atom record out of the columns"),
        "{words}"
    );
    assert!(
        words.contains("MODEL 2 of the native's file was not read"),
        "{words}"
    );
}

/// The complexes that `export --format ensemble` writes are measured as the poses of their run.
#[test]
fn an_exported_ensemble_is_measured() {
    let folder = place(&[
        ("receptor.pdb", atoms("receptor_unbound", 'A', 0.0)),
        ("ligand.pdb", atoms("ligand_unbound", 'B', 0.0)),
        ("native.pdb", native()),
    ]);
    for command in [
        "dock receptor.pdb ligand.pdb --native native.pdb --rotations 20 --write-top 0 -o run --quiet",
        "export run --rank 1-3 --raw --format ensemble -o out",
    ] {
        succeed(folder.path(), command.split_whitespace());
    }
    let (found, _) = said(
        folder.path(),
        "evaluate out/ensemble.pdb --native native.pdb",
    );
    let rows = crate::dock_run::run::rows(&folder.path().join("run"));
    let complexes = found["complexes"].as_array().unwrap();
    assert_eq!(complexes.len(), 3);
    for (complex, row) in complexes.iter().zip(rows) {
        let expected: f64 = row["lrmsd"].parse().unwrap();
        assert!((complex["lrmsd"].as_f64().unwrap() - expected).abs() < 0.02);
    }
}

/// Found with a native of two copies of an inhibitor, at the site and elsewhere: a model of the second interface was
/// measured against the first.
#[test]
fn a_model_is_measured_against_the_interface_that_it_is_a_model_of() {
    // The second copy lies on the other side of the enzyme.
    let trypsin = atoms("receptor_bound", 'A', 0.0);
    let [first, second] =
        [('B', 0.0), ('C', SECOND)].map(|(chain, x)| atoms("ligand_bound", chain, x));
    let folder = place(&[
        (
            "native.pdb",
            [trypsin.clone(), first.clone(), second.clone()].concat(),
        ),
        ("model.pdb", [trypsin.clone(), second].concat()),
        ("other.pdb", [trypsin, first].concat()),
    ]);
    let row = |command: &str| {
        let (found, words) = said(
            folder.path(),
            &format!("evaluate {command} --native native.pdb"),
        );
        (found["complexes"][0].clone(), words)
    };
    for (command, chains) in [
        ("model.pdb A C", "A:A,C:C"),
        ("native.pdb A C", "A:A,C:C"),
        ("native.pdb A B", "A:A,B:B"),
        ("other.pdb A B", "A:A,B:B"),
    ] {
        let (found, words) = row(command);
        assert_eq!(found["native_chains"], chains, "{command}");
        assert!(
            (found["dockq"].as_f64().unwrap() - 1.0).abs() < 1e-9,
            "{found}"
        );
        assert!(words.contains("the native holds 2 complexes"), "{words}");
    }
    // A mapping that is named wins.
    let (found, _) = row("model.pdb A C --map C:B");
    assert_eq!(found["native_chains"], "A:A,C:B");
    assert!(found["dockq"].as_f64().unwrap() < 0.3, "{found}");
    let unknown = "evaluate model.pdb A C --native native.pdb --map C:X";
    crate::program::refused(folder.path(), unknown.split_whitespace());
}

/// Shift in Å along x that takes the inhibitor through the enzyme to its other side.
const SECOND: f64 = 40.0;

/// Found with a domain motion of 17 Å: the docking stopped before it began.
#[test]
fn a_native_that_does_not_fit_costs_no_docking() {
    let halves = |shift: f64| -> String {
        let moved = atoms("receptor_unbound", 'A', shift);
        let plain = atoms("receptor_unbound", 'A', 0.0);
        let lines = plain.lines().zip(moved.lines());
        let line = |(plain, moved): (&str, &str)| {
            let number: i64 = plain[22..26].trim().parse().unwrap();
            format!("{}\n", if number > 124 { moved } else { plain })
        };
        lines.map(line).collect()
    };
    let folder = place(&[
        ("receptor.pdb", halves(0.0)),
        ("ligand.pdb", atoms("ligand_unbound", 'B', 0.0)),
        (
            "domains.pdb",
            halves(40.0) + &atoms("ligand_bound", 'B', 40.0),
        ),
        ("stranger.pdb", atoms("ligand_bound", 'A', 0.0)),
    ]);
    let dock = |native: &str| {
        let command = format!(
            "dock receptor.pdb ligand.pdb --native {native} --rotations 20 --write-top 0 -o {native}.run"
        );
        let (found, words) = said(folder.path(), &command);
        (found["run"]["match"].clone(), words)
    };
    let (found, words) = dock("domains.pdb");
    assert!(
        found["receptor"]["backbone_rmsd"].as_f64().unwrap() > 15.0,
        "{found}"
    );
    assert!(words.contains("does not fit the native"), "{words}");
    for row in crate::dock_run::run::rows(&folder.path().join("domains.pdb.run")) {
        assert_eq!(row["capri"], "incorrect");
    }
    let (found, words) = dock("stranger.pdb");
    assert!(
        found["error"].as_str().unwrap().contains("no chain"),
        "{found}"
    );
    assert!(words.contains("no pose is measured"), "{words}");
    for row in crate::dock_run::run::rows(&folder.path().join("stranger.pdb.run")) {
        assert_eq!((row["capri"].as_str(), row["dockq"].as_str()), ("", ""));
    }
}
