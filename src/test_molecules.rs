//! Two small molecules for the tests of restraints and predictions.

use knotdock_structures::molecule::{Atom, Format, Molecule};

/// A receptor of chains A (10 LYS, 11 ALA, 52 GLY, 52A GLY), D (-3 ALA) and S (1 ALA), and a ligand of chains B
/// (20 LYS, 21 ALA), `b` (20 GLY), S (1 ALA) and one without a name (7 ALA).
pub(crate) fn molecules() -> [Molecule; 2] {
    let receptor = [
        (
            "A",
            10,
            None,
            "LYS",
            &["N", "CA", "C", "CB", "H"] as &[&str],
        ),
        ("A", 11, None, "ALA", &["N", "CA", "C", "CB"]),
        ("A", 52, None, "GLY", &["N", "CA", "C"]),
        ("A", 52, Some('A'), "GLY", &["N", "CA", "C"]),
        ("D", -3, None, "ALA", &["CA", "CB"]),
        ("S", 1, None, "ALA", &["CA"]),
    ];
    let ligand = [
        (
            "B",
            20,
            None,
            "LYS",
            &["N", "CA", "C", "CB", "H"] as &[&str],
        ),
        ("B", 21, None, "ALA", &["N", "CA", "CB"]),
        ("b", 20, None, "GLY", &["CA", "O5'"]),
        ("S", 1, None, "ALA", &["CA"]),
        ("", 7, None, "ALA", &["CA"]),
    ];
    [molecule(&receptor), molecule(&ligand)]
}

type Residue = (
    &'static str,
    i64,
    Option<char>,
    &'static str,
    &'static [&'static str],
);

fn molecule(residues: &[Residue]) -> Molecule {
    let atoms = residues
        .iter()
        .flat_map(|&(chain, number, insertion, residue, names)| {
            names.iter().map(move |&name| Atom {
                name: name.to_owned(),
                residue_name: residue.to_owned(),
                chain: chain.to_owned(),
                residue_number: number,
                insertion_code: insertion,
                alternate_location: None,
                element: name.chars().take(1).collect(),
                position: [0.0; 3],
                occupancy: 1.0,
                b_factor: 0.0,
                hetero: false,
                radius: 1.9,
                line: 1,
            })
        });
    Molecule::new(atoms.collect(), Format::Pdb)
}
