//! Pose term `atom_pair`: a potential over pairs of atoms by kind and distance.

use super::atom_pair_potential::AtomPairPotential;
use super::bodies::Bodies;
use super::energy_table::{EnergyTable, REACH};
use super::{PoseTerm, TermDefinition, UNRELAXED, Workspace};
use crate::se3::Pose;
use crate::terms::weight::Weight;
use knotdock_structures::Knots;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "atom_pair",
    label: "atom pairs",
    weight: Weight {
        option: "atom-pair-weight",
        help: "Weight of the atom pair potential, which scores poses where the contact effect is on",
        unit: "score per RT",
        default: 1.0,
    },
    time_share: UNRELAXED,
    is_shown_always: true,
    reads: "atoms with kinds",
    count: |inputs| inputs.atoms_with_kinds(),
    applies: |inputs| inputs.has_atom_kinds(),
    build: |inputs, weight| {
        let [receptor, ligand] = inputs.bodies;
        let potential = inputs.atom_pair_potential.cloned().unwrap_or_default();
        Box::new(AtomPairs::new(receptor, ligand, &potential, weight))
    },
};

/// Two bodies prepared for summing minus the weighted atom pair potential.
///
/// Two atoms of kinds a and b at distance d score `-weight E_ab(d)`. E_ab joins the table's energies by straight
/// lines. It is constant below the first distance and falls to 0 over one step after the last. Atoms without a kind
/// do not count.
pub struct AtomPairs {
    bodies: Bodies,
    energies: EnergyTable,
    weight: f64,
}

impl AtomPairs {
    /// Prepares two sets of knots with atom kinds. `weight` is in score per RT.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        potential: &AtomPairPotential,
        weight: f64,
    ) -> Self {
        let energies = EnergyTable::new(potential);
        Self {
            bodies: Bodies::new(
                receptor,
                ligand,
                |knots| &knots.atom_kinds,
                energies.unknown(),
            ),
            energies,
            weight,
        }
    }

    /// Weighted sum at a pose of the ligand; higher is better.
    pub fn score(&self, pose: &Pose) -> f64 {
        let sum = self.bodies.sum(
            pose,
            REACH,
            #[inline(always)]
            |a, b, distance| self.energies.at(a, b, distance).0,
        );
        -self.weight * sum
    }
}

impl PoseTerm for AtomPairs {
    fn score(&self, pose: &Pose, _: &mut Workspace) -> f64 {
        self.score(pose)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::pose::{DISTANCES, STEP, atom_kinds};

    /// Every pair of kinds has the table's energy, whichever body carries which kind.
    #[test]
    fn every_pair_of_kinds_has_its_own_energies() {
        let potential = AtomPairPotential::default();
        let kinds = atom_kinds().len();
        let of = |kinds: std::ops::Range<usize>| {
            let centers = kinds.clone().map(|kind| [100.0 * kind as f64, 0.0, 0.0]);
            Knots::new(centers.collect(), vec![1.7; kinds.len()])
                .unwrap()
                .with_atom_kinds(kinds.map(|kind| Some(kind as u8)).collect())
                .unwrap()
        };
        let all = of(0..kinds);
        for b in 0..kinds {
            let pairs = AtomPairs::new(&all, &of(b..b + 1), &potential, 1.0);
            for a in 0..kinds {
                let x = 100.0 * (a as f64 - b as f64) + DISTANCES[2];
                let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
                let energy = f64::from(potential.energies(a, b)[2]);
                assert!((pairs.score(&pose) + energy).abs() < 1e-9, "{a} {b}");
            }
        }
    }

    /// Two atoms at each of the table's distances have its energy, and nearer ones the first. Beyond the reach there
    /// is none.
    #[test]
    fn one_pair_has_the_energy_of_its_distance() {
        let potential = AtomPairPotential::default();
        let one = |kind: u8| {
            let knots = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
            knots.with_atom_kinds(vec![Some(kind)]).unwrap()
        };
        let pairs = AtomPairs::new(&one(6), &one(18), &potential, 3.0);
        let at = |x: f64| pairs.score(&Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]));
        let energies = potential.energies(6, 18);
        for (distance, energy) in DISTANCES.iter().zip(energies) {
            assert!((at(*distance) + 3.0 * f64::from(*energy)).abs() < 1e-12);
        }
        // Straight lines between: the hats of the nodes add up to the sum.
        for index in 0..650 {
            let distance = 0.01 * f64::from(index);
            let hat = |node: usize| {
                let from = (distance - DISTANCES[node]) / STEP;
                if node == 0 && from < 0.0 {
                    1.0
                } else {
                    (1.0 - from.abs()).max(0.0)
                }
            };
            let expected: f64 = (0..DISTANCES.len())
                .map(|node| hat(node) * f64::from(energies[node]))
                .sum();
            assert!((at(distance) + 3.0 * expected).abs() < 1e-10, "{distance}");
        }
        assert_eq!(at(0.0), at(DISTANCES[0]));
        let last = f64::from(energies[DISTANCES.len() - 1]);
        assert!((at(REACH - 0.5 * STEP) + 1.5 * last).abs() < 1e-9);
        assert_eq!([at(REACH), at(500.0), at(-1e9)].map(f64::abs), [0.0; 3]);
    }
}
