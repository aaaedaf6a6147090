//! All atoms of one side, for finding those near a point of the other side.

use crate::blocks::{Blocks, Near};
use crate::rigid_move::center;
use crate::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::Vector3;

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
        near: &mut Near,
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
    pub fn touches(&self, pose: &Pose, atom: [f64; 3], near: &mut Near) -> bool {
        let mut touches = false;
        self.near(pose, atom, TOUCHING, near, |_| touches = true);
        touches
    }
}
