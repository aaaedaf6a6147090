//! Pseudo-atoms: records that mark places and are no atoms. They are dropped, and reported.
//!
//! - **Markers** are residues of their own: membrane planes, pockets, shapes, frames. Their names are those of real
//!   ligands, too (MEM is meropenem, SHA salicylhydroxamic acid), so that a residue is a marker only if all its atoms
//!   have the names that the program gives them.
//! - **Sites without mass** stand in molecules: lone pairs, mass centres, Drude particles, the fourth site of a water,
//!   virtual and centroid atoms. What has an element in its column is an atom, but for the names of a standard
//!   residue's own virtual atoms.

use crate::molecule::chemistry::elements;
use crate::molecule::chemistry::elements::{NameColumn, column_symbol};
use crate::molecule::chemistry::residues::{amino_acid_type, is_amino_acid, is_water};
use crate::molecule::chemistry::site_names::{is_site_name, mass_center};
use crate::molecule::model::atom::squared_distance;
use crate::molecule::read::parse::Parsed;
use std::collections::HashMap;

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

/// Atoms of one residue: chain, number, insertion code and name.
type Key<'a> = (&'a str, i64, Option<char>, &'a str);

fn key(record: &Parsed) -> Key<'_> {
    let raw = &record.raw;
    (
        &raw.chain,
        raw.residue_number,
        raw.insertion_code,
        &raw.residue_name,
    )
}

/// Which records are pseudo-atoms, and under what name they are counted: `known` has the names under which the tables
/// have each record's residue.
pub(crate) fn find(parsed: &[Parsed], known: &[&str]) -> Vec<Option<String>> {
    let markers = markers(parsed);
    let all = parsed.iter().zip(known).zip(markers).enumerate();
    all.map(|(index, ((record, known), marker))| {
        if marker {
            Some(record.raw.residue_name.clone())
        } else if is_drude(parsed, index) {
            Some("Drude particle".to_owned())
        } else {
            is_site(parsed, index, known).then(|| record.name.clone())
        }
    })
    .collect()
}

/// The records of residues that are markers.
fn markers(parsed: &[Parsed]) -> Vec<bool> {
    let is_marker = |record: &Parsed| {
        let of_residue = MARKERS
            .iter()
            .find(|(residue, _)| *residue == record.raw.residue_name);
        of_residue.map(|(_, atoms)| {
            let name = record.name.to_ascii_uppercase();
            atoms.contains(&name.trim_end_matches(|c: char| c.is_ascii_digit()))
        })
    };
    let each: Vec<Option<bool>> = parsed.iter().map(is_marker).collect();
    let mut whole: HashMap<Key<'_>, bool> = HashMap::new();
    for (record, is_marker) in parsed.iter().zip(&each) {
        if let Some(is_marker) = is_marker {
            *whole.entry(key(record)).or_insert(true) &= is_marker;
        }
    }
    let all = parsed.iter().zip(each);
    all.map(|(record, one)| one.is_some() && whole.get(&key(record)) == Some(&true))
        .collect()
}

/// The records of a record's residue that stand before and after it without another residue between.
fn beside(parsed: &[Parsed], index: usize) -> impl Iterator<Item = &Parsed> {
    let own = parsed.get(index).map(key);
    let same = move |record: &&Parsed| Some(key(record)) == own;
    let (before, after) = parsed.split_at(index);
    before
        .iter()
        .rev()
        .take_while(same)
        .chain(after.iter().take_while(same))
}

/// Whether a record is the charged particle of CHARMM's Drude model, which is named after its atom (`DCA` beside `CA`).
fn is_drude(parsed: &[Parsed], index: usize) -> bool {
    let Some((record, atom)) = parsed.get(index).and_then(|record| {
        let atom = record.name.strip_prefix('D')?;
        (!atom.is_empty()).then_some((record, atom))
    }) else {
        return false;
    };
    beside(parsed, index).any(|other| {
        other.name == atom
            && squared_distance(other.exact.position, record.exact.position) < DRUDE * DRUDE
    })
}

/// Whether a record is a site without mass in a residue that the tables have as `known`.
fn is_site(parsed: &[Parsed], index: usize, known: &str) -> bool {
    let Some(record) = parsed.get(index) else {
        return false;
    };
    let (name, column) = (record.name.as_str(), record.raw.element.as_str());
    if is_water(known) {
        let name = name.trim_end_matches(|c: char| c.is_ascii_digit());
        return matches!(name, "M" | "MW" | "OM" | "EP" | "EPW" | "LP");
    }
    if is_amino_acid(known) {
        let is_nothing =
            || elements::resolve(known, name, column, NameColumn::Unknown, false).is_none();
        return amino_acid_type(known, name).is_none()
            && (is_site_name(name, column) || is_nothing());
    }
    let is_mass_centre = || {
        mass_center(name).is_some_and(|heavy| {
            heavy.starts_with(['C', 'N']) && beside(parsed, index).any(|other| other.name == heavy)
        })
    };
    // PyMOL's pseudoatoms under another residue's name.
    let is_pymol = || column.eq_ignore_ascii_case("PS") && name.starts_with("PS");
    let is_pair = || name.starts_with("LP") || name.starts_with("EP");
    column_symbol(column).is_none() && (is_mass_centre() || is_pair() || is_pymol())
}
