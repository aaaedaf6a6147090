//! Turns that map a grid onto itself, so that one transform of the ligand serves several rotations.
//!
//! Half-turns about the axes map every box onto itself. A quarter turn about x does so where the box is as long in y as
//! in z. Together they are the eight turns of the dihedral group D4.

use crate::transform::modes::ModeSet;
use nalgebra::{Quaternion, UnitQuaternion};
use std::f64::consts::FRAC_1_SQRT_2;

/// A turn of the grid onto itself: a quarter turn about x or none, then a half-turn or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridTurn {
    /// Whether y goes to z, and z to -y, first.
    quarter: bool,
    /// Axis of the turn by 180 degrees that follows: 1 for x, 2 for y, 3 for z; 0 for none.
    half: usize,
}

impl GridTurn {
    /// No turn.
    pub const NONE: Self = Self::new(false, 0);
    /// By 180 degrees about x: (x, -y, -z).
    pub const X: Self = Self::new(false, 1);
    /// By 180 degrees about y: (-x, y, -z).
    pub const Y: Self = Self::new(false, 2);
    /// By 180 degrees about z: (-x, -y, z).
    pub const Z: Self = Self::new(false, 3);

    /// None and the half-turns, which map every box onto itself.
    pub const HALF_TURNS: [Self; 4] = [Self::NONE, Self::X, Self::Y, Self::Z];

    /// All eight, in the order in which rotation sets hold them: the half-turns, then the quarter turn about x (x, -z,
    /// y) followed by each of them.
    pub const ALL: [Self; 8] = [
        Self::NONE,
        Self::X,
        Self::Y,
        Self::Z,
        Self::new(true, 0),
        Self::new(true, 1),
        Self::new(true, 2),
        Self::new(true, 3),
    ];

    /// The turns that map a plan's modes onto themselves: the half-turns, or all.
    pub fn of(modes: &ModeSet) -> &'static [Self] {
        if modes.has_quarter_turns() {
            &Self::ALL
        } else {
            &Self::HALF_TURNS
        }
    }

    const fn new(quarter: bool, half: usize) -> Self {
        Self { quarter, half }
    }

    /// Place in [`Self::ALL`].
    pub fn index(self) -> usize {
        4 * usize::from(self.quarter) + self.half
    }

    /// Factor of each coordinate, after the quarter turn.
    fn signs(self) -> [i32; 3] {
        match self.half {
            0 => [1, 1, 1],
            1 => [1, -1, -1],
            2 => [-1, 1, -1],
            _ => [-1, -1, 1],
        }
    }

    /// The image of a vector.
    pub fn apply(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let signs = self.signs().map(f64::from);
        let [x, y, z] = if self.quarter { [x, -z, y] } else { [x, y, z] };
        [signs[0] * x, signs[1] * y, signs[2] * z]
    }

    /// The mode (kx, ky, kz) that the turn takes to the one given.
    pub fn source(self, mode: [i32; 3]) -> [i32; 3] {
        let signs = self.signs();
        let [x, y, z] = [0, 1, 2].map(|axis| signs[axis] * mode[axis]);
        if self.quarter { [x, z, -y] } else { [x, y, z] }
    }

    /// The rotation that turns by `rotation` first and by this turn then. Half-turns are exact, since they only permute
    /// and negate the quaternion's parts.
    pub fn after(self, rotation: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let [w, i, j, k] = self.after_parts([rotation.w, rotation.i, rotation.j, rotation.k]);
        UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k))
    }

    /// [`Self::after`] of a quaternion's parts (w, x, y, z).
    pub fn after_parts(self, [w, x, y, z]: [f64; 4]) -> [f64; 4] {
        let [w, x, y, z] = if self.quarter {
            [w - x, x + w, y - z, z + y].map(|part| FRAC_1_SQRT_2 * part)
        } else {
            [w, x, y, z]
        };
        match self.half {
            0 => [w, x, y, z],
            1 => [-x, w, -z, y],
            2 => [-y, z, w, -x],
            _ => [-z, -y, x, w],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn vectors_quaternions_and_modes_turn_alike() {
        let rotation = UnitQuaternion::from_euler_angles(0.3, -1.1, 2.0);
        let x = Vector3::new(0.7, -2.0, 5.0);
        for (index, turn) in GridTurn::ALL.into_iter().enumerate() {
            assert_eq!(turn.index(), index);
            let image = Vector3::from(turn.apply((rotation * x).into()));
            assert!((turn.after(&rotation) * x - image).norm() < 1e-12);
            let mode = [3, -5, 7];
            let source = turn.source(mode).map(f64::from);
            assert_eq!(turn.apply(source), mode.map(f64::from), "{turn:?}");
        }
    }

    #[test]
    fn the_turns_form_a_group_of_eight() {
        let parts = |turn: GridTurn| turn.apply([1.0, 2.0, 3.0]);
        for a in GridTurn::ALL {
            for b in GridTurn::ALL {
                let both = a.apply(parts(b));
                let same = GridTurn::ALL
                    .map(parts)
                    .iter()
                    .filter(|one| **one == both)
                    .count();
                assert_eq!(same, 1, "{a:?} after {b:?}");
            }
        }
    }
}
