//! Residues that a chain has and its file does not show, and where they may be.
//!
//! A loop that was not seen bridges a gap in the chain, and the termini move or go on unseen; what is docked there meets them. Where they are
//! is not known. So many conformers are grown that each segment may take from where the chain is seen last, past the body and past itself: what all of
//! them fill is sure to be filled, and what a few of them cross is mostly free.

mod loop_sampler;

use serde::{Serialize, Serializer};

use crate::Conformers;
use crate::molecule::model::atom::Atom;
use crate::molecule::model::chains::{Chain, Gap};
use crate::molecule::model::groups::{Residue, residues};
use crate::molecule::model::molecule::Molecule;
use crate::molecule::model::unresolved::loop_sampler::LoopSampler;

/// Residues past an end of a chain: as many as are seen of it and taken to be loose.
const PAST_END: usize = 8;

/// Most residues of a loop: longer ones fold back.
const MAX_LOOP_LENGTH: i64 = 20;

/// Residues that a molecule's chains have and its file does not show.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct UnresolvedResidues {
    /// Residues that are missing in gaps.
    pub residues: usize,
    /// Gaps.
    pub gaps: usize,
    /// Termini, past which more may follow; of peptides and where something is bonded to an end none.
    pub ends: usize,
    /// Where residues of each gap and past each end may be, of those that the body leaves room for.
    #[serde(rename = "conformers", serialize_with = "traces")]
    pub segments: Vec<Conformers>,
}

/// A record says how many there are of a list, not what.
pub(crate) fn length<T, S: Serializer>(list: &[T], to: S) -> Result<S::Ok, S::Error> {
    list.len().serialize(to)
}

fn traces<S: Serializer>(segments: &[Conformers], to: S) -> Result<S::Ok, S::Error> {
    let traces = segments.iter().map(|segment| segment.traces.len());
    traces.sum::<usize>().serialize(to)
}

impl Molecule {
    /// Residues that the chains must have and the file does not show, as far as atoms and residue numbers tell.
    pub fn unresolved_residues(&self) -> UnresolvedResidues {
        let groups = residues(&self.atoms);
        let chains = self.chains(&groups);
        let sampler = LoopSampler::new(self.atoms.iter().map(|atom| atom.position).collect());
        let mut found = UnresolvedResidues::default();
        for chain in &chains {
            for gap in &chain.gaps {
                found.gaps += 1;
                found.residues += gap.unresolved as usize;
                found.segments.extend(self.bridge(&sampler, chain, gap));
            }
        }
        for chain in chains.iter().filter(|chain| !chain.is_short()) {
            let sides = [(chain.residues.first(), "N"), (chain.residues.last(), "C")];
            for ((residue, name), end) in sides.into_iter().zip(chain.ends) {
                let (Some(residue), Some(_)) = (residue, end) else {
                    continue;
                };
                found.ends += 1;
                found.segments.extend(self.past(&sampler, residue, name));
            }
        }
        found
    }

    /// Conformers past the end of a chain.
    fn past(&self, sampler: &LoopSampler, residue: &Residue<'_>, end: &str) -> Option<Conformers> {
        let frame = self.frame(residue, end)?;
        sampler.traces(frame, &residue.atoms, None, PAST_END)
    }

    /// Conformers across a gap.
    fn bridge(&self, sampler: &LoopSampler, chain: &Chain<'_>, gap: &Gap) -> Option<Conformers> {
        let (before, after) = (chain.residues[gap.after - 1], chain.residues[gap.after]);
        let frame = self.frame(before, "C")?;
        let anchors = [before.atoms.as_slice(), &after.atoms].concat();
        let length = gap.unresolved.min(MAX_LOOP_LENGTH) as usize;
        sampler.traces(frame, &anchors, Some(gap.sides[1]), length)
    }

    /// The frame of a residue's main chain about its N or C, for conformers to go with the body however it is turned.
    fn frame(&self, residue: &Residue<'_>, about: &str) -> Option<Conformers> {
        let other = if about == "N" { "C" } else { "N" };
        let at = |name: &str| self.atom(residue, name).map(|atom: &Atom| atom.position);
        let (origin, alpha, other) = (at(about)?, at("CA")?, at(other)?);
        let axes = loop_sampler::axes(origin, alpha, other)?;
        Some(Conformers {
            origin,
            axes,
            traces: Vec::new(),
        })
    }
}

#[cfg(test)]
mod tests;
