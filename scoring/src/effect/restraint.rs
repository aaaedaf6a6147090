//! Restraint: what contacts of atoms cost that should have none.
//!
//! A blocked atom pays for every atom of the other side within about 6 Å, whatever both are: k is that of [`super::contact`], 1 up to 5 Å
//! and falling C-infinity to 0 at 7 Å. Two blocked atoms pay for both. Nothing is paid for a contact of free atoms, so a pose that blocked
//! atoms have no part in scores as it would without the effect.

use super::{Effect, Label, Term, contact};
use knotdock_structures::Knots;

/// Classes of an atom: free, blocked.
const FREE: usize = 0;
const BLOCKED: usize = 1;

/// The term for two sets of knots of which those marked are blocked: minus `weight` for each contact of a blocked knot with one of the other
/// side. Marks that are missing are of free knots.
pub fn term(receptor: &Knots, ligand: &Knots, blocked: [&[bool]; 2], weight: f64) -> Term {
    let labels = |knots: &Knots, blocked: &[bool]| {
        (0..knots.len())
            .map(|index| Label {
                class: if blocked.get(index) == Some(&true) {
                    BLOCKED
                } else {
                    FREE
                },
                value: knots.weights.get(index).map_or(0.0, |weight| weight.re),
            })
            .collect()
    };
    let [own, other] = blocked;
    let mut matrix = vec![vec![0.0; 2]; 2];
    matrix[BLOCKED][FREE] = -weight;
    matrix[FREE][BLOCKED] = -weight;
    matrix[BLOCKED][BLOCKED] = -2.0 * weight;
    Term {
        effect: Effect::Restraint,
        radial: contact::RADIAL,
        matrix,
        receptor: labels(receptor, own),
        ligand: labels(ligand, other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every class pays as the head says, and the table is the same from either side.
    #[test]
    fn blocked_atoms_pay_and_free_ones_do_not() {
        let knots = Knots::new(vec![[0.0; 3], [9.0, 0.0, 0.0]], vec![1.7; 2]).unwrap();
        let term = term(&knots, &knots, [&[false, true], &[]], 1.5);
        let classes = |labels: &[Label]| labels.iter().map(|l| l.class).collect::<Vec<_>>();
        assert_eq!(classes(&term.receptor), [FREE, BLOCKED]);
        assert_eq!(classes(&term.ligand), [FREE, FREE]);
        assert_eq!(term.matrix, [[0.0, -1.5], [-1.5, -3.0]]);
    }
}
