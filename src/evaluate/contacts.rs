//! Residue contacts: the native's interface, and the share of its contacts that a pose keeps.
//!
//! Two residues are in contact when any two of their heavy atoms are nearer than 5 Å. A residue belongs to the
//! interface when one of its heavy atoms is less than 10 Å from a heavy atom of the other side.
//!
//! Sources: DockQ 2.1.3 `constants.py`; the CAPRI definitions, Méndez et al., Proteins 52 (2003) 51-67.

use std::collections::HashMap;

use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use nalgebra::Point3;

use super::residues::Residues;
use crate::evaluate::residues::residue::Residue;

/// Largest distance of a contact, in Å.
pub(super) const CONTACT_DISTANCE: f64 = 5.0;
/// Largest distance across the interface, in Å.
pub(super) const INTERFACE_DISTANCE: f64 = 10.0;

/// A native whose two sides do not touch.
pub(super) fn no_contact() -> Error {
    Error::input("the native's receptor and ligand have no heavy atoms within 5 Å of each other").help(
        "check that the two are in one common frame and that the chains named are neighbours in the native; \
         --native-receptor FILE:CHAINS and --native-ligand FILE:CHAINS choose them",
    )
}

/// A pair of residues across the native's interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AcrossPair {
    /// Indices of the receptor's and of the ligand's residue.
    pub residues: [usize; 2],
    /// Whether they are in contact too.
    pub contact: bool,
}

/// All pairs of residues nearer than 10 Å, ordered by receptor and then ligand residue.
///
/// Cost: every pair of residues once, and every pair of atoms of those whose bounding balls come near.
pub(super) fn pairs_across(receptor: &[Residue], ligand: &[Residue]) -> Vec<AcrossPair> {
    let mut found = Vec::new();
    for (i, a) in receptor.iter().enumerate() {
        for (j, b) in ligand.iter().enumerate() {
            let reach = INTERFACE_DISTANCE + a.radius + b.radius;
            if nalgebra::distance_squared(&a.center, &b.center) > reach * reach {
                continue;
            }
            let least = least_distance_squared(&a.heavy, &b.heavy);
            if least < INTERFACE_DISTANCE * INTERFACE_DISTANCE {
                found.push(AcrossPair {
                    residues: [i, j],
                    contact: least < CONTACT_DISTANCE * CONTACT_DISTANCE,
                });
            }
        }
    }
    found
}

/// Number of contacts between some residues of the receptor and some of the ligand.
pub(super) fn contacts_between(
    receptor: &Residues,
    ours: &[usize],
    ligand: &Residues,
    theirs: &[usize],
) -> usize {
    let touching = |&i: &usize, &j: &usize| {
        let (a, b) = (&receptor.residues[i], &ligand.residues[j]);
        let reach = CONTACT_DISTANCE + a.radius + b.radius;
        nalgebra::distance_squared(&a.center, &b.center) <= reach * reach
            && touches(&a.heavy, &b.heavy)
    };
    let of_one = |i: &usize| theirs.iter().filter(|j| touching(i, j)).count();
    ours.iter().map(of_one).sum()
}

fn least_distance_squared(a: &[Point3<f64>], b: &[Point3<f64>]) -> f64 {
    let mut least = f64::INFINITY;
    for x in a {
        for y in b {
            least = least.min(nalgebra::distance_squared(x, y));
        }
    }
    least
}

/// A ball around the heavy atoms of one residue.
#[derive(Clone, Debug)]
struct Ball {
    atoms: std::ops::Range<usize>,
    center: Point3<f64>,
    radius: f64,
}

/// The residues of one side that take part in contacts, their atoms in one array.
#[derive(Clone, Debug, Default)]
struct ContactSide {
    atoms: Vec<Point3<f64>>,
    balls: Vec<Ball>,
    place: HashMap<usize, usize>,
}

impl ContactSide {
    /// Place of the residue with this index, added when it is new.
    fn place(&mut self, index: usize, residue: &Residue) -> usize {
        *self.place.entry(index).or_insert_with(|| {
            let first = self.atoms.len();
            self.atoms.extend_from_slice(&residue.heavy);
            self.balls.push(Ball {
                atoms: first..self.atoms.len(),
                center: residue.center,
                radius: residue.radius,
            });
            self.balls.len() - 1
        })
    }
}

/// The native's contacts as pairs of docked residues.
#[derive(Clone, Debug, Default)]
pub(super) struct NativeContacts {
    receptor: ContactSide,
    ligand: ContactSide,
    /// Places of matched residues that touch in the native.
    pub pairs: Vec<(usize, usize)>,
    /// Number of contacts of the whole native, matched or not.
    pub total: usize,
}

impl NativeContacts {
    /// The contacts among `across`; `docked_of` has the index among the docked residues of each native residue that is
    /// matched. Both sides are given receptor first.
    pub fn new(
        across: &[AcrossPair],
        [receptor, ligand]: [&[Residue]; 2],
        docked_of: &[HashMap<usize, usize>; 2],
    ) -> Self {
        let mut contacts = Self::default();
        for pair in across.iter().filter(|pair| pair.contact) {
            contacts.total += 1;
            let [first, second] = pair.residues;
            if let (Some(&i), Some(&j)) = (docked_of[0].get(&first), docked_of[1].get(&second)) {
                let place = contacts.receptor.place(i, &receptor[i]);
                let other = contacts.ligand.place(j, &ligand[j]);
                contacts.pairs.push((place, other));
            }
        }
        contacts
    }

    /// The largest share, 0 to 1, of the native's contacts that any pose can keep.
    pub fn most_kept(&self) -> f64 {
        self.pairs.len() as f64 / self.total.max(1) as f64
    }

    /// The share, 0 to 1, of the native's contacts that are contacts with the ligand at `pose`.
    pub fn share_kept(&self, pose: &Pose) -> f64 {
        if self.total == 0 {
            return 0.0;
        }
        let moved = |point: &Point3<f64>| pose.rotation * point + pose.translation;
        let atoms: Vec<_> = self.ligand.atoms.iter().map(moved).collect();
        let balls = self.ligand.balls.iter();
        let centers: Vec<_> = balls.map(|ball| moved(&ball.center)).collect();
        let is_kept = |&&(i, j): &&(usize, usize)| {
            let (fixed, moving) = (&self.receptor.balls[i], &self.ligand.balls[j]);
            let reach = CONTACT_DISTANCE + fixed.radius + moving.radius;
            let fixed_atoms = &self.receptor.atoms[fixed.atoms.clone()];
            nalgebra::distance_squared(&fixed.center, &centers[j]) < reach * reach
                && touches(fixed_atoms, &atoms[moving.atoms.clone()])
        };
        self.pairs.iter().filter(is_kept).count() as f64 / self.total as f64
    }
}

fn touches(a: &[Point3<f64>], b: &[Point3<f64>]) -> bool {
    let limit = CONTACT_DISTANCE * CONTACT_DISTANCE;
    a.iter()
        .any(|x| b.iter().any(|y| nalgebra::distance_squared(x, y) < limit))
}

#[cfg(test)]
mod tests {
    use super::super::residues::Residues;
    use super::super::test_molecules::{atom, molecule};
    use super::*;

    /// One residue of one atom at each place along x.
    fn row(places: &[f64]) -> Vec<Residue> {
        let atoms = places
            .iter()
            .zip(1..)
            .map(|(&x, number)| atom("A", number, "GLY", "CA", [x, 0.0, 0.0]))
            .collect();
        Residues::of(&molecule(atoms), "receptor").unwrap().residues
    }

    #[test]
    fn five_and_ten_angstrom_are_outside() {
        // DockQ compares with `<`: a pair at the very limit is none.
        let found = pairs_across(&row(&[0.0]), &row(&[4.999, 5.0, 9.999, 10.0]));
        let seen: Vec<_> = found
            .iter()
            .map(|pair| (pair.residues[1], pair.contact))
            .collect();
        assert_eq!(seen, [(0, true), (1, false), (2, false)]);
    }

    #[test]
    fn share_counts_unmatched_contacts_as_lost() {
        let (receptor, ligand) = (row(&[0.0, 100.0]), row(&[3.0, 103.0]));
        let across = pairs_across(&receptor, &ligand);
        let all: HashMap<_, _> = [(0, 0), (1, 1)].into();
        let one: HashMap<_, _> = [(0, 0)].into();
        let share = |of: &HashMap<_, _>, x: f64| {
            let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
            let docked_of = [of.clone(), all.clone()];
            NativeContacts::new(&across, [&receptor, &ligand], &docked_of).share_kept(&pose)
        };
        assert_eq!(share(&all, 0.0), 1.0);
        assert_eq!(share(&all, 1.9), 1.0);
        assert_eq!(share(&all, 2.1), 0.0);
        assert_eq!(share(&one, 0.0), 0.5);
    }
}
