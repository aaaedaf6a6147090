//! Standard residues under other names: their atoms decide charges, contact types and radii.

#![cfg(feature = "molecule")]

use crate::pdb_text::read_text;
use knotdock_structures::molecule::{Labels, Molecule, OtherName};

/// The inhibitor of 1PPE: 29 residues, 221 atoms, a charge of -1.
fn example() -> String {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/1ppe_ligand_unbound.pdb"
    );
    let text = std::fs::read_to_string(file).unwrap();
    let atoms = text.lines().filter(|line| line.starts_with("ATOM"));
    atoms.map(|line| format!("{line}\n")).collect()
}

/// The example with its residues renamed, by name and number.
fn renamed(new: impl Fn(&str, i64) -> String) -> String {
    let lines = example();
    let lines = lines.lines().map(|line| {
        let number = line[22..26].trim().parse().unwrap();
        let name = new(&line[17..20], number);
        format!("{}{name:<4}{}\n", &line[..17], &line[21..])
    });
    lines.collect()
}

fn labels(molecule: &Molecule) -> Labels {
    molecule.labels(7.0)
}

fn radii(molecule: &Molecule) -> Vec<f64> {
    molecule.atoms.iter().map(|atom| atom.radius).collect()
}

fn names(molecule: &Molecule) -> Vec<(&str, &str, usize)> {
    let others = molecule.report.other_names.iter();
    others
        .map(
            |OtherName {
                 name,
                 read_as,
                 residues,
             }| (name.as_str(), read_as.as_str(), *residues),
        )
        .collect()
}

/// D-amino acids of the wwPDB, and L-amino acids under names that nobody knows.
fn dextro(name: &str) -> &str {
    match name {
        "ALA" => "DAL",
        "ARG" => "DAR",
        "ASP" => "DAS",
        "CYS" => "DCY",
        "GLU" => "DGL",
        "HIS" => "DHI",
        "ILE" => "DIL",
        "LEU" => "DLE",
        "LYS" => "DLY",
        "PRO" => "DPR",
        "SER" => "DSN",
        "TYR" => "DTY",
        "VAL" => "DVA",
        other => other,
    }
}

/// Found by users: names outside the tables lost charges, contact types and rescoring, and with them a docking (DockQ
/// of the first rank from 0.63 to 0.15) by renaming alone.
#[test]
fn renaming_changes_nothing() {
    let plain = read_text(&example()).unwrap();
    assert_eq!(labels(&plain).report.typed_atoms, 221);
    let unknown = |name: &str, _: i64| format!("X{}", &name[..2]);
    let mirrored = |name: &str, _: i64| dextro(name).to_owned();
    let ends = |name: &str, number: i64| match number {
        1 => format!("N{name}"),
        29 => format!("C{name}"),
        _ => name.to_owned(),
    };
    for text in [renamed(unknown), renamed(mirrored), renamed(ends)] {
        let molecule = read_text(&text).unwrap();
        assert_eq!(labels(&molecule), labels(&plain));
        assert_eq!(radii(&molecule), radii(&plain));
        assert!(molecule.report.groups.is_empty());
        assert!(!molecule.report.other_names.is_empty());
    }
    let molecule = read_text(&renamed(ends)).unwrap();
    assert_eq!(names(&molecule), [("CGLY", "GLY", 1), ("NARG", "ARG", 1)]);
    // What is written keeps the file's names.
    assert_eq!(molecule.atoms[0].residue_name, "NARG");
}

#[test]
fn force_fields_names_say_the_state() {
    let plain = read_text(&example()).unwrap();
    let gromos = |acid: &'static str| {
        move |name: &str, _: i64| match name {
            "CYS" => "CYS2".to_owned(),
            "HIS" => "HISB".to_owned(),
            "LYS" => "LYSH".to_owned(),
            "GLU" => acid.to_owned(),
            other => other.to_owned(),
        }
    };
    let molecule = read_text(&renamed(gromos("GLU"))).unwrap();
    let (found, expected) = (labels(&molecule), labels(&plain));
    assert_eq!(found.contact_types, expected.contact_types);
    assert_eq!(found.atom_kinds, expected.atom_kinds);
    assert_eq!(found.report.net_charge, -1.0);
    let read = [("CYS2", "CYX", 6), ("HISB", "HIE", 1), ("LYSH", "LYS", 2)];
    assert_eq!(names(&molecule), read);
    // Three glutamates with their proton.
    let molecule = read_text(&renamed(gromos("GLUH"))).unwrap();
    assert_eq!(labels(&molecule).report.net_charge, 2.0);
}

/// Without an element column and with names at the left edge, CA would be calcium and HG mercury.
#[test]
fn elements_follow_from_what_a_residue_is() {
    let text: String = renamed(|name, _| dextro(name).to_owned())
        .lines()
        .map(|line| {
            format!(
                "{}{:<4}{}\n",
                &line[..12],
                line[12..16].trim(),
                &line[16..66]
            )
        })
        .collect();
    let hydrogen =
        "ATOM    900 HG   DSN B  22      10.000  10.000  10.000  1.00 10.00\n".to_owned();
    let molecule = read_text(&(text + &hydrogen)).unwrap();
    let elements = |molecule: &Molecule| -> Vec<String> {
        let atoms = molecule.atoms.iter();
        atoms.map(|atom| atom.element.clone()).collect()
    };
    let plain = read_text(&example()).unwrap();
    assert_eq!(elements(&molecule), elements(&plain));
}

/// A modified residue has an atom more, and its parent's name does not fit it.
#[test]
fn modified_residues_stay_what_they_are() {
    let text = renamed(|name, _| {
        if name == "SER" {
            "XSE".to_owned()
        } else {
            name.to_owned()
        }
    });
    let phosphorus =
        "ATOM    900  P   XSE B  NN      10.000  10.000  10.000  1.00 10.00           P\n";
    let serine = text.lines().find(|line| line[17..20] == *"XSE").unwrap();
    let number = &serine[22..26];
    let molecule = read_text(&(text.clone() + &phosphorus.replace("  NN", number))).unwrap();
    assert!(molecule.report.other_names.is_empty());
    assert_eq!(labels(&molecule).report.unknown_types.get("XSE"), Some(&1));
    // Less of the side chain is no standard residue, either, but where the name says so.
    for (name, known) in [("XTY", 0), ("CTYR", 1)] {
        let text = renamed(|old, _| {
            if old == "TYR" {
                name.to_owned()
            } else {
                old.to_owned()
            }
        });
        let cut: String = text
            .lines()
            .filter(|line| !(line[17..21] == *format!("{name:<4}") && line[12..16].trim() == "CZ"))
            .map(|line| format!("{line}\n"))
            .collect();
        assert_eq!(read_text(&cut).unwrap().report.other_names.len(), known);
    }
}
