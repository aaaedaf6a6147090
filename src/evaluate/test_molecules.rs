//! Hand-built molecules for the tests of this module.

use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{Atom, Format, Molecule};

const LETTERS: &str = "ACDEFGHIKLMNPQRSTVWY";
const NAMES: [&str; 20] = [
    "ALA", "CYS", "ASP", "GLU", "PHE", "GLY", "HIS", "ILE", "LYS", "LEU", "MET", "ASN", "PRO",
    "GLN", "ARG", "SER", "THR", "VAL", "TRP", "TYR",
];

pub(super) fn atom(
    chain: &str,
    number: i64,
    residue: &str,
    name: &str,
    position: [f64; 3],
) -> Atom {
    Atom {
        name: name.into(),
        residue_name: residue.into(),
        chain: chain.into(),
        residue_number: number,
        insertion_code: None,
        alternate_location: None,
        element: name.chars().take(1).collect(),
        position,
        occupancy: 1.0,
        b_factor: 0.0,
        hetero: false,
        radius: 1.7,
        line: 1,
    }
}

pub(super) fn molecule(atoms: Vec<Atom>) -> Molecule {
    Molecule::new(atoms, Format::Pdb)
}

pub(super) fn numbers(first: i64, count: usize) -> Vec<i64> {
    (first..).take(count).collect()
}

/// One-letter residues drawn by a linear congruential generator: the same for the same seed.
pub(super) fn random_sequence(seed: u64, length: usize) -> String {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    std::iter::repeat_with(|| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        LETTERS.as_bytes()[(state >> 33) as usize % LETTERS.len()] as char
    })
    .take(length)
    .collect()
}

/// A chain with the given numbers, wound as [`helix`] at the origin.
pub(super) fn chain_of(chain: &str, letters: &str, numbers: &[i64]) -> Vec<Atom> {
    let mut atoms = helix(chain, letters, [0.0; 3]);
    for atom in &mut atoms {
        atom.residue_number = numbers[atom.residue_number as usize - 1];
    }
    atoms
}

/// A helix along z that starts at `start`, residues numbered from 1: N, CA, C, O and a CB that points outwards. The
/// radius of the coil grows slowly so that no part of it fits another.
pub(super) fn helix(chain: &str, letters: &str, start: [f64; 3]) -> Vec<Atom> {
    let mut atoms = Vec::new();
    for (place, letter) in letters.chars().enumerate() {
        let residue = LETTERS.find(letter).map_or("UNK", |index| NAMES[index]);
        for (name, radius, turn, rise) in [
            ("N", 1.5, -0.5, -0.9),
            ("CA", 2.3, 0.0, 0.0),
            ("C", 1.7, 0.4, 1.1),
            ("O", 2.0, 0.5, 2.3),
            ("CB", 3.3, -0.1, -0.3),
        ] {
            let angle = 1.745 * place as f64 + turn;
            let radius = radius + 0.02 * place as f64;
            let position = [
                start[0] + radius * angle.cos(),
                start[1] + radius * angle.sin(),
                start[2] + 1.5 * place as f64 + rise,
            ];
            atoms.push(atom(chain, place as i64 + 1, residue, name, position));
        }
    }
    atoms
}

pub(super) fn moved(atoms: &[Atom], pose: &Pose) -> Vec<Atom> {
    atoms
        .iter()
        .map(|atom| Atom {
            position: pose.apply(atom.position),
            ..atom.clone()
        })
        .collect()
}

pub(super) fn renamed(atoms: &[Atom], chain: &str) -> Vec<Atom> {
    atoms
        .iter()
        .map(|atom| Atom {
            chain: chain.into(),
            ..atom.clone()
        })
        .collect()
}

pub(super) fn renumbered(atoms: &[Atom], shift: i64) -> Vec<Atom> {
    atoms
        .iter()
        .map(|atom| Atom {
            residue_number: atom.residue_number + shift,
            ..atom.clone()
        })
        .collect()
}

/// Eleven base pairs about the z axis as two strands, numbers 1 to 11 and 12 to 22; backbone atoms only.
pub(super) fn duplex(names: [&str; 2]) -> [Vec<Atom>; 2] {
    let (letters, complements) = ("GCATTACGGAC", "CGTAATGCCTG");
    let strand = |name: &str, letters: &str, first: i64| -> Vec<Atom> {
        let mut atoms = Vec::new();
        for (place, letter) in letters.chars().enumerate() {
            for (own, radius, ahead, rise) in [
                ("P", 8.9, 0.0, 0.0),
                ("O5'", 8.5, 0.15, 0.5),
                ("C3'", 8.2, 0.4, 1.3),
                ("C1'", 5.8, 0.35, 0.7),
                ("O3'", 8.8, 0.47, 2.3),
            ] {
                let angle = 0.628 * place as f64 + ahead;
                let z = 3.4 * place as f64 + rise;
                let position = [radius * f64::cos(angle), radius * f64::sin(angle), z];
                let number = first + place as i64;
                let residue = format!("D{letter}");
                atoms.push(atom(name, number, &residue, own, position));
            }
        }
        atoms
    };
    let reversed: String = complements.chars().rev().collect();
    // The second strand is the first's image by half a turn across the axis.
    let across = Pose::from_parts([0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 36.0]);
    [
        strand(names[0], letters, 1),
        moved(&strand(names[1], &reversed, 12), &across),
    ]
}
