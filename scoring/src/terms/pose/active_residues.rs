//! Pose term `active_residues`: the share of the active residues that are in contact.
//!
//! Active residues are named by the user, or they are the catalytic residues of an enzyme, which may have several
//! active sites.
//!
//! The search draws poses to named residues by the contacts of their atoms ([`crate::terms::effect::restraint`]),
//! because a correlation can count nothing else. One buried residue with many contacts then earns as much as several
//! should. So this term counts residues.

use super::bodies::{Sides, positions};
use super::{TermDefinition, UNRELAXED};
use crate::se3::Pose;
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
        [0, 1].map(|side| {
            inputs
                .active_residues
                .iter()
                .map(|set| set[side].len())
                .sum()
        })
    },
    applies: |inputs| !inputs.active_residues.is_empty(),
    build: |inputs, weight| {
        let [receptor, ligand] = inputs.bodies;
        let sets = inputs.active_residues;
        let term = ActiveResidues::new(receptor, ligand, sets, weight);
        Box::new(move |pose, _| term.score(pose))
    },
};

/// Active residues of receptor and ligand, each as the indices of its knots.
pub type Residues = [Vec<Vec<usize>>; 2];

/// Two bodies prepared for counting the active residues in contact.
struct ActiveResidues {
    /// Sets of residues of receptor and ligand, each residue as the positions of its atoms (Å).
    sets: Vec<[Vec<Positions>; 2]>,
    sides: Sides,
    weight: f64,
}

/// Positions of the atoms of a residue (Å).
type Positions = Vec<[f64; 3]>;

impl ActiveResidues {
    /// Prepares two sets of knots. `weight` is the score of a pose in which all residues of one set are in contact.
    fn new(receptor: &Knots, ligand: &Knots, sets: &[Residues], weight: f64) -> Self {
        let of = |knots: &Knots, residues: &[Vec<usize>]| -> Vec<Positions> {
            residues
                .iter()
                .map(|residue| positions(knots, residue))
                .collect()
        };
        let sets = sets.iter();
        Self {
            sets: sets
                .map(|[own, other]| [of(receptor, own), of(ligand, other)])
                .collect(),
            sides: Sides::new(receptor, ligand),
            weight,
        }
    }

    /// Weight times the share of a set's residues that are in contact at a pose, of the set with the largest share.
    fn score(&self, pose: &Pose) -> f64 {
        let shares = self.sets.iter().map(|[receptor, ligand]| {
            let count = self
                .sides
                .sum_in_contact([receptor, ligand], pose, |atoms| atoms, |_| 1.0);
            count / (receptor.len() + ligand.len()).max(1) as f64
        });
        self.weight * shares.fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Atoms at 10, 20, 30 and 40 Å on both sides. A residue counts once, however many of its atoms are in contact.
    #[test]
    fn residues_in_contact_are_counted() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let residues = [vec![vec![0], vec![2, 3]], vec![vec![1]]];
        let term = ActiveResidues::new(&knots, &knots, &[residues], 300.0);
        let at =
            |quaternion, x: f64, y: f64| term.score(&Pose::from_parts(quaternion, [x, y, 0.0]));
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

    /// Of several sites the one with the largest share counts; shares of different sites do not add up.
    #[test]
    fn one_set_of_several_is_enough() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let ligand = Knots::new(vec![[0.0; 3], [10.0, 0.0, 0.0]], vec![1.9; 2]).unwrap();
        let set = |first: usize, second: usize| [vec![vec![first], vec![second]], Vec::new()];
        let sets = [set(0, 1), set(2, 3)];
        let term = ActiveResidues::new(&knots, &ligand, &sets, 300.0);
        let at = |x: f64| term.score(&Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 3.0, 0.0]));
        assert_eq!(at(10.0), 300.0);
        assert_eq!(at(30.0), 300.0);
        assert_eq!(at(20.0), 150.0);
        assert_eq!(at(40.0), 150.0);
        assert_eq!(at(60.0), 0.0);
    }
}
