//! Pose term `active_residues`: the share of the active residues that are in contact.
//!
//! Active residues are named by the user, or they are the catalytic residues of an enzyme, which may have several
//! active sites.
//!
//! The search draws poses to named residues by the contacts of their atoms ([`crate::terms::effect::restraint`]),
//! because a correlation can count nothing else. One buried residue with many contacts then earns as much as several
//! should. So this term counts residues.

use super::bodies::{Sides, positions};
use super::{PoseTerm, TermDefinition, UNRELAXED};
use knotdock_structures::Knots;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "active_residues",
    label: "active residues",
    unit: "score",
    time_share: UNRELAXED,
    is_shown_always: true,
    reads: "residues",
    count: |inputs| {
        let sets = inputs.active_residues;
        [0, 1].map(|side| sets.iter().map(|set| set[side].len()).sum())
    },
    applies: |inputs| !inputs.active_residues.is_empty(),
    build: |inputs, weight| term(inputs.bodies, inputs.active_residues, weight),
};

/// Active residues of receptor and ligand, each as the indices of its knots.
pub type Residues = [Vec<Vec<usize>>; 2];

/// Weight times the share of a set's residues that are in contact, of the set with the largest share.
fn term([receptor, ligand]: [&Knots; 2], sets: &[Residues], weight: f64) -> PoseTerm {
    let of = |knots: &Knots, residues: &[Vec<usize>]| -> Vec<Vec<[f64; 3]>> {
        let residues = residues.iter();
        residues.map(|atoms| positions(knots, atoms)).collect()
    };
    let sets = sets.iter();
    let sets = sets.map(|[own, other]| [of(receptor, own), of(ligand, other)]);
    let sets: Vec<_> = sets.collect();
    let sides = Sides::new(receptor, ligand);
    Box::new(move |pose, _| {
        let shares = sets.iter().map(|set| {
            let count = sides.sum_in_contact(set, pose, |atoms| atoms, |_| 1.0);
            count / (set[0].len() + set[1].len()).max(1) as f64
        });
        weight * shares.fold(0.0, f64::max)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::se3::Pose;
    use crate::terms::pose::Workspace;

    /// Atoms at 10, 20, 30 and 40 Å on both sides. A residue counts once, however many of its atoms are in contact.
    #[test]
    fn residues_in_contact_are_counted() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let residues = [vec![vec![0], vec![2, 3]], vec![vec![1]]];
        let term = term([&knots, &knots], &[residues], 300.0);
        let at = |quaternion, x: f64, y: f64| {
            let pose = Pose::from_parts(quaternion, [x, y, 0.0]);
            term(&pose, &mut Workspace::default())
        };
        let straight = [1.0, 0.0, 0.0, 0.0];
        assert_eq!(at(straight, 0.0, 4.9), 300.0);
        assert_eq!(at(straight, 0.0, 5.1), 0.0);
        // The ligand's first two atoms lie over the receptor's last two.
        assert_eq!(at(straight, 20.0, 3.0), 200.0);
        assert_eq!(at(straight, 30.0, 3.0), 100.0);
        // Half a turn about z takes atoms to -10 ... -40 Å, and 50 Å bring them back in reverse.
        assert_eq!(at([0.0, 0.0, 0.0, 1.0], 50.0, 3.0), 300.0);
        assert_eq!(at([0.0, 0.0, 0.0, 1.0], 20.0, 3.0), 100.0);
    }

    /// If there are several sites, the one with the largest share counts; shares of different sites do not add up.
    #[test]
    fn one_set_of_several_is_enough() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let ligand = Knots::new(vec![[0.0; 3], [10.0, 0.0, 0.0]], vec![1.9; 2]).unwrap();
        let set = |first: usize, second: usize| [vec![vec![first], vec![second]], Vec::new()];
        let sets = [set(0, 1), set(2, 3)];
        let term = term([&knots, &ligand], &sets, 300.0);
        let at = |x: f64| {
            let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 3.0, 0.0]);
            term(&pose, &mut Workspace::default())
        };
        assert_eq!(at(10.0), 300.0);
        assert_eq!(at(30.0), 300.0);
        assert_eq!(at(20.0), 150.0);
        assert_eq!(at(40.0), 150.0);
        assert_eq!(at(60.0), 0.0);
    }
}
