//! Pseudo-atoms: records that mark places and are no atoms. They are dropped, and reported.
//!
//! - **Markers** are whole residues: membrane planes, pockets, shapes, frames. Their names are those of real
//!   ligands, too (MEM is meropenem, SHA salicylhydroxamic acid), so that a residue is a marker only if all its atoms
//!   have the names that the program gives them.
//! - **Sites without mass** are in molecules: lone pairs, mass centres, Drude particles, the fourth site of a water,
//!   virtual and centroid atoms. What has an element in its column is an atom, but for the names of a standard
//!   residue's own virtual atoms.

use std::collections::HashMap;

use crate::molecule::chemistry::{
    NameColumn, amino_acid_type, column_symbol, is_amino_acid, is_site_name, is_water, mass_center,
    resolve,
};
use crate::molecule::model::{Atom, ResidueKey, residue_key};
use crate::molecule::read::Record;
use crate::vector::squared_distance;

/// Markers: residue name and the names of its atoms, digits behind them aside.
const MARKERS: [(&str, &[&str]); 12] = [
    // Membrane planes of OPM and PPM; dummy atoms of others, and of the wwPDB.
    ("DUM", &["N", "O", "X", "DU", "DUM"]),
    // Membrane beads of LightDock.
    ("MMB", &["BJ"]),
    // Shape beads and the axes of tensors of HADDOCK.
    ("SHA", &["SHA"]),
    ("ANI", &["OO", "X", "Y", "Z"]),
    // Pseudoatoms of PyMOL.
    ("PSD", &["PS"]),
    // Membranes, embeddings and virtual residues of Rosetta.
    (
        "MEM",
        &["THKN", "CNTR", "NORM", "MPCT", "MPNM", "MPTK", "MPDP"],
    ),
    (
        "EMB",
        &["THKN", "CNTR", "NORM", "MPCT", "MPNM", "MPTK", "MPDP"],
    ),
    ("VRT", &["X", "Y", "Z", "ORIG", "VRT"]),
    ("VRT1", &["X", "Y", "Z", "ORIG", "VRT"]),
    // Alpha spheres of fpocket, points of P2Rank.
    ("STP", &["POL", "APOL", "H"]),
    // Pore spheres of HOLE, tunnels of CAVER.
    ("SPH", &["QSS", "QC"]),
    ("FIL", &["H"]),
];

/// Largest distance in Å of a Drude particle from its atom; a deuteron is twice as far.
const DRUDE: f64 = 0.5;

/// Which records are pseudo-atoms, and under what name they are counted: `known` has the names under which the tables
/// have each record's residue.
pub(crate) fn find(records: &[Record], known: &[&str]) -> Vec<Option<String>> {
    let all = records.iter().zip(known).zip(markers(records)).enumerate();
    all.map(|(index, ((Record { atom, .. }, known), is_marker))| {
        if is_marker {
            Some(atom.residue_name.clone())
        } else if is_drude(records, index) {
            Some("Drude particle".to_owned())
        } else {
            is_site(records, index, known).then(|| atom.name.clone())
        }
    })
    .collect()
}

/// Whether each record is of a residue that is a marker.
fn markers(records: &[Record]) -> Vec<bool> {
    let atoms = || records.iter().map(|record| &record.atom);
    let mut whole: HashMap<ResidueKey<'_>, bool> = HashMap::new();
    for atom in atoms() {
        let marker = MARKERS
            .iter()
            .find(|(residue, _)| *residue == atom.residue_name);
        if let Some((_, names)) = marker {
            let name = atom.name.to_ascii_uppercase();
            let is_named = names.contains(&name.trim_end_matches(|c: char| c.is_ascii_digit()));
            *whole.entry(residue_key(atom)).or_insert(true) &= is_named;
        }
    }
    let is_marker = |atom| whole.get(&residue_key(atom)) == Some(&true);
    atoms().map(is_marker).collect()
}

/// The atoms of a record's residue before and after it, without another residue between.
fn beside(records: &[Record], index: usize) -> impl Iterator<Item = &Atom> {
    let own = residue_key(&records[index].atom);
    let is_same = move |atom: &&Atom| residue_key(atom) == own;
    let (before, after) = records.split_at(index);
    let [before, after] = [before, after].map(|records| records.iter().map(|record| &record.atom));
    before
        .rev()
        .take_while(is_same)
        .chain(after.take_while(is_same))
}

/// Whether a record is the charged particle of CHARMM's Drude model, which is named after its atom (`DCA` beside `CA`).
fn is_drude(records: &[Record], index: usize) -> bool {
    let Atom { name, position, .. } = &records[index].atom;
    let atom = name.strip_prefix('D').filter(|atom| !atom.is_empty());
    atom.is_some_and(|atom| {
        let is_near = |other: &Atom| squared_distance(other.position, *position) < DRUDE * DRUDE;
        beside(records, index).any(|other| other.name == atom && is_near(other))
    })
}

/// Whether a record is a site without mass in a residue that the tables have as `known`.
fn is_site(records: &[Record], index: usize, known: &str) -> bool {
    let Atom {
        name,
        element: column,
        ..
    } = &records[index].atom;
    if is_water(known) {
        let name = name.trim_end_matches(|c: char| c.is_ascii_digit());
        return matches!(name, "M" | "MW" | "OM" | "EP" | "EPW" | "LP");
    }
    if is_amino_acid(known) {
        let is_nothing = || resolve(known, name, column, NameColumn::Unknown, false).is_none();
        return amino_acid_type(known, name).is_none()
            && (is_site_name(name, column) || is_nothing());
    }
    let is_mass_centre = || {
        mass_center(name).is_some_and(|heavy| {
            heavy.starts_with(['C', 'N']) && beside(records, index).any(|other| other.name == heavy)
        })
    };
    // PyMOL's pseudoatoms under another residue's name.
    let is_pymol = || column.eq_ignore_ascii_case("PS") && name.starts_with("PS");
    let is_pair = || name.starts_with("LP") || name.starts_with("EP");
    column_symbol(column).is_none() && (is_mass_centre() || is_pair() || is_pymol())
}
