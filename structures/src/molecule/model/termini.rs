//! Residues near termini and gaps, which move more than the rest of a body.
//!
//! What a crystal resolves of them is one place of many, and wrong poses lie against that place more often than right
//! ones.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::molecule::model::groups::residues;
use crate::molecule::model::molecule::Molecule;

/// Largest number of residues from a terminus that count as near it.
///
/// The second constant is the largest share of a chain, one residue in so many: of small proteins hardly any is
/// flexible.
const NEAR: usize = 8;
const ONE_IN: usize = 16;

/// Residues near the termini of a molecule's chains, and near gaps.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Termini {
    /// How many residues.
    pub residues: usize,
    /// The indices of their atoms in the molecule.
    #[serde(serialize_with = "crate::molecule::model::unresolved::length")]
    pub atoms: Vec<usize>,
}

impl Molecule {
    /// The residues at most eighth, and at most as far along as a sixteenth of the chain, from a terminus or gap.
    ///
    /// Peptides have no termini in this sense, nor is an end one that something is bonded to.
    pub fn termini(&self) -> Termini {
        let groups = residues(&self.atoms);
        let mut found = Termini::default();
        for chain in self
            .chains(&groups)
            .iter()
            .filter(|chain| !chain.is_short())
        {
            let length = chain.residues.len();
            let near = NEAR.min(length / ONE_IN);
            let first = chain.ends[0].map(|_| 0..near);
            let last = chain.ends[1].map(|_| length - near..length);
            let gaps = chain.gaps.iter();
            let gaps = gaps.map(|gap| gap.after.saturating_sub(near)..gap.after + near);
            let flexible: BTreeSet<usize> = gaps.chain(first).chain(last).flatten().collect();
            for residue in flexible
                .iter()
                .filter_map(|&place| chain.residues.get(place))
            {
                found.residues += 1;
                found.atoms.extend(&residue.atoms);
            }
        }
        found
    }
}

#[cfg(test)]
mod tests;
