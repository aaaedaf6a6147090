//! Residues that a chain has and its file does not show, and where they may be.
//!
//! A loop that was not seen bridges a gap in the chain, and the ends of chains move or go on unseen; what is docked there meets them. Where they are
//! is not known. So many courses are grown that each stretch may take from where the chain is seen last, past the body and past itself: what all of
//! them fill is sure to be filled, and what a few of them cross is mostly free.

mod loop_sampler;

use serde::{Serialize, Serializer};

use crate::Conformers;
use crate::molecule::model::atom::Atom;
use crate::molecule::model::chains::{Chain, Gap};
use crate::molecule::model::groups::{Residue, residues};
use crate::molecule::model::molecule::Molecule;
use crate::molecule::model::unresolved::loop_sampler::Growth;

/// Residues past an end of a chain: as many as are seen of it and taken to be loose.
const PAST_END: usize = 8;

/// Most residues of a loop: longer ones fold back.
const MAX_LOOP_LENGTH: i64 = 20;

/// Residues that a molecule's chains have and its file does not show.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MissingResidues {
    /// Residues that are missing in gaps.
    pub residues: usize,
    /// Gaps.
    pub gaps: usize,
    /// Ends of chains, past which more may follow; of peptides and where something is bonded to an end none.
    pub ends: usize,
    /// Where residues of each gap and past each end may be, of those that the body leaves room for.
    #[serde(rename = "conformers", serialize_with = "courses")]
    pub stretches: Vec<Conformers>,
}

/// A record says how many there are of a list, not what.
pub(crate) fn length<T, S: Serializer>(list: &[T], to: S) -> Result<S::Ok, S::Error> {
    list.len().serialize(to)
}

fn courses<S: Serializer>(stretches: &[Conformers], to: S) -> Result<S::Ok, S::Error> {
    let courses = stretches.iter().map(|stretch| stretch.courses.len());
    courses.sum::<usize>().serialize(to)
}

impl Molecule {
    /// Residues that the chains must have and the file does not show, as far as atoms and residue numbers tell.
    pub fn missing_residues(&self) -> MissingResidues {
        let groups = residues(&self.atoms);
        let chains = self.chains(&groups);
        let growth = Growth::new(self.atoms.iter().map(|atom| atom.position).collect());
        let mut found = MissingResidues::default();
        for chain in &chains {
            for gap in &chain.gaps {
                found.gaps += 1;
                found.residues += gap.missing as usize;
                found.stretches.extend(self.bridge(&growth, chain, gap));
            }
        }
        for chain in chains.iter().filter(|chain| !chain.is_short()) {
            let sides = [(chain.residues.first(), "N"), (chain.residues.last(), "C")];
            for ((residue, name), end) in sides.into_iter().zip(chain.ends) {
                let (Some(residue), Some(_)) = (residue, end) else {
                    continue;
                };
                found.ends += 1;
                found.stretches.extend(self.past(&growth, residue, name));
            }
        }
        found
    }

    /// Courses past the end of a chain.
    fn past(&self, growth: &Growth, residue: &Residue<'_>, end: &str) -> Option<Conformers> {
        let frame = self.frame(residue, end)?;
        growth.courses(frame, &residue.atoms, None, PAST_END)
    }

    /// Courses across a gap.
    fn bridge(&self, growth: &Growth, chain: &Chain<'_>, gap: &Gap) -> Option<Conformers> {
        let (before, after) = (chain.residues[gap.after - 1], chain.residues[gap.after]);
        let frame = self.frame(before, "C")?;
        let anchors = [before.atoms.as_slice(), &after.atoms].concat();
        let length = gap.missing.min(MAX_LOOP_LENGTH) as usize;
        growth.courses(frame, &anchors, Some(gap.sides[1]), length)
    }

    /// The frame of a residue's main chain about its N or C, for courses to go with the body however it is turned.
    fn frame(&self, residue: &Residue<'_>, about: &str) -> Option<Conformers> {
        let other = if about == "N" { "C" } else { "N" };
        let at = |name: &str| self.atom(residue, name).map(|atom: &Atom| atom.position);
        let (origin, alpha, other) = (at(about)?, at("CA")?, at(other)?);
        let axes = loop_sampler::axes(origin, alpha, other)?;
        Some(Conformers {
            origin,
            axes,
            courses: Vec::new(),
        })
    }
}

#[cfg(test)]
mod tests;
