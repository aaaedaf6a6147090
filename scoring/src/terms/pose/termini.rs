//! Pose term `termini`: contacts of residues near termini and gaps, which cost.
//!
//! These residues are flexible. Their positions in a file are one sample of many, so contacts with them say little.

use super::bodies::{Sides, positions};
use super::{PoseTerm, TermDefinition, UNRELAXED};
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
    build: |inputs, weight| term(inputs.bodies, inputs.termini, weight),
};

/// Minus the weight times the number of atoms near termini that are in contact with the other side.
///
/// `termini` holds the indices of these atoms among the knots of receptor and ligand.
fn term([receptor, ligand]: [&Knots; 2], termini: [&[usize]; 2], weight: f64) -> PoseTerm {
    let atoms = [
        positions(receptor, termini[0]),
        positions(ligand, termini[1]),
    ];
    let sides = Sides::new(receptor, ligand);
    Box::new(move |pose, _| {
        let count = sides.sum_in_contact(&atoms, pose, std::slice::from_ref, |_| 1.0);
        // Without atoms the score is 0, not -0.
        0.0 - weight * count
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::se3::Pose;
    use crate::terms::pose::Workspace;

    /// Four atoms in a row on both sides: the first two of the receptor and the last of the ligand are near termini.
    #[test]
    fn atoms_near_termini_in_contact_are_counted() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let term = term([&knots, &knots], [&[0, 1], &[3]], 2.5);
        let at = |quaternion, x: f64, y: f64| {
            let pose = Pose::from_parts(quaternion, [x, y, 0.0]);
            term(&pose, &mut Workspace::default())
        };
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
        let term = term([&knots, &knots], [&[0], &[]], 2.0);
        let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
        assert_eq!(term(&pose, &mut Workspace::default()), -2.0);
    }
}
