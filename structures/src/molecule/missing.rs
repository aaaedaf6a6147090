//! Residues that a chain has and its file does not show: where they may be, as balls of a residue's volume, 134 Å³ or a radius of 3.2 Å (the mean
//! over proteins of the volumes of Zamyatnin, Prog. Biophys. Mol. Biol. 24 (1972) 107-123).
//!
//! A loop that was not seen bridges a gap in the chain, and the ends of chains move or go on unseen; what is docked there meets them. So balls
//! stand for them: in a gap as many as residues are missing, along a bow from end to end that leans away from the body, and two past each end of
//! a chain, straight away from it. They are where such residues may be, not where they are.

use serde::{Serialize, Serializer};

use super::cells::Cells;
use super::groups::{Residue, residues};
use super::termini::BOND;
use super::{Molecule, squared_distance};

/// Distance in Å of the first ball past an end from its N or C, where the next CA would be, and of the second.
const PAST_END: [f64; 2] = [2.5, 6.0];

/// Length of chain in Å that a residue adds to a bow; and the most that residues side by side can be apart.
const RISE: f64 = 3.4;
const STRETCHED: f64 = 3.8;

/// Longest gap in residues, and in Å, that is taken for one: beyond, one chain ends and another begins.
const MOST_RESIDUES: i64 = 60;
const LONGEST: f64 = 40.0;

/// Longest gap in Å where numbers show none: a residue or two that the numbering does not count.
const LONGEST_UNCOUNTED: f64 = 12.0;

/// Most balls in a bow, its share of the height that its length allows, and its greatest height in Å: longer loops fold back.
const MOST_BALLS: i64 = 20;
const BOWED: f64 = 0.6;
const HIGHEST: f64 = 10.0;

/// Distances in Å within which atoms tell where the body lies, of an end and of a gap's middle.
const ABOUT_END: f64 = 12.0;
const ABOUT_GAP: f64 = 15.0;

/// Fewest residues of a chain whose ends are taken to go on: a peptide is docked as it is.
const CHAIN: usize = 20;

/// Residues that a molecule's chains have and its file does not show.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MissingResidues {
    /// Residues that are missing in gaps.
    pub residues: usize,
    /// Gaps.
    pub gaps: usize,
    /// Ends of chains, past which more may follow; of peptides and where something is bonded to an end none.
    pub ends: usize,
    /// Where balls of 3.2 Å stand for them, in the file's frame (Å).
    #[serde(rename = "balls", serialize_with = "count")]
    pub centers: Vec<[f64; 3]>,
}

/// A record says how many balls there are, not where.
fn count<S: Serializer>(centers: &[[f64; 3]], to: S) -> Result<S::Ok, S::Error> {
    centers.len().serialize(to)
}

/// What lies between two peptide residues in a row.
enum Between {
    /// A bond.
    Bond,
    /// A gap: residues that are missing, and the places of the C before and the N after it.
    Gap {
        missing: i64,
        from: [f64; 3],
        to: [f64; 3],
    },
    /// The end of one chain and the beginning of another.
    Ends,
}

impl Molecule {
    /// Residues that the chains must have and the file does not show, as far as atoms and residue numbers tell.
    pub fn missing_residues(&self) -> MissingResidues {
        let groups = residues(&self.atoms);
        let caps = self.caps(&groups);
        let body = Body::new(self);
        let mut found = MissingResidues::default();
        let mut chains: Vec<Vec<&Residue<'_>>> = Vec::new();
        for residue in groups.iter().filter(|residue| residue.is_peptide()) {
            let before = chains.last().and_then(|chain| chain.last().copied());
            let between = before.map_or(Between::Ends, |before| self.between(before, residue));
            if let (Between::Gap { missing, from, to }, Some(before)) = (&between, before)
                && !self.capped(&caps, before, "C")
                && !self.capped(&caps, residue, "N")
            {
                found.gaps += 1;
                found.residues += *missing as usize;
                found.centers.extend(body.bow(*from, *to, *missing));
            }
            match chains.last_mut() {
                Some(chain) if !matches!(between, Between::Ends) => chain.push(residue),
                _ => chains.push(vec![residue]),
            }
        }
        for chain in chains.iter().filter(|chain| chain.len() >= CHAIN) {
            for (residue, name) in [(chain.first(), "N"), (chain.last(), "C")] {
                let Some(residue) = residue.filter(|residue| !self.capped(&caps, residue, name))
                else {
                    continue;
                };
                if let Some(end) = self.atom(residue, name) {
                    found.ends += 1;
                    found.centers.extend(body.past(end.position));
                }
            }
        }
        found
    }

    /// What lies between two peptide residues in a row. Residues that lack the atoms to tell are bonded.
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
        let apart = squared_distance(from, to).sqrt();
        let counted = next_number.saturating_sub(number).saturating_sub(1);
        let missing = if counted >= 1 && apart <= STRETCHED * (counted + 1) as f64 {
            counted
        } else {
            (apart / STRETCHED).ceil() as i64 - 1
        };
        if apart <= BOND {
            Between::Bond
        } else if chain != next_chain
            || next_number < number
            || missing > MOST_RESIDUES
            || apart > LONGEST
            || (missing != counted && apart > LONGEST_UNCOUNTED)
        {
            Between::Ends
        } else if missing == 0 {
            Between::Bond
        } else {
            Between::Gap { missing, from, to }
        }
    }
}

/// All atoms of a molecule, by place.
struct Body<'a> {
    molecule: &'a Molecule,
    cells: Cells,
}

impl<'a> Body<'a> {
    fn new(molecule: &'a Molecule) -> Self {
        let positions = molecule.atoms.iter().map(|atom| atom.position);
        Self {
            molecule,
            cells: Cells::new(positions, ABOUT_GAP.max(ABOUT_END)),
        }
    }

    /// The direction away from the middle of the atoms within `reach` of a point; zero where that is the point.
    fn outward(&self, point: [f64; 3], reach: f64) -> [f64; 3] {
        // Relative to the point, so that large coordinates cost no digits.
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for index in self.cells.around(point) {
            let position = self.molecule.atoms[index].position;
            if squared_distance(position, point) <= reach * reach {
                count += 1.0;
                for axis in 0..3 {
                    sum[axis] += point[axis] - position[axis];
                }
            }
        }
        let length = squared_distance(sum, [0.0; 3]).sqrt();
        if length > 1e-6 * count {
            sum.map(|x| x / length)
        } else {
            [0.0; 3]
        }
    }

    /// Balls past the end of a chain.
    fn past(&self, end: [f64; 3]) -> [[f64; 3]; 2] {
        let out = self.outward(end, ABOUT_END);
        PAST_END.map(|distance| [0, 1, 2].map(|axis| end[axis] + distance * out[axis]))
    }

    /// Balls for so many residues between the ends of a gap: half a wave of a sine on the straight line between them.
    fn bow(&self, from: [f64; 3], to: [f64; 3], missing: i64) -> Vec<[f64; 3]> {
        let middle = [0, 1, 2].map(|axis| 0.5 * (from[axis] + to[axis]));
        let out = self.outward(middle, ABOUT_GAP);
        let half = 0.5 * RISE * (missing + 1) as f64;
        let spare = half * half - 0.25 * squared_distance(from, to);
        let height = (BOWED * spare.max(0.0).sqrt()).min(HIGHEST);
        let balls = missing.min(MOST_BALLS);
        (1..=balls)
            .map(|ball| {
                let along = ball as f64 / (balls + 1) as f64;
                let above = height * (std::f64::consts::PI * along).sin();
                [0, 1, 2]
                    .map(|axis| from[axis] + along * (to[axis] - from[axis]) + above * out[axis])
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
