//! What an atom may do in a hydrogen bond.

/// What an atom may do in a hydrogen bond, as a label of its own beside those of [`Knots`](crate::Knots).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolarAtom {
    /// Whether it may give a hydrogen.
    pub donates: bool,
    /// Whether it may take one.
    pub accepts: bool,
    /// Unit vector away from the heavy atoms that it is bonded to; zero where it has none, or where they surround it.
    pub direction: [f64; 3],
}

impl PolarAtom {
    /// Whether a hydrogen bond with another atom is possible.
    #[inline]
    pub fn may_bond(&self, other: &Self) -> bool {
        (self.donates && other.accepts) || (self.accepts && other.donates)
    }
}
