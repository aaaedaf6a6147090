//! The sum over contacts by distance range.

use super::cells::{Atom, Cells, typed};
use super::potential::{ENDS, FinePotential, step_down};
use crate::effect::contact::TYPES;
use crate::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::Vector3;

/// Distance in Å from which nothing counts.
const REACH: f64 = ENDS[2][1];

/// Two bodies prepared for the sum of minus the weighted potential over their contacts.
///
/// A pair of typed atoms at distance d scores `-weight sum_b E_b[a][c] (s_b(d) - s_{b-1}(d))` over the ranges b, s_b the step that ends
/// range b and s_{-1} = 0. Atoms without a type take no part.
pub struct FineContacts {
    receptor: Cells,
    receptor_center: Vector3<f64>,
    ligand: Vec<Atom>,
    ligand_center: Vector3<f64>,
    /// What each step s_b is worth, `[receptor type][ligand type][range]`: -weight (E_b - E_{b+1}).
    steps: Vec<[[f64; 3]; TYPES.len()]>,
}

impl FineContacts {
    /// Prepares two sets of knots with contact types; `weight` is score per RT.
    pub fn new(receptor: &Knots, ligand: &Knots, potential: &FinePotential, weight: f64) -> Self {
        let (atoms, receptor_center) = typed(receptor, &receptor.contact_types, TYPES.len());
        let (ligand, ligand_center) = typed(ligand, &ligand.contact_types, TYPES.len());
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
            receptor: Cells::new(atoms),
            receptor_center,
            ligand,
            ligand_center,
            steps: steps.collect(),
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
                let distance = square.sqrt();
                let worth = &self.steps[other.kind][atom.kind];
                for (worth, ends) in worth.iter().zip(ENDS) {
                    sum += worth * step_down(distance, ends);
                }
            });
            total += sum;
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rescoring::RANGES;
    use crate::test_support::Numbers;

    /// Atoms strewn over a ball by a linear congruence, some without a type.
    fn cloud(count: usize, size: f64, seed: u64, at: f64) -> Knots {
        let mut numbers = Numbers(seed);
        let mut next = || numbers.next();
        let centers: Vec<[f64; 3]> = (0..count)
            .map(|_| std::array::from_fn(|_| at + size * (next() - 0.5)))
            .collect();
        let types = (0..count)
            .map(|index| (index % 7 != 0).then_some((index % TYPES.len()) as u8))
            .collect();
        Knots::new(centers, vec![1.7; count])
            .unwrap()
            .with_labels(Vec::new(), types)
            .unwrap()
    }

    /// The definition, pair by pair.
    fn direct(a: &Knots, b: &Knots, potential: &FinePotential, weight: f64, pose: &Pose) -> f64 {
        let mut sum = 0.0;
        for (x, a) in a.centers.iter().zip(&a.contact_types) {
            for (y, b) in b.centers.iter().zip(&b.contact_types) {
                let (Some(a), Some(b)) = (*a, *b) else {
                    continue;
                };
                let d = (Vector3::from(pose.apply(*y)) - Vector3::from(*x)).norm();
                let mut before = 0.0;
                for (table, ends) in potential.ranges.iter().zip(ENDS) {
                    let step = step_down(d, ends);
                    sum -= weight * table.energy(a.into(), b.into()) * (step - before);
                    before = step;
                }
            }
        }
        sum
    }

    #[test]
    fn cells_give_the_double_sum() {
        let potential = FinePotential::default();
        for (count, size, at) in [(400, 30.0, 0.0), (60, 200.0, 1e6), (1, 1.0, -3.0)] {
            let (a, b) = (cloud(count, size, 1, at), cloud(80, 18.0, 2, 5.0));
            let contacts = FineContacts::new(&a, &b, &potential, 2.0);
            for step in 0..40 {
                let angle = f64::from(step);
                let pose = Pose::from_parts(
                    [angle.cos(), angle.sin(), 0.3, -0.2],
                    [at + 0.9 * angle - 18.0, at - 5.0, at + 0.3 * angle],
                );
                let expected = direct(&a, &b, &potential, 2.0, &pose);
                let got = contacts.score(&pose);
                // File coordinates of 1e6 Å hold 1e-10 Å.
                assert!(
                    (got - expected).abs() < 1e-6 * expected.abs().max(1.0),
                    "{got} {expected}"
                );
            }
        }
    }

    /// Two atoms at the middle of each range have that range's energy; beyond the reach there is none.
    #[test]
    fn one_pair_has_the_energy_of_its_range() {
        let potential = FinePotential::default();
        let one = |kind: u8| {
            let knots = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
            knots.with_labels(Vec::new(), vec![Some(kind)]).unwrap()
        };
        let contacts = FineContacts::new(&one(6), &one(8), &potential, 3.0);
        let at = |x: f64| contacts.score(&Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]));
        for (range, distance) in [3.0, 4.75, 6.5].into_iter().enumerate() {
            let energy = potential.ranges[range].energy(6, 8);
            assert!(
                (at(distance) + 3.0 * energy).abs() < 1e-12,
                "{}",
                RANGES[range]
            );
        }
        assert_eq!([at(8.0), at(500.0), at(-1e9)], [0.0; 3]);
    }

    #[test]
    fn no_typed_atom_scores_nothing() {
        let bare = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
        let contacts = FineContacts::new(&bare, &bare, &FinePotential::default(), 1.0);
        assert_eq!(contacts.score(&Pose::identity()), 0.0);
    }
}
