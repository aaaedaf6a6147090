//! Residues that are left out by their name, ligands that are warned of, and chains that are docked against
//! themselves: through every command.

use crate::molecules;
use std::fs;
use std::path::Path;

use crate::program::succeed;
use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::{Value, json};

/// An inhibitor of six atoms, far from the receptor.
fn inhibitor() -> String {
    let atom = |place: usize| {
        format!(
            "HETATM  90{place}  C{place}  XK2 A 900    {:>8.3}  30.000  30.000  1.00 10.00           C\n",
            1.4 * place as f64
        )
    };
    (1..=6).map(atom).collect()
}

fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let receptor = molecules::receptor();
    let both = receptor.replace("END\n", "") + &inhibitor() + "END\n";
    let native = receptor.replace("END\n", "") + &molecules::ligand().replace(" ALA A", " ALA C");
    let (enzyme, peptide) = (named(&receptor, 5), named(&molecules::ligand(), 3));
    let complex = enzyme.replace("END\n", "") + &in_chain_c(&peptide);
    for (name, text) in [
        ("enzyme.pdb", enzyme),
        ("peptide.pdb", peptide),
        ("complex.pdb", complex),
        ("receptor.pdb", receptor),
        ("inhibited.pdb", both),
        ("ligand.pdb", molecules::ligand()),
        ("native.pdb", native),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// The same atoms with residues of several names, in an order that `step` decides.
fn named(text: &str, step: usize) -> String {
    let names = ["SER", "VAL", "LEU", "ALA", "LYS", "GLU", "THR"];
    let lines = text.lines().map(|line| match line.get(22..26) {
        Some(number) => {
            let number: usize = number.trim().parse().unwrap();
            line.replace(
                " ALA ",
                &format!(" {} ", names[(step * number) % names.len()]),
            )
        }
        None => line.to_owned(),
    });
    lines.map(|line| line + "\n").collect()
}

/// Atoms of chain A under another name.
fn in_chain_c(text: &str) -> String {
    let lines = text.lines().map(|line| match line.get(21..22) {
        Some("A") => format!("{}C{}\n", &line[..21], &line[22..]),
        _ => format!("{line}\n"),
    });
    lines.collect()
}

fn run_json(folder: &Path, run: &str) -> Value {
    serde_json::from_slice(&fs::read(folder.join(run).join("run.json")).unwrap()).unwrap()
}

fn refused(folder: &Path, command: &str) -> Value {
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args(command.split_whitespace())
        .arg("--json")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{command}");
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    object["error"].clone()
}

#[test]
fn a_dropped_residue_is_recorded_and_followed() {
    let folder = place();
    let folder = folder.path();
    let run = |arguments: &str| succeed(folder, arguments.split_whitespace());
    let options = "--rotations 20 --write-top 1 --quiet";
    run(&format!("dock receptor.pdb ligand.pdb -o plain {options}"));
    run(&format!(
        "dock inhibited.pdb ligand.pdb --drop-residue XK2 --native native.pdb -o run {options}"
    ));
    let first = run_json(folder, "run");
    assert_eq!(first["options"]["input"]["drop_residue"], json!(["XK2"]));
    assert_eq!(
        first["inputs"]["receptor"]["report"]["dropped"],
        json!([{"kind": "residue", "atoms": 6, "names": {"XK2": 6}}])
    );
    let poses = |name: &str| fs::read_to_string(folder.join(name).join("poses.csv")).unwrap();
    let rows = |text: &str| -> Vec<String> {
        // Ahead of the columns of quality.
        let cut = |line: &str| line.split(',').take(9).collect::<Vec<_>>().join(",");
        text.lines().map(cut).collect()
    };
    assert_eq!(rows(&poses("run")), rows(&poses("plain")));
    run("dock --rerun run/run.json -o again --quiet");
    assert_eq!(poses("run"), poses("again"));
    run("export run --rank 1 -o out --quiet");
    let complex = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    assert_eq!(
        complex("run/top/rank_0001.pdb"),
        complex("out/rank_0001.pdb")
    );
    assert!(!complex("out/rank_0001.pdb").contains("XK2"));
    run("evaluate run --native native.pdb --quiet");
    run("score inhibited.pdb ligand.pdb --drop-residue XK2 --pose 1,0,0,0,0,0,0 --quiet");

    fs::write(
        folder.join("pairs.csv"),
        "receptor,ligand,drop_residue\ninhibited.pdb,ligand.pdb,XK2\n",
    )
    .unwrap();
    run("batch pairs.csv -o batch -- --rotations 20 --write-top 0");
    let pair = run_json(folder, "batch/inhibited_ligand");
    assert_eq!(pair["options"]["input"]["drop_residue"], json!(["XK2"]));
}

#[test]
fn names_that_no_residue_has_are_refused() {
    let folder = place();
    let folder = folder.path();
    for command in [
        "dock inhibited.pdb ligand.pdb --drop-residue XK2,HEM",
        "inspect inhibited.pdb --drop-residue HEM",
        "score inhibited.pdb ligand.pdb --pose 1,0,0,0,0,0,0 --drop-residue HEM",
    ] {
        let error = refused(folder, command);
        let message = error["message"].as_str().unwrap();
        assert!(message.contains("--drop-residue names HEM"), "{message}");
    }
    let error = refused(folder, "inspect inhibited.pdb --drop-residue HEM");
    assert!(error["remedy"].as_str().unwrap().contains("XK2"));
    refused(folder, "inspect inhibited.pdb --drop-residue XK2,");
}

#[test]
fn a_kept_ligand_is_warned_of() {
    let folder = place();
    let output = succeed(folder.path(), ["inspect", "inhibited.pdb"]);
    let reported = String::from_utf8(output.stdout).unwrap();
    let warnings: Vec<&str> = reported
        .lines()
        .filter(|line| line.contains("XK2 (6"))
        .collect();
    assert_eq!(warnings.len(), 1, "{reported}");
    assert!(
        warnings[0].contains("--hetatm drop or --drop-residue XK2"),
        "{reported}"
    );
}

/// Found by a user: docked against the file of its complex, a chain was docked beside itself, without a word.
#[test]
fn a_chain_that_the_other_file_holds_is_warned_of() {
    let folder = place();
    let folder = folder.path();
    let warnings = |side: &str, arguments: &str| {
        let run = format!("dock {arguments} --rotations 20 --write-top 0 -o run --force --quiet");
        succeed(folder, run.split_whitespace());
        run_json(folder, "run")["inputs"][side]["report"]["warnings"].clone()
    };
    for (side, arguments, remedy) in [
        ("receptor", "complex.pdb peptide.pdb", "complex.pdb:A,B"),
        ("receptor", "complex.pdb complex.pdb:C", "complex.pdb:A,B"),
        ("ligand", "enzyme.pdb complex.pdb", "complex.pdb:C"),
    ] {
        let reported = warnings(side, arguments).to_string();
        assert!(
            reported.contains("already") && reported.contains(remedy),
            "{reported}"
        );
    }
    for arguments in ["complex.pdb:A,B complex.pdb:C", "complex.pdb complex.pdb"] {
        let reported = warnings("receptor", arguments).to_string();
        assert!(!reported.contains("already"), "{reported}");
    }
}
