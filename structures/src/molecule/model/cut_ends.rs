//! Cut bonds that a selection of residues leaves; they are not termini.

use crate::molecule::model::atom::{Atom, squared_distance};
use crate::molecule::model::groups::ResidueKey;
use crate::neighbours::SpatialHash;

/// Longest distance in Å of a terminal atom from what is bonded to it.
pub(crate) const MAX_CAP_LENGTH: f64 = 1.7;

/// An end that a selection of residues made of a bond: a residue that is kept, and its atom whose partner is not.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CutEnd {
    chain: String,
    number: i64,
    insertion: Option<char>,
    /// N or C.
    atom: &'static str,
}

impl CutEnd {
    /// Whether this is the end of a residue at its atom N or C.
    pub(crate) fn is(&self, (chain, number, insertion, _): ResidueKey<'_>, atom: &str) -> bool {
        (self.chain.as_str(), self.number, self.insertion, self.atom)
            == (chain, number, insertion, atom)
    }
}

/// The ends among the kept atoms that are bonded to one of those left out.
pub(crate) fn cut_ends(kept: &[Atom], left_out: &[Atom]) -> Vec<CutEnd> {
    let name = |atom: &Atom| ["N", "C"].into_iter().find(|name| *name == atom.name);
    let partners: Vec<&Atom> = left_out
        .iter()
        .filter(|atom| name(atom).is_some())
        .collect();
    if partners.is_empty() {
        return Vec::new();
    }
    let cells = SpatialHash::of_points(partners.iter().map(|atom| atom.position), MAX_CAP_LENGTH);
    let is_cut = |atom: &Atom| {
        let mut near = cells
            .around(atom.position)
            .copied()
            .filter_map(|index| partners.get(index));
        near.any(|partner| {
            partner.name != atom.name
                && squared_distance(partner.position, atom.position)
                    < MAX_CAP_LENGTH * MAX_CAP_LENGTH
        })
    };
    kept.iter()
        .filter_map(|atom| Some((atom, name(atom)?)))
        .filter(|(atom, _)| is_cut(atom))
        .map(|(atom, name)| CutEnd {
            chain: atom.chain.clone(),
            number: atom.residue_number,
            insertion: atom.insertion_code,
            atom: name,
        })
        .collect()
}
