//! Pose term `fine_contact`: a contact potential in three ranges of distance.

use super::bodies::Bodies;
use super::distance_binned_potential::{DistanceBinnedPotential, ENDS, step_down};
use super::{PoseTerm, TermDefinition, UNRELAXED, Workspace};
use crate::se3::Pose;
use crate::terms::effect::contact::TYPES;
use crate::terms::weight::Weight;
use knotdock_structures::Knots;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "fine_contact",
    label: "fine contacts",
    weight: Weight {
        option: "fine-contact-weight",
        help: "Weight of the fine contact potential, which scores poses where the contact effect is on",
        unit: "score per RT",
        default: 2.0,
    },
    time_share: UNRELAXED,
    is_shown_always: true,
    reads: "atoms with contact types",
    count: |inputs| {
        inputs
            .bodies
            .map(|knots| knots.contact_types.iter().flatten().count())
    },
    applies: |inputs| inputs.has_contact_types(),
    build: |inputs, weight| {
        let [receptor, ligand] = inputs.bodies;
        let potential = inputs.fine_contact_potential.cloned().unwrap_or_default();
        Box::new(FineContacts::new(receptor, ligand, &potential, weight))
    },
};

/// Distance in Å from which nothing counts.
const REACH: f64 = ENDS[2][1];

/// Two bodies prepared for summing minus the weighted potential over their contacts.
///
/// Two atoms of types a and c at distance d score `-weight sum_b E_b[a][c] (s_b(d) - s_{b-1}(d))` over the ranges b.
/// s_b is the step that ends range b, and s_{-1} = 0. Atoms without a type do not count.
pub struct FineContacts {
    bodies: Bodies,
    /// Factor of each step s_b, -weight (E_b - E_{b+1}): `[receptor type][ligand type][range]`.
    steps: Vec<[[f64; 3]; TYPES.len()]>,
}

impl FineContacts {
    /// Prepares two sets of knots with contact types. `weight` is in score per RT.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        potential: &DistanceBinnedPotential,
        weight: f64,
    ) -> Self {
        let energy = |range: usize, a: usize, b: usize| {
            potential
                .ranges
                .get(range)
                .map_or(0.0, |table| table.energy(a, b))
        };
        let steps = (0..TYPES.len()).map(|a| {
            std::array::from_fn(|b| {
                std::array::from_fn(|range| {
                    -weight * (energy(range, a, b) - energy(range + 1, a, b))
                })
            })
        });
        Self {
            bodies: Bodies::new(receptor, ligand, |knots| &knots.contact_types, TYPES.len()),
            steps: steps.collect(),
        }
    }

    /// Weighted sum at a pose of the ligand; higher is better.
    pub fn score(&self, pose: &Pose) -> f64 {
        self.bodies.sum(
            pose,
            REACH,
            #[inline(always)]
            |a, b, distance| {
                let [first, second, third] = self.steps[a][b];
                first * step_down(distance, ENDS[0])
                    + second * step_down(distance, ENDS[1])
                    + third * step_down(distance, ENDS[2])
            },
        )
    }
}

impl PoseTerm for FineContacts {
    fn score(&self, pose: &Pose, _: &mut Workspace) -> f64 {
        self.score(pose)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::pose::RANGES;

    /// Two atoms in the middle of a range have its energy, and between two ranges a part of both. Beyond the reach
    /// there is none.
    #[test]
    fn one_pair_has_the_energy_of_its_range() {
        let potential = DistanceBinnedPotential::default();
        let one = |kind: u8| {
            let knots = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
            knots.with_labels(Vec::new(), vec![Some(kind)]).unwrap()
        };
        let contacts = FineContacts::new(&one(6), &one(8), &potential, 3.0);
        let at = |x: f64| contacts.score(&Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]));
        let energy = |range: usize| potential.ranges[range].energy(6, 8);
        for (range, distance) in [3.0, 4.75, 6.5].into_iter().enumerate() {
            assert!(
                (at(distance) + 3.0 * energy(range)).abs() < 1e-12,
                "{}",
                RANGES[range]
            );
        }
        for index in 0..800 {
            let distance = 0.01 * f64::from(index);
            let [near, middle, far] = ENDS.map(|ends| step_down(distance, ends));
            let expected =
                near * energy(0) + (middle - near) * energy(1) + (far - middle) * energy(2);
            assert!((at(distance) + 3.0 * expected).abs() < 1e-12, "{distance}");
        }
        assert_eq!([at(8.0), at(500.0), at(-1e9)], [0.0; 3]);
    }

    /// Every pair of types has its own energies, whichever body has which.
    #[test]
    fn every_pair_of_types_has_its_own_energies() {
        let potential = DistanceBinnedPotential::default();
        let one = |kind: usize| {
            let knots = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
            knots
                .with_labels(Vec::new(), vec![Some(kind as u8)])
                .unwrap()
        };
        for a in 0..TYPES.len() {
            for b in 0..TYPES.len() {
                let contacts = FineContacts::new(&one(a), &one(b), &potential, 1.0);
                for (range, x) in [3.0, 4.75, 6.5].into_iter().enumerate() {
                    let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
                    let energy = potential.ranges[range].energy(a, b);
                    assert!((contacts.score(&pose) + energy).abs() < 1e-12, "{a} {b}");
                }
            }
        }
    }

    #[test]
    fn no_typed_atom_scores_nothing() {
        let bare = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
        let contacts = FineContacts::new(&bare, &bare, &DistanceBinnedPotential::default(), 1.0);
        assert_eq!(contacts.score(&Pose::identity()), 0.0);
    }
}
