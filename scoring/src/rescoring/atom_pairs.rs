//! The sum of the atom pair potential over two bodies.

use super::bodies::Bodies;
use super::energy_table::{EnergyTable, REACH};
use super::pair_potential::AtomPairPotential;
use crate::se3::Pose;
use knotdock_structures::Knots;

/// Two bodies prepared for the sum of minus the weighted atom pair potential.
///
/// A pair of atoms of kinds a and b at distance d scores `-weight E_ab(d)`: the table's energies joined by straight lines, before the first the first, and
/// from the last one falling to 0 over one step. Atoms without a kind take no part.
pub struct AtomPairs {
    bodies: Bodies,
    energies: EnergyTable,
    weight: f64,
}

impl AtomPairs {
    /// Prepares two sets of knots with kinds of atoms; `weight` is score per RT.
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

    /// The weighted sum at a pose of the ligand; higher is better.
    pub fn score(&self, pose: &Pose) -> f64 {
        let sum = self.bodies.sum(pose, REACH, |a, b, distance| {
            self.energies.at(a, b, distance).0
        });
        -self.weight * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rescoring::{DISTANCES, STEP, atom_kinds};

    /// Every pair of kinds has the table's energy for it, whichever body has which: one atom of each kind, far from one another, meets
    /// one of each.
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

    /// Two atoms at each of the table's distances have its energy, nearer ones the first; beyond the reach there is none.
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
