//! Effect `restraint`: contacts of excluded atoms cost, and contacts of active atoms earn.
//!
//! Every atom of the other side within about 6 Å counts, whatever its type: k is that of [`super::contact`], 1 up to
//! 5 Å and 0 from 7 Å on. The scores of two atoms with roles add up. Contacts of free atoms score nothing, so a pose
//! without contacts of other atoms scores as without the effect.

use super::{Effect, EffectDefinition, Label, Term, contact};
use knotdock_structures::Knots;

/// Definition of the effect.
pub(super) const EFFECT: EffectDefinition = EffectDefinition {
    id: "restraint",
    of_meshes: "meshes have no residues",
    components: 1.0,
    lacks: |inputs| {
        let mut roles = inputs.roles.into_iter().flatten();
        let all_free = roles.all(|role| *role == ResidueRole::Free);
        all_free.then(|| "no option names residues, and no antibody is kept to its CDRs".to_owned())
    },
    reason: |inputs| inputs.roles_reason.to_owned(),
    term: |[receptor, ligand], inputs, weight| {
        let weights = Weights {
            excluded: weight,
            active: inputs.active_weight,
        };
        Some(term(receptor, ligand, inputs.roles, weights))
    },
};

/// Role of an atom in contacts; as a number, its class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ResidueRole {
    /// Its contacts do not count.
    #[default]
    Free,
    /// It should have no contact.
    Excluded,
    /// It should be in contact.
    Active,
}

impl ResidueRole {
    /// All roles, in the order of their classes.
    const ALL: [Self; 3] = [Self::Free, Self::Excluded, Self::Active];
}

/// Scores of the contacts of atoms with a role.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Cost of a contact of an excluded atom: score.
    pub excluded: f64,
    /// Score of a contact of an active atom.
    pub active: f64,
}

/// Term of two sets of knots with the roles of their knots; knots without one are free.
pub fn term(
    receptor: &Knots,
    ligand: &Knots,
    roles: [&[ResidueRole]; 2],
    weights: Weights,
) -> Term {
    let labels = |knots: &Knots, roles: &[ResidueRole]| {
        (0..knots.len())
            .map(|index| Label {
                class: roles.get(index).copied().unwrap_or_default() as usize,
                value: knots.weights.get(index).copied().unwrap_or(0.0),
            })
            .collect()
    };
    let score = |role: ResidueRole| match role {
        ResidueRole::Free => 0.0,
        ResidueRole::Excluded => -weights.excluded,
        ResidueRole::Active => weights.active,
    };
    let row = |own: ResidueRole| {
        ResidueRole::ALL
            .map(|other| score(own) + score(other))
            .to_vec()
    };
    let [of_receptor, of_ligand] = roles;
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

    /// Each class has its score, and the matrix is symmetric.
    #[test]
    fn excluded_atoms_cost_and_active_ones_earn_and_free_ones_do_not() {
        let knots = Knots::new(vec![[0.0; 3], [9.0, 0.0, 0.0]], vec![1.7; 2]).unwrap();
        let weights = Weights {
            excluded: 1.5,
            active: 4.0,
        };
        let roles = [ResidueRole::Active, ResidueRole::Excluded];
        let term = term(&knots, &knots, [&roles, &[]], weights);
        let classes = |labels: &[Label]| labels.iter().map(|l| l.class).collect::<Vec<_>>();
        assert_eq!(classes(&term.receptor), [2, 1]);
        assert_eq!(classes(&term.ligand), [0, 0]);
        assert_eq!(
            term.matrix,
            [[0.0, -1.5, 4.0], [-1.5, -3.0, 2.5], [4.0, 2.5, 8.0]]
        );
    }
}
