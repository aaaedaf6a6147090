//! Peptide chains as they are bonded, whatever their names: where one begins and ends, and where residues are missing
//! in between; cut bonds that a selection of residues leaves; and residues near termini and gaps.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::molecule::chemistry::{BOND, Caps};
use crate::molecule::model::{Atom, Molecule, Residue, ResidueKey, residues};
use crate::neighbours::SpatialHash;
use crate::vector::squared_distance;

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
    /// This many residues, between a C and an N.
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
            let last = chains
                .last_mut()
                .and_then(|chain| Some((*chain.residues.last()?, chain)));
            let between =
                last.map(|(before, chain)| (self.between(before, residue), before, chain));
            match between {
                None | Some((Between::Ends, ..)) => chains.push(Chain {
                    residues: vec![residue],
                    gaps: Vec::new(),
                    ends: [None; 2],
                }),
                Some((between, before, chain)) => {
                    if let Between::Gap(unresolved, sides) = between
                        && !self.capped(&caps, before, "C")
                        && !self.capped(&caps, residue, "N")
                    {
                        let after = chain.residues.len();
                        chain.gaps.push(Gap {
                            after,
                            unresolved,
                            sides,
                        });
                    }
                    chain.residues.push(residue);
                }
            }
        }
        for chain in &mut chains {
            let ends = [(chain.residues.first(), "N"), (chain.residues.last(), "C")];
            chain.ends = ends.map(|(residue, name)| self.free_end(&caps, residue?, name));
        }
        chains
    }

    /// Whether the numbers between two residues in a row, at this distance in Å, may be of unresolved residues.
    pub(crate) fn may_be_gap(before: &Residue<'_>, after: &Residue<'_>, spacing: f64) -> bool {
        let counted = after
            .key
            .number
            .saturating_sub(before.key.number)
            .saturating_sub(1);
        (1..=MAX_RESIDUES).contains(&counted)
            && spacing <= LONGEST
            && spacing <= STRETCHED * (counted + 1) as f64
    }

    /// Position of a chain's end, unless something is bonded to it.
    fn free_end(&self, caps: &Caps<'_>, residue: &Residue<'_>, name: &str) -> Option<[f64; 3]> {
        let end = self.atom(residue, name)?;
        (!self.capped(caps, residue, name)).then_some(end.position)
    }

    /// Junction of two peptide residues in a row. Residues that lack the deciding atoms count as bonded.
    fn between(&self, before: &Residue<'_>, after: &Residue<'_>) -> Between {
        let (chain, number) = (before.key.chain, before.key.number);
        let (next_chain, next_number) = (after.key.chain, after.key.number);
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

impl Chain<'_> {
    /// Whether this is a peptide, whose ends are as good as the rest of it.
    pub fn is_short(&self) -> bool {
        self.residues.len() < CHAIN
    }
}

/// Longest distance in Å of a terminal atom from an atom bonded to it.
pub(crate) const MAX_CAP_LENGTH: f64 = 1.7;

/// An end that a selection of residues made of a bond: a residue that is kept, and its atom whose partner is not.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CutEnd {
    chain: String,
    number: i64,
    insertion: Option<char>,
    atom: &'static str,
}

impl CutEnd {
    /// Whether this is the end of a residue at its atom N or C.
    pub(crate) fn is(&self, residue: ResidueKey<'_>, atom: &str) -> bool {
        (self.chain.as_str(), self.number, self.insertion) == residue.place() && self.atom == atom
    }
}

/// The ends among the kept atoms that are bonded to one of those left out.
pub(crate) fn cut_ends(kept: &[Atom], left_out: &[Atom]) -> Vec<CutEnd> {
    let name = |atom: &Atom| ["N", "C"].into_iter().find(|name| *name == atom.name);
    let partners = left_out.iter().filter(|atom| name(atom).is_some());
    let partners: Vec<&Atom> = partners.collect();
    let cells = SpatialHash::of_points(partners.iter().map(|atom| atom.position), MAX_CAP_LENGTH);
    let is_cut = |atom: &Atom| {
        cells.around(atom.position).any(|&index| {
            let partner = partners[index];
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

/// Largest number of residues from a terminus that count as near it.
///
/// The second constant is the largest share of a chain, one residue in this many: of small proteins hardly any is
/// flexible.
const NEAR: usize = 8;
const ONE_IN: usize = 16;

/// Residues near the termini of a molecule's chains, and near gaps: they move more than the rest of a body.
///
/// A crystal resolves one of many places, and wrong poses touch that place more often than right ones.
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
            let residues = flexible
                .iter()
                .filter_map(|&place| chain.residues.get(place));
            for residue in residues {
                found.residues += 1;
                found.atoms.extend(&residue.atoms);
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::model::{Format, residue_runs};
    use crate::test_support::{capped, example, without};

    /// The places of the residues near ends, all of whose atoms must be there.
    fn near(molecule: &Molecule) -> Vec<usize> {
        let ends = molecule.termini();
        let mut near = Vec::new();
        for (place, run) in residue_runs(&molecule.atoms).iter().enumerate() {
            let there = run.atoms.iter().filter(|atom| ends.atoms.contains(atom));
            match there.count() {
                0 => {}
                count if count == run.atoms.len() => near.push(place),
                count => panic!("{count} atoms of residue {place}"),
            }
        }
        assert_eq!(near.len(), ends.residues);
        near
    }

    /// Trypsin is long enough for eight residues at each end; of the inhibitor's 29 one is near each.
    #[test]
    fn a_short_chain_has_fewer() {
        let trypsin = near(&example("receptor"));
        assert_eq!(trypsin, (0..8).chain(215..223).collect::<Vec<_>>());
        assert_eq!(near(&example("ligand")), [0, 28]);
    }

    #[test]
    fn both_sides_of_a_gap_count() {
        let broken = near(&without(&example("receptor"), 100..110).0);
        // Of 213 residues.
        let expected = (0..8).chain(92..108).chain(205..213);
        assert_eq!(broken, expected.collect::<Vec<_>>());
    }

    #[test]
    fn an_end_that_something_is_bonded_to_is_none() {
        let capped = capped(example("receptor"));
        assert_eq!(near(&capped), (0..8).collect::<Vec<_>>());
    }

    #[test]
    fn no_chains_have_no_ends() {
        let nothing = Molecule::new(Vec::new(), Format::Pdb);
        assert_eq!(nothing.termini(), Termini::default());
        let (peptide, _) = without(&example("receptor"), 19..223);
        assert_eq!(near(&peptide), [0usize; 0]);
    }
}
