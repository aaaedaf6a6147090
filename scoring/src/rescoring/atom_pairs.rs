//! The sum of the atom pair potential over two bodies.

use super::cells::{Atom, Cells, typed};
use super::pair_potential::{AtomPairPotential, DISTANCES, STEP, atom_kinds};
use crate::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::Vector3;

/// Distance in Å from which nothing counts: a step beyond the last that the table has.
const REACH: f64 = DISTANCES[DISTANCES.len() - 1] + STEP;
/// Energies of a pair of kinds in memory: those of the table, then zeros.
const NODES: usize = 8;

/// Two bodies prepared for the sum of minus the weighted atom pair potential.
///
/// A pair of atoms of kinds a and b at distance d scores `-weight E_ab(d)`: the table's energies joined by straight lines, before the first the first, and
/// from the last one falling to 0 over one step. Atoms without a kind take no part.
pub struct AtomPairs {
    receptor: Cells,
    receptor_center: Vector3<f64>,
    ligand: Vec<Atom>,
    ligand_center: Vector3<f64>,
    /// Energies, `[receptor kind][ligand kind]`: one half of a cache line a pair.
    energies: Vec<[f32; NODES]>,
    kinds: usize,
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
        let kinds = atom_kinds().len();
        let (atoms, receptor_center) = typed(receptor, &receptor.atom_kinds, kinds);
        let (ligand, ligand_center) = typed(ligand, &ligand.atom_kinds, kinds);
        let energies = (0..kinds)
            .flat_map(|a| (0..kinds).map(move |b| (a, b)))
            .map(|(a, b)| {
                let mut nodes = [0.0; NODES];
                nodes[..DISTANCES.len()].copy_from_slice(potential.energies(a, b));
                nodes
            })
            .collect();
        Self {
            receptor: Cells::new(atoms),
            receptor_center,
            ligand,
            ligand_center,
            energies,
            kinds,
            weight,
        }
    }

    /// The weighted sum at a pose of the ligand; higher is better.
    pub fn score(&self, pose: &Pose) -> f64 {
        let matrix = pose.rotation.to_rotation_matrix();
        let place = pose.rotation * self.ligand_center + pose.translation - self.receptor_center;
        let mut total = 0.0;
        for atom in &self.ligand {
            let mut sum = 0.0;
            let position = matrix * atom.position + place;
            self.receptor.near(position, REACH, |other, square| {
                let nodes = &self.energies[other.kind * self.kinds + atom.kind];
                sum += between(nodes, square.sqrt());
            });
            total += sum;
        }
        -self.weight * total
    }
}

/// The energy at a distance below the reach, in RT.
#[inline]
fn between(nodes: &[f32; NODES], distance: f64) -> f64 {
    let place = ((distance - DISTANCES[0]) / STEP).max(0.0);
    let node = (place as usize).min(NODES - 2);
    let (low, high) = (f64::from(nodes[node]), f64::from(nodes[node + 1]));
    low + (place - node as f64) * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Numbers;

    /// Atoms strewn over a ball, some without a kind.
    fn cloud(count: usize, size: f64, seed: u64, at: f64) -> Knots {
        let mut numbers = Numbers(seed);
        let mut next = || numbers.next();
        let centers: Vec<[f64; 3]> = (0..count)
            .map(|_| std::array::from_fn(|_| at + size * (next() - 0.5)))
            .collect();
        let kinds = (0..count)
            .map(|index| (index % 7 != 0).then_some((index * 31 % atom_kinds().len()) as u8))
            .collect();
        Knots::new(centers, vec![1.7; count])
            .unwrap()
            .with_atom_kinds(kinds)
            .unwrap()
    }

    /// The definition, pair by pair.
    fn direct(a: &Knots, b: &Knots, potential: &AtomPairPotential, pose: &Pose) -> f64 {
        let mut sum = 0.0;
        for (x, a) in a.centers.iter().zip(&a.atom_kinds) {
            for (y, b) in b.centers.iter().zip(&b.atom_kinds) {
                let (Some(a), Some(b)) = (*a, *b) else {
                    continue;
                };
                let d = (Vector3::from(pose.apply(*y)) - Vector3::from(*x)).norm();
                let energies = potential.energies(a.into(), b.into());
                let hat = |node: usize| {
                    let from = (d - DISTANCES[node]) / STEP;
                    if node == 0 && from < 0.0 {
                        1.0
                    } else {
                        (1.0 - from.abs()).max(0.0)
                    }
                };
                sum -= (0..DISTANCES.len())
                    .map(|node| hat(node) * f64::from(energies[node]))
                    .sum::<f64>();
            }
        }
        sum
    }

    #[test]
    fn cells_give_the_double_sum() {
        let potential = AtomPairPotential::default();
        for (count, size, at) in [(400, 30.0, 0.0), (60, 200.0, 1e6), (1, 1.0, -3.0)] {
            let (a, b) = (cloud(count, size, 1, at), cloud(80, 18.0, 2, 5.0));
            let pairs = AtomPairs::new(&a, &b, &potential, 2.0);
            for step in 0..40 {
                let angle = f64::from(step);
                let pose = Pose::from_parts(
                    [angle.cos(), angle.sin(), 0.3, -0.2],
                    [at + 0.9 * angle - 18.0, at - 5.0, at + 0.3 * angle],
                );
                let expected = 2.0 * direct(&a, &b, &potential, &pose);
                let got = pairs.score(&pose);
                // File coordinates of 1e6 Å hold 1e-10 Å.
                assert!(
                    (got - expected).abs() < 1e-6 * expected.abs().max(1.0),
                    "{got} {expected}"
                );
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
        assert_eq!(at(0.0), at(DISTANCES[0]));
        let last = f64::from(energies[DISTANCES.len() - 1]);
        assert!((at(REACH - 0.5 * STEP) + 1.5 * last).abs() < 1e-9);
        assert_eq!([at(REACH), at(500.0), at(-1e9)].map(f64::abs), [0.0; 3]);
    }
}
