//! Pose term `restraints_penalty`: what a pose pays for the distance restraints that it violates.
//!
//! A restraint is on the effective distance of its pairs of atoms ([`super::effective_distance`]). It is satisfied
//! within its bounds, and violated by what the distance misses them by. Where some restraints may be false, only so
//! many of them have to be satisfied: those that are violated least count, and the others are free.
//!
//! The penalty grows in proportion to the violation. A pose of the search may be 2 to 4 Å from the nearest sampled
//! one, so that a penalty by squares would refuse poses for the coarseness of the search.

use super::{PoseTerm, TermDefinition, UNRELAXED, Workspace};
use crate::se3::Pose;
use crate::terms::weight::Weight;
use knotdock_structures::Knots;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "restraints_penalty",
    label: "distance restraints",
    weight: Weight {
        option: "violation-weight",
        help: "Cost of each Å by which a pose violates the distance restraints",
        unit: "score per Å",
        default: 400.0,
    },
    time_share: UNRELAXED,
    is_shown_always: false,
    reads: "restraints",
    count: |inputs| [inputs.distance_restraints.list.len(); 2],
    applies: |inputs| !inputs.distance_restraints.list.is_empty(),
    build: |inputs, weight| {
        Box::new(RestraintPenalty {
            restraints: inputs.distance_restraints.clone(),
            positions: inputs.bodies.map(|knots: &Knots| knots.centers.clone()),
            weight,
        })
    },
};

/// A restraint on the effective distance between atoms of the receptor and atoms of the ligand.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceRestraint {
    /// Alternatives, each as indices of atoms of receptor and ligand. Every atom of the one set pairs with every atom
    /// of the other. A pair of atoms that is in two alternatives counts twice.
    pub pairs: Vec<[Vec<usize>; 2]>,
    /// Smallest effective distance that satisfies it, in Å.
    pub lower: f64,
    /// Largest effective distance that satisfies it, in Å.
    pub upper: f64,
}

/// Restraints of which so many have to be satisfied.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DistanceRestraints {
    /// The restraints.
    pub list: Vec<DistanceRestraint>,
    /// How many of them; no more than there are.
    pub needed: usize,
}

/// No restraints.
static NONE: DistanceRestraints = DistanceRestraints {
    list: Vec::new(),
    needed: 0,
};

impl DistanceRestraints {
    /// No restraints.
    pub fn none() -> &'static Self {
        &NONE
    }
}

/// Two bodies prepared for the penalty.
struct RestraintPenalty {
    restraints: DistanceRestraints,
    /// Positions of the atoms of receptor and ligand, each in its own file (Å).
    positions: [Vec<[f64; 3]>; 2],
    weight: f64,
}

impl PoseTerm for RestraintPenalty {
    fn score(&self, pose: &Pose, workspace: &mut Workspace) -> f64 {
        let [receptor, ligand] = &self.positions;
        let violations = &mut workspace.violations;
        violations.clear();
        violations.extend(self.restraints.list.iter().map(|restraint| {
            restraint.violation(restraint.effective_distance(receptor, ligand, pose))
        }));
        violations.sort_unstable_by(f64::total_cmp);
        let counted = violations.iter().take(self.restraints.needed);
        // Without violations the score is 0, not -0.
        0.0 - self.weight * counted.sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three restraints of 2 to 5 Å between single atoms.
    #[test]
    fn the_least_violations_count() {
        let restraint = |atom: usize| DistanceRestraint {
            pairs: vec![[vec![atom], vec![0]]],
            lower: 2.0,
            upper: 5.0,
        };
        let term = |needed: usize| RestraintPenalty {
            restraints: DistanceRestraints {
                list: [2, 0, 1].map(restraint).to_vec(),
                needed,
            },
            positions: [
                vec![[0.0; 3], [0.0, 10.0, 0.0], [0.0, 20.0, 0.0]],
                vec![[0.0; 3]],
            ],
            weight: 2.0,
        };
        let at = |needed: usize, x: f64| {
            let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
            term(needed).score(&pose, &mut Workspace::default())
        };
        // At 0, 10 and 20 Å: 2 Å too near, 5 and 15 Å too far.
        for (needed, violation) in [(1, 2.0), (2, 7.0), (3, 22.0)] {
            assert!((at(needed, 0.0) + 2.0 * violation).abs() < 1e-12);
        }
        let satisfied = at(1, 3.0);
        assert!(satisfied == 0.0 && satisfied.is_sign_positive());
    }
}
