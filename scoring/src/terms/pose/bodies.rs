//! Two bodies of typed atoms, and sums over their pairs within a reach.

use crate::blocks::{Blocks, LANES, NearPoints};
use crate::lanes::{each, total};
use crate::rigid_move::center;
use crate::se3::Pose;
use crate::vectorized::with_simd;
use knotdock_structures::Knots;
use nalgebra::Vector3;
use pulp::Simd;

/// Typed atoms of two bodies, each relative to the centre of its body.
pub(super) struct Bodies {
    receptor: Blocks,
    /// Types of the receptor's atoms, in the order of the blocks.
    types: Vec<usize>,
    receptor_center: Vector3<f64>,
    /// Distance in Å from which no pair counts.
    reach: f64,
    ligand: Vec<(Vector3<f64>, usize)>,
    ligand_center: Vector3<f64>,
}

impl Bodies {
    /// Takes the knots whose type is below `kinds`, for sums over pairs nearer than `reach` (Å).
    ///
    /// `types` returns the type of each knot, or nothing for a set
    /// without types.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        types: impl Fn(&Knots) -> &[Option<u8>],
        (kinds, reach): (usize, f64),
    ) -> Self {
        let (atoms, receptor_center) = typed(receptor, types(receptor), kinds);
        let (positions, kinds_of): (Vec<Vector3<f64>>, Vec<usize>) = atoms.into_iter().unzip();
        let (ligand, ligand_center) = typed(ligand, types(ligand), kinds);
        let receptor = Blocks::within(&positions, reach);
        Self {
            reach,
            types: receptor.arranged(|index| kinds_of[index]),
            receptor,
            receptor_center,
            ligand,
            ligand_center,
        }
    }

    /// Sum at a pose of the ligand of `value(receptor type, ligand type, distance in Å)` over the pairs within reach.
    ///
    /// `value` must be `#[inline(always)]`, so that it is compiled for the vector registers of the sum.
    pub fn sum(&self, pose: &Pose, value: impl Fn(usize, usize, f64) -> f64) -> f64 {
        let bodies = self;
        with_simd!(
            <'a, F: Fn(usize, usize, f64) -> f64>(
                bodies: &'a Bodies, pose: &'a Pose, value: F
            ) -> f64,
            |simd| bodies.sum_with(simd, pose, value)
        )
    }

    #[inline(always)]
    fn sum_with<S: Simd>(
        &self,
        simd: S,
        pose: &Pose,
        value: impl Fn(usize, usize, f64) -> f64,
    ) -> f64 {
        let matrix = pose.rotation.to_rotation_matrix();
        let place = pose.rotation * self.ligand_center + pose.translation - self.receptor_center;
        let mut near = NearPoints::default();
        let mut sum = 0.0;
        for &(atom, kind) in &self.ligand {
            let mut sums = [0.0; LANES];
            let position = (matrix * atom + place).into();
            self.receptor.near(
                simd,
                &position,
                self.reach,
                &mut near,
                #[inline(always)]
                |near| {
                    for (squares, points) in near.eights() {
                        let distances = each(|lane| squares[lane].sqrt());
                        let mut values = [0.0; LANES];
                        for lane in 0..LANES {
                            let Some(&other) = self.types.get(points[lane] as usize) else {
                                debug_assert!(false, "an atom that is not there is near");
                                continue;
                            };
                            values[lane] = value(other, kind, distances[lane]);
                        }
                        // What fills up the last eight is infinitely far.
                        sums = each(|lane| {
                            let counts = distances[lane] < f64::INFINITY;
                            sums[lane] + if counts { values[lane] } else { 0.0 }
                        });
                    }
                },
            );
            sum += total(&sums);
        }
        sum
    }
}

/// Typed atoms of a set of knots relative to its centre, with the centre.
fn typed(
    knots: &Knots,
    types: &[Option<u8>],
    kinds: usize,
) -> (Vec<(Vector3<f64>, usize)>, Vector3<f64>) {
    let center = center(knots);
    let atoms = knots.centers.iter().zip(types);
    let atoms = atoms.filter_map(|(&x, kind)| {
        let kind = usize::from((*kind)?);
        (kind < kinds).then(|| (Vector3::from(x) - center, kind))
    });
    (atoms.collect(), center)
}

/// Distance in Å within which two atoms are in contact, as in counts of native contacts.
const TOUCHING: f64 = 5.0;

/// All atoms of one side, relative to its centre.
pub(super) struct Side {
    atoms: Blocks,
    /// Index of each atom, in the order of the blocks.
    indices: Vec<usize>,
    middle: Vector3<f64>,
}

impl Side {
    pub fn new(knots: &Knots) -> Self {
        let middle = center(knots);
        let atoms = knots.centers.iter().map(|x| Vector3::from(*x) - middle);
        let atoms = Blocks::new(&atoms.collect::<Vec<_>>());
        Self {
            indices: atoms.arranged(|index| index),
            atoms,
            middle,
        }
    }

    /// Visits the indices of the atoms within `reach` (Å) of a point of the other side; `pose` carries the point into
    /// this frame.
    pub fn near(
        &self,
        pose: &Pose,
        point: [f64; 3],
        reach: f64,
        near: &mut NearPoints,
        mut visit: impl FnMut(usize),
    ) {
        let x = (Vector3::from(pose.apply(point)) - self.middle).into();
        self.atoms.list_near(&x, reach, near, |near| {
            for (_, atom) in near.pairs() {
                match self.indices.get(atom as usize) {
                    Some(&index) => visit(index),
                    None => debug_assert!(false, "an atom that is not there is near"),
                }
            }
        });
    }

    /// Whether any of the atoms is in contact with an atom of the other side; `pose` carries the atom into this frame.
    pub fn touches(&self, pose: &Pose, atom: [f64; 3], near: &mut NearPoints) -> bool {
        let mut touches = false;
        self.near(pose, atom, TOUCHING, near, |_| touches = true);
        touches
    }
}

/// Both sides of a docking, for finding the atoms of each that are in contact.
pub(super) struct Sides {
    receptor: Side,
    ligand: Side,
}

impl Sides {
    pub fn new(receptor: &Knots, ligand: &Knots) -> Self {
        Self {
            receptor: Side::new(receptor),
            ligand: Side::new(ligand),
        }
    }

    /// Sum at a pose of the values of the groups of atoms of receptor and ligand that are in contact with the other side.
    /// Positions of atoms are those of their file (Å).
    pub fn sum_in_contact<G>(
        &self,
        [of_receptor, of_ligand]: &[Vec<G>; 2],
        pose: &Pose,
        atoms: impl Fn(&G) -> &[[f64; 3]],
        value: impl Fn(&G) -> f64,
    ) -> f64 {
        let mut near = NearPoints::default();
        let mut sum = |side: &Side, groups: &[G], pose: &Pose| {
            let mut touches = |atom: &[f64; 3]| side.touches(pose, *atom, &mut near);
            let touching = groups
                .iter()
                .filter(|group| atoms(group).iter().any(&mut touches));
            touching.fold(0.0, |sum, group| sum + value(group))
        };
        let inverse = pose.inverse();
        sum(&self.ligand, of_receptor, &inverse) + sum(&self.receptor, of_ligand, pose)
    }
}

/// Positions of some knots (Å); indices beyond them are left out.
pub(super) fn positions(knots: &Knots, indices: &[usize]) -> Vec<[f64; 3]> {
    let centers = indices.iter().filter_map(|&index| knots.centers.get(index));
    centers.copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Numbers;

    const KINDS: usize = 5;
    const REACH: f64 = 6.5;

    /// Atoms at random in a cube, some without a type and some of a type above the last.
    fn cloud(count: usize, size: f64, seed: u64, at: f64) -> Knots {
        let mut numbers = Numbers(seed);
        let mut next = || numbers.next();
        let centers: Vec<[f64; 3]> = (0..count)
            .map(|_| std::array::from_fn(|_| at + size * (next() - 0.5)))
            .collect();
        let types = (0..count)
            .map(|index| (index % 7 != 0).then_some((index % (KINDS + 1)) as u8))
            .collect();
        Knots::new(centers, vec![1.7; count])
            .unwrap()
            .with_atom_kinds(types)
            .unwrap()
    }

    /// A function of both types, not symmetric, and of the distance.
    fn value(a: usize, b: usize, distance: f64) -> f64 {
        (a as f64 - 2.0 * b as f64 + 0.5) * (7.0 - distance)
    }

    /// The definition, pair by pair.
    fn direct(a: &Knots, b: &Knots, pose: &Pose) -> f64 {
        let mut sum = 0.0;
        for (x, a) in a.centers.iter().zip(&a.atom_kinds) {
            for (y, b) in b.centers.iter().zip(&b.atom_kinds) {
                let (Some(a), Some(b)) = (*a, *b) else {
                    continue;
                };
                let distance = (Vector3::from(pose.apply(*y)) - Vector3::from(*x)).norm();
                let (a, b) = (usize::from(a), usize::from(b));
                if a < KINDS && b < KINDS && distance < REACH {
                    sum += value(a, b, distance);
                }
            }
        }
        sum
    }

    #[test]
    fn cells_give_the_double_sum() {
        // The atoms of the last body lie far from each other, with almost nothing within reach.
        for (count, size, at) in [(400, 30.0, 0.0), (300, 50.0, 1e6), (60, 200.0, -3.0)] {
            let mut met = 0;
            let (a, b) = (cloud(count, size, 1, at), cloud(80, 18.0, 2, 5.0));
            let bodies = Bodies::new(&a, &b, |knots| &knots.atom_kinds, (KINDS, REACH));
            for step in 0..40 {
                let angle = f64::from(step);
                let pose = Pose::from_parts(
                    [angle.cos(), angle.sin(), 0.3, -0.2],
                    [at + 0.9 * angle - 18.0, at - 5.0, at + 0.3 * angle],
                );
                let expected = direct(&a, &b, &pose);
                let got = bodies.sum(&pose, value);
                met += usize::from(expected != 0.0);
                // File coordinates of 1e6 Å hold 1e-10 Å.
                assert!(
                    (got - expected).abs() < 1e-6 * expected.abs().max(1.0),
                    "{got} {expected}"
                );
            }
            assert!(met > 20 || size > 100.0, "poses that touch: {met}");
        }
    }

    #[test]
    fn knots_without_types_sum_to_nothing() {
        let bare = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
        let bodies = Bodies::new(&bare, &bare, |knots| &knots.atom_kinds, (KINDS, REACH));
        assert_eq!(bodies.sum(&Pose::identity(), value), 0.0);
    }
}
