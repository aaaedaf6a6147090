//! Peptide chains as they are bonded, whatever their names: where one begins and ends, and where residues are missing
//! in between.

use crate::molecule::chemistry::charged_termini::{BOND, Caps};
use crate::molecule::model::atom::squared_distance;
use crate::molecule::model::groups::Residue;
use crate::molecule::model::molecule::Molecule;

/// Largest distance of adjacent residues, in Å.
const STRETCHED: f64 = 3.8;

/// Longest gap within a chain, in residues and in Å; a longer one separates two chains.
const MAX_RESIDUES: i64 = 60;
const LONGEST: f64 = 40.0;

/// Longest gap in Å where numbers show none: a residue or two that the numbering does not count.
const MAX_UNCOUNTED_LENGTH: f64 = 12.0;

/// Fewest residues of a chain whose ends are taken to go on and to be flexible: a peptide is docked as it is.
const CHAIN: usize = 20;

/// A peptide chain: its residues in order, with gaps between some of them.
pub(crate) struct Chain<'a> {
    pub residues: Vec<&'a Residue<'a>>,
    pub gaps: Vec<Gap>,
    /// The N and C past which it may go on: the chain's own ends, where they are in the file and nothing is bonded to
    /// them.
    pub ends: [Option<[f64; 3]>; 2],
}

/// Residues that are missing in a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gap {
    /// The residue that follows the gap, by its place in the chain.
    pub after: usize,
    /// How many are missing.
    pub unresolved: i64,
    /// The C before and the N after it (Å).
    pub sides: [[f64; 3]; 2],
}

/// Junction of two peptide residues in a row.
enum Between {
    Bond,
    /// So many residues, between a C and an N.
    Gap(i64, [[f64; 3]; 2]),
    /// The end of one chain and the beginning of another.
    Ends,
}

impl Molecule {
    /// The peptide chains of a molecule, of whose residues `groups` are all.
    pub(crate) fn chains<'a>(&self, groups: &'a [Residue<'a>]) -> Vec<Chain<'a>> {
        let caps = self.caps(groups);
        let mut chains: Vec<Chain<'a>> = Vec::new();
        for residue in groups.iter().filter(|residue| residue.is_peptide()) {
            let last = chains.last_mut().and_then(|chain| {
                let before = *chain.residues.last()?;
                Some((chain, before))
            });
            let Some((chain, before)) = last else {
                chains.push(Chain::of(residue));
                continue;
            };
            match self.between(before, residue) {
                Between::Bond => {}
                Between::Gap(unresolved, sides) => {
                    let bonded =
                        self.capped(&caps, before, "C") || self.capped(&caps, residue, "N");
                    if !bonded {
                        chain.gaps.push(Gap {
                            after: chain.residues.len(),
                            unresolved,
                            sides,
                        });
                    }
                }
                Between::Ends => {
                    chains.push(Chain::of(residue));
                    continue;
                }
            }
            chain.residues.push(residue);
        }
        for chain in &mut chains {
            let ends = [(chain.residues.first(), "N"), (chain.residues.last(), "C")];
            chain.ends = ends.map(|(residue, name)| self.free_end(&caps, residue?, name));
        }
        chains
    }

    /// Whether the numbers between two residues in a row, at this distance in Å, may be of unresolved residues.
    pub(crate) fn may_be_gap(before: &Residue<'_>, after: &Residue<'_>, spacing: f64) -> bool {
        let counted = after.key.1.saturating_sub(before.key.1).saturating_sub(1);
        (1..=MAX_RESIDUES).contains(&counted)
            && spacing <= LONGEST
            && spacing <= STRETCHED * (counted + 1) as f64
    }

    /// Where an end of a chain is, unless something is bonded to it.
    fn free_end(&self, caps: &Caps<'_>, residue: &Residue<'_>, name: &str) -> Option<[f64; 3]> {
        let end = self.atom(residue, name)?;
        (!self.capped(caps, residue, name)).then_some(end.position)
    }

    /// Junction of two peptide residues in a row. Residues that lack the deciding atoms count as bonded.
    fn between(&self, before: &Residue<'_>, after: &Residue<'_>) -> Between {
        let ((chain, number, ..), (next_chain, next_number, ..)) = (before.key, after.key);
        let (Some(from), Some(to)) = (self.atom(before, "C"), self.atom(after, "N")) else {
            return if chain == next_chain {
                Between::Bond
            } else {
                Between::Ends
            };
        };
        let (from, to) = (from.position, to.position);
        let spacing = squared_distance(from, to).sqrt();
        let counted = next_number.saturating_sub(number).saturating_sub(1);
        let unresolved = if counted >= 1 && spacing <= STRETCHED * (counted + 1) as f64 {
            counted
        } else {
            (spacing / STRETCHED).ceil() as i64 - 1
        };
        if spacing <= BOND {
            Between::Bond
        } else if chain != next_chain
            || next_number < number
            || (unresolved != counted && self.has_last_oxygen(before))
            || unresolved > MAX_RESIDUES
            || spacing > LONGEST
            || (unresolved != counted && spacing > MAX_UNCOUNTED_LENGTH)
        {
            Between::Ends
        } else if unresolved == 0 {
            Between::Bond
        } else {
            Between::Gap(unresolved, [from, to])
        }
    }
}

impl<'a> Chain<'a> {
    fn of(residue: &'a Residue<'a>) -> Self {
        Self {
            residues: vec![residue],
            gaps: Vec::new(),
            ends: [None; 2],
        }
    }

    /// Whether this is a peptide, whose ends are as good as the rest of it.
    pub fn is_short(&self) -> bool {
        self.residues.len() < CHAIN
    }
}
