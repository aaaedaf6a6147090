//! The chains and residues that are asked of a file, and where these cut a chain.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use super::error::ReadError;
use super::groups::ResidueKey;
use super::parse::Parsed;
use super::report::{DropKind, show_chain};
use super::residue_selection::{Picked, ResidueSelection};
use super::sieve::AtomRecord;
use super::termini::MAX_CAP_LENGTH;
use super::{Atom, squared_distance};
use crate::neighbours::SpatialHash;

/// An end that a selection of residues made of a bond: a residue that is kept, and its atom whose partner is not.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CutEnd {
    chain: String,
    number: i64,
    insertion: Option<char>,
    /// N or C.
    atom: &'static str,
}

impl CutEnd {
    /// Whether this is the end of a residue at its atom N or C.
    pub(super) fn is(&self, (chain, number, insertion, _): ResidueKey<'_>, atom: &str) -> bool {
        (self.chain.as_str(), self.number, self.insertion, self.atom)
            == (chain, number, insertion, atom)
    }
}

/// The ends among the kept atoms that are bonded to one of those left out.
pub(super) fn cut_ends(kept: &[Atom], left_out: &[Atom]) -> Vec<CutEnd> {
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

/// What to keep: of some chains all, of others some residues.
pub(super) struct Wanted(HashMap<String, Vec<Picked>>);

impl Wanted {
    /// What the parts of a selection name in a file.
    ///
    /// # Errors
    /// [`ReadError::UnknownChain`] and [`ReadError::UnknownResidues`] where a part names nothing of it.
    pub(super) fn new(file: &Path, parsed: &[Parsed], parts: &[String]) -> Result<Self, ReadError> {
        let mut present: Vec<String> = Vec::new();
        let mut names: BTreeSet<&str> = BTreeSet::new();
        for Parsed { carried, .. } in parsed {
            if names.insert(&carried.chain) {
                present.push(carried.chain.clone());
            }
        }
        let text = parts.join(",");
        let selection: ResidueSelection = text
            .parse()
            .map_err(|_| ReadError::Specification { text })?;
        let mut wanted: HashMap<String, Vec<Picked>> = HashMap::new();
        for picked in selection.read_among(&names) {
            if !names.contains(picked.chain.as_str()) {
                return Err(ReadError::UnknownChain {
                    file: file.to_path_buf(),
                    chain: picked.written,
                    present,
                    warnings: Vec::new(),
                });
            }
            let of_chain = || {
                let records = parsed.iter().map(|record| &record.carried);
                records.filter(|carried| carried.chain == picked.chain)
            };
            let is_there =
                |carried: &AtomRecord| picked.holds(carried.residue_number, carried.insertion_code);
            if !of_chain().any(is_there) {
                let numbers = || of_chain().map(|carried| carried.residue_number);
                let (first, last) = (numbers().min(), numbers().max());
                return Err(ReadError::UnknownResidues {
                    file: file.to_path_buf(),
                    part: picked.written,
                    chain: show_chain(&picked.chain).to_owned(),
                    numbers: [first.unwrap_or(0), last.unwrap_or(0)],
                });
            }
            wanted.entry(picked.chain.clone()).or_default().push(picked);
        }
        Ok(Self(wanted))
    }

    /// Why an atom is not asked for, if it is not.
    pub(super) fn leaves_out(&self, carried: &AtomRecord) -> Option<DropKind> {
        let Some(parts) = self.0.get(&carried.chain) else {
            return Some(DropKind::Chain);
        };
        let holds = |part: &Picked| part.holds(carried.residue_number, carried.insertion_code);
        (!parts.iter().any(holds)).then_some(DropKind::OtherResidue)
    }
}
