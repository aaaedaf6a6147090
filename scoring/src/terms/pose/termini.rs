//! Pose term `termini`: contacts of residues near termini and gaps, which cost.
//!
//! These residues are flexible. Their positions in a file are one sample of many, so contacts with them say little.

use super::bodies::{Sides, positions};
use super::{TermDefinition, UNRELAXED};
use crate::se3::Pose;
use knotdock_structures::Knots;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "termini",
    label: "termini",
    unit: "score",
    time_share: UNRELAXED,
    is_shown_always: true,
    reads: "atoms near termini and gaps",
    count: |inputs| inputs.termini.map(<[_]>::len),
    applies: |inputs| inputs.termini.iter().any(|side| !side.is_empty()),
    build: |inputs, weight| {
        let [receptor, ligand] = inputs.bodies;
        let termini = inputs.termini;
        let term = TerminusContacts::new(receptor, ligand, termini, weight);
        Box::new(move |pose, _| term.score(pose))
    },
};

/// Two bodies prepared for counting the atoms near termini that are in contact.
struct TerminusContacts {
    /// Positions of the atoms near termini of receptor and ligand, each in its own frame (Å).
    termini: [Vec<[f64; 3]>; 2],
    sides: Sides,
    weight: f64,
}

impl TerminusContacts {
    /// Prepares two sets of knots. `termini` holds the indices of the knots near termini, and `weight` is the cost of
    /// one in contact.
    fn new(receptor: &Knots, ligand: &Knots, termini: [&[usize]; 2], weight: f64) -> Self {
        Self {
            termini: [
                positions(receptor, termini[0]),
                positions(ligand, termini[1]),
            ],
            sides: Sides::new(receptor, ligand),
            weight,
        }
    }

    /// Minus the weight times the number of atoms near termini that are in contact with the other side.
    fn score(&self, pose: &Pose) -> f64 {
        let atoms = self.termini.each_ref().map(Vec::as_slice);
        let count = self
            .sides
            .sum_in_contact(atoms, pose, std::slice::from_ref, |_| 1.0);
        // Without atoms the score is 0, not -0.
        0.0 - self.weight * count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four atoms in a row on both sides: the first two of the receptor and the last of the ligand are near termini.
    #[test]
    fn atoms_near_termini_in_contact_are_counted() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let term = TerminusContacts::new(&knots, &knots, [&[0, 1], &[3]], 2.5);
        let at =
            |quaternion, x: f64, y: f64| term.score(&Pose::from_parts(quaternion, [x, y, 0.0]));
        let straight = [1.0, 0.0, 0.0, 0.0];
        assert_eq!(at(straight, 0.0, 4.9), -7.5);
        assert_eq!(at(straight, 0.0, 5.1), 0.0);
        assert!(at(straight, 0.0, 5.1).is_sign_positive());
        // One place on: the receptor's second atom meets the ligand's first, and the ligand's last nothing.
        assert_eq!(at(straight, 10.0, 3.0), -2.5);
        // Half a turn about z and 50 Å bring the atoms back in reverse, so that the ligand's last meets the
        // receptor's first.
        assert_eq!(at([0.0, 0.0, 0.0, 1.0], 50.0, 0.0), -7.5);
        // Half way between them all none is touched.
        assert_eq!(at(straight, 5.0, 1.0), 0.0);
    }

    #[test]
    fn an_atom_counts_once_however_many_it_touches() {
        let knots = Knots::new(vec![[0.0; 3], [2.0, 0.0, 0.0]], vec![1.9; 2]).unwrap();
        let term = TerminusContacts::new(&knots, &knots, [&[0], &[]], 2.0);
        let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
        assert_eq!(term.score(&pose), -2.0);
    }
}
