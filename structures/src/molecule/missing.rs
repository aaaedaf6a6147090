//! Residues that a chain has and its file does not show: where they may be, as balls of a residue's volume, 134 Å³ or a radius of 3.2 Å (the mean
//! over proteins of the volumes of Zamyatnin, Prog. Biophys. Mol. Biol. 24 (1972) 107-123).
//!
//! A loop that was not seen bridges a gap in the chain, and the ends of chains move or go on unseen; what is docked there meets them. So balls
//! stand for them: in a gap as many as residues are missing, along a bow from end to end that leans away from the body, and two past each end of
//! a chain, straight away from it. They are where such residues may be, not where they are.

use serde::{Serialize, Serializer};

use super::cells::Cells;
use super::chains::Gap;
use super::groups::residues;
use super::{Molecule, squared_distance};

/// Distance in Å of the first ball past an end from its N or C, where the next CA would be, and of the second.
const PAST_END: [f64; 2] = [2.5, 6.0];

/// Length of chain in Å that a residue adds to a bow.
const RISE: f64 = 3.4;

/// Most balls in a bow, its share of the height that its length allows, and its greatest height in Å: longer loops fold back.
const MOST_BALLS: i64 = 20;
const BOWED: f64 = 0.6;
const HIGHEST: f64 = 10.0;

/// Distances in Å within which atoms tell where the body lies, of an end and of a gap's middle.
const ABOUT_END: f64 = 12.0;
const ABOUT_GAP: f64 = 15.0;

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
    #[serde(rename = "balls", serialize_with = "length")]
    pub centers: Vec<[f64; 3]>,
}

/// A record says how many there are of a list, not what.
pub(super) fn length<T, S: Serializer>(list: &[T], to: S) -> Result<S::Ok, S::Error> {
    list.len().serialize(to)
}

impl Molecule {
    /// Residues that the chains must have and the file does not show, as far as atoms and residue numbers tell.
    pub fn missing_residues(&self) -> MissingResidues {
        let groups = residues(&self.atoms);
        let chains = self.chains(&groups);
        let body = Body::new(self);
        let mut found = MissingResidues::default();
        for gap in chains.iter().flat_map(|chain| &chain.gaps) {
            found.gaps += 1;
            found.residues += gap.missing as usize;
            found.centers.extend(body.bow(gap));
        }
        for chain in chains.iter().filter(|chain| !chain.is_short()) {
            for end in chain.ends.into_iter().flatten() {
                found.ends += 1;
                found.centers.extend(body.past(end));
            }
        }
        found
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

    /// Balls for the residues of a gap: half a wave of a sine on the straight line between its sides.
    fn bow(&self, gap: &Gap) -> Vec<[f64; 3]> {
        let [from, to] = gap.sides;
        let middle = [0, 1, 2].map(|axis| 0.5 * (from[axis] + to[axis]));
        let out = self.outward(middle, ABOUT_GAP);
        let half = 0.5 * RISE * (gap.missing + 1) as f64;
        let spare = half * half - 0.25 * squared_distance(from, to);
        let height = (BOWED * spare.max(0.0).sqrt()).min(HIGHEST);
        let balls = gap.missing.min(MOST_BALLS);
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
