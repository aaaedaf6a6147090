//! Rigid motions.

use crate::vector::{add, dot};

/// A rigid motion x -> rows x + shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Rows of the rotation matrix.
    pub rows: [[f64; 3]; 3],
    /// Translation, in the unit of the points.
    pub shift: [f64; 3],
}

impl Motion {
    /// The motion that moves nothing.
    pub const IDENTITY: Self = Self {
        rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        shift: [0.0; 3],
    };

    /// The image of a point.
    #[inline(always)]
    pub fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = &self.rows;
        [
            a[0] * x + a[1] * y + a[2] * z + self.shift[0],
            b[0] * x + b[1] * y + b[2] * z + self.shift[1],
            c[0] * x + c[1] * y + c[2] * z + self.shift[2],
        ]
    }

    /// This motion followed by a translation.
    #[must_use]
    pub fn shifted(&self, by: [f64; 3]) -> Self {
        Self {
            rows: self.rows,
            shift: add(self.shift, by),
        }
    }

    /// `first`, then this motion.
    pub(crate) fn after(&self, first: &Self) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| first.rows.map(|row| row[axis]));
        Self {
            rows: self.rows.map(|row| [dot(row, x), dot(row, y), dot(row, z)]),
            shift: self.apply(first.shift),
        }
    }
}
