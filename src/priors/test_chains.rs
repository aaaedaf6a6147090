//! Chains of a given sequence for tests.

use knotdock_structures::molecule::{Atom, one_letter};

/// The atoms of such `names` of each residue of a chain, numbered from `first`, all of a residue where `position` puts
/// its number; X is a residue of an unknown name.
pub fn chain(
    chain: &str,
    sequence: &str,
    first: i64,
    names: &[&str],
    position: impl Fn(i64) -> [f64; 3],
) -> Vec<Atom> {
    const RESIDUES: [&str; 20] = [
        "ALA", "ARG", "ASN", "ASP", "CYX", "GLN", "GLU", "GLY", "HIE", "ILE", "LEU", "LYS", "MSE",
        "PHE", "PRO", "SER", "THR", "TRP", "TYR", "VAL",
    ];
    let atom = |number: i64, one: char, name: &str| Atom {
        name: name.to_owned(),
        residue_name: RESIDUES
            .iter()
            .find(|name| one_letter(name) == one)
            .map_or("XYZ", |name| name)
            .to_string(),
        chain: chain.to_owned(),
        residue_number: number,
        insertion_code: None,
        alternate_location: None,
        element: "C".to_owned(),
        position: position(number),
        occupancy: 1.0,
        b_factor: 0.0,
        hetero: false,
        radius: 1.9,
        line: 1,
    };
    let mut atoms = Vec::new();
    for (number, one) in (first..).zip(sequence.chars()) {
        atoms.extend(names.iter().map(|name| atom(number, one, name)));
    }
    atoms
}
