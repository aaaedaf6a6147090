//! Restraint: what contacts cost of atoms that should have none, and earn of atoms that should.
//!
//! A blocked atom pays for every atom of the other side within about 6 Å, an attracted one earns by each, whatever both are: k is that of
//! [`super::contact`], 1 up to 5 Å and falling C-infinity to 0 at 7 Å. Of two marked atoms each has its own. Nothing comes of a contact of
//! free atoms, so a pose that marked atoms have no part in scores as it would without the effect.

use super::{Effect, Label, Term, contact};
use knotdock_structures::Knots;

/// What is wanted of an atom's contacts; as a number its class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ResidueRole {
    /// Nothing.
    #[default]
    Free,
    /// That there be none.
    Excluded,
    /// That there be some.
    Active,
}

impl ResidueRole {
    /// All marks, in the order of their classes.
    const ALL: [Self; 3] = [Self::Free, Self::Excluded, Self::Active];
}

/// What a contact of a marked atom is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// What one of a blocked atom costs: score.
    pub blocked: f64,
    /// What one of an attracted atom earns: score.
    pub attracted: f64,
}

/// The term for two sets of knots with a mark each; knots without one are free.
pub fn term(
    receptor: &Knots,
    ligand: &Knots,
    marks: [&[ResidueRole]; 2],
    weights: Weights,
) -> Term {
    let labels = |knots: &Knots, marks: &[ResidueRole]| {
        (0..knots.len())
            .map(|index| Label {
                class: marks.get(index).copied().unwrap_or_default() as usize,
                value: knots.weights.get(index).copied().unwrap_or(0.0),
            })
            .collect()
    };
    let worth = |mark: ResidueRole| match mark {
        ResidueRole::Free => 0.0,
        ResidueRole::Excluded => -weights.blocked,
        ResidueRole::Active => weights.attracted,
    };
    let row = |own: ResidueRole| {
        ResidueRole::ALL
            .map(|other| worth(own) + worth(other))
            .to_vec()
    };
    let [of_receptor, of_ligand] = marks;
    Term {
        effect: Effect::Restraint,
        radial: contact::RADIAL,
        matrix: ResidueRole::ALL.map(row).to_vec(),
        receptor: labels(receptor, of_receptor),
        ligand: labels(ligand, of_ligand),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every class has its worth as the head says, and the table is the same from either side.
    #[test]
    fn marked_atoms_pay_and_earn_and_free_ones_do_not() {
        let knots = Knots::new(vec![[0.0; 3], [9.0, 0.0, 0.0]], vec![1.7; 2]).unwrap();
        let weights = Weights {
            blocked: 1.5,
            attracted: 4.0,
        };
        let marks = [ResidueRole::Active, ResidueRole::Excluded];
        let term = term(&knots, &knots, [&marks, &[]], weights);
        let classes = |labels: &[Label]| labels.iter().map(|l| l.class).collect::<Vec<_>>();
        assert_eq!(classes(&term.receptor), [2, 1]);
        assert_eq!(classes(&term.ligand), [0, 0]);
        assert_eq!(
            term.matrix,
            [[0.0, -1.5, 4.0], [-1.5, -3.0, 2.5], [4.0, 2.5, 8.0]]
        );
    }
}
