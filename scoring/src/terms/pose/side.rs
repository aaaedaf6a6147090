//! All atoms of one side, for finding those near a point of the other side.

use super::CELL_EDGE;
use crate::exact::center;
use crate::se3::Pose;
use knotdock_structures::Knots;
use knotdock_structures::neighbours::{CellList, Member};
use nalgebra::Vector3;

/// Distance in Å within which two atoms are in contact, as in counts of native contacts.
const TOUCHING: f64 = 5.0;

/// All atoms of one side, relative to its centre.
pub(super) struct Side {
    /// By the index of the atom.
    atoms: CellList<usize>,
    middle: Vector3<f64>,
}

impl Side {
    pub fn new(knots: &Knots) -> Self {
        let middle = center(knots);
        let atom = |(item, x): (usize, &[f64; 3])| Member {
            position: (Vector3::from(*x) - middle).into(),
            item,
        };
        Self {
            atoms: CellList::new(
                knots.centers.iter().enumerate().map(atom).collect(),
                CELL_EDGE,
            ),
            middle,
        }
    }

    /// Visits the indices of the atoms within `reach` (Å) of a point of the other side; `pose` carries the point into
    /// this frame.
    pub fn near(&self, pose: &Pose, point: [f64; 3], reach: f64, mut visit: impl FnMut(usize)) {
        let x = Vector3::from(pose.apply(point)) - self.middle;
        self.atoms
            .visit_within(x.into(), reach, |&atom, _| visit(atom));
    }

    /// Whether any of the atoms is in contact with an atom of the other side; `pose` carries the atom into this frame.
    pub fn touches(&self, pose: &Pose, atom: [f64; 3]) -> bool {
        let mut near = false;
        self.near(pose, atom, TOUCHING, |_| near = true);
        near
    }
}
