//! The energy of a move with its derivatives.

use super::energy::Energy;
use crate::rigid_move::Derivatives;

/// Energy of a move with its derivatives by a further step. The curvature is that of overlaps along the lines between
/// their atoms: positive semidefinite.
pub(super) struct Slope {
    pub energy: Energy,
    pub by_step: Derivatives,
}

impl Slope {
    /// Slope of nothing.
    pub fn zero() -> Self {
        Self {
            energy: Energy::default(),
            by_step: Derivatives::zero(),
        }
    }
}
