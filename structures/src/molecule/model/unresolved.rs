//! Residues that a chain has and its file does not resolve, and conformers of these segments.
//!
//! An unresolved loop bridges a gap in the chain, and termini move or go on beyond what is resolved. A docked partner
//! meets them. Their places are not known, so many conformers are sampled for each segment, clear of the body and of
//! themselves. Where all conformers pass the space is filled; where few pass it is mostly free.

mod loop_sampler;

use serde::{Serialize, Serializer};

use crate::Conformers;
use crate::molecule::model::atom::Atom;
use crate::molecule::model::chains::{Chain, Gap};
use crate::molecule::model::groups::{Residue, residues};
use crate::molecule::model::molecule::Molecule;
use crate::molecule::model::unresolved::loop_sampler::LoopSampler;

/// Residues sampled beyond a terminus: as many as count as flexible on its resolved side.
const PAST_END: usize = 8;

/// Longest loop that is sampled, residues: longer loops fold back.
const MAX_LOOP_LENGTH: i64 = 20;

/// Residues that a molecule's chains have and its file does not resolve.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct UnresolvedResidues {
    /// Unresolved residues in gaps.
    pub residues: usize,
    /// Gaps.
    pub gaps: usize,
    /// Termini beyond which more residues may follow. Peptides have none, nor does an end that something is bonded to.
    pub ends: usize,
    /// Conformers of each gap and beyond each terminus, of those that the body leaves room for.
    #[serde(rename = "conformers", serialize_with = "traces")]
    pub segments: Vec<Conformers>,
}

/// Serialises the length of a list, not its items.
pub(crate) fn length<T, S: Serializer>(list: &[T], to: S) -> Result<S::Ok, S::Error> {
    list.len().serialize(to)
}

/// Serialises the number of conformers of all segments.
fn traces<S: Serializer>(segments: &[Conformers], to: S) -> Result<S::Ok, S::Error> {
    let traces = segments.iter().map(|segment| segment.traces.len());
    traces.sum::<usize>().serialize(to)
}

impl Molecule {
    /// Detects unresolved residues from atoms and residue numbers, and samples their conformers.
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

    /// Conformers beyond a terminus.
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

    /// The frame of a residue's main chain about its N or C, so that conformers move with the body.
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
