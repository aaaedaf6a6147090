//! The part of an atom in hydrogen bonds.

/// The part of an atom in hydrogen bonds: a label beside those of [`Knots`](crate::Knots).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolarAtom {
    /// Whether it may give a hydrogen.
    pub donates: bool,
    /// Whether it may take one.
    pub accepts: bool,
    /// Unit vector away from the heavy atoms that it is bonded to; zero if there are none, or if they surround it.
    pub direction: [f64; 3],
}

impl PolarAtom {
    /// Whether a hydrogen bond with another atom is possible.
    #[inline]
    pub fn may_bond(&self, other: &Self) -> bool {
        (self.donates && other.accepts) || (self.accepts && other.donates)
    }
}
