//! Quantities of a correlation: the score, one slice of it, or their change with the radii.

/// The quantity that an engine correlates: one slice, or the score, the weighted sum of all three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The weighted sum of the three slices: G.
    Score,
    /// One unweighted slice: 0, 1 or 2 for rho = 0, r0, 2 r0. Any other panics.
    Slice(usize),
    /// Change of the score with the knots' radii, per Å: dG / d rho, all three offsets moved by the same length.
    ScoreByOffset,
    /// dg / d rho of one slice, per Å: -dg / dr on B&I's r axis, which runs the other way.
    SliceByOffset(usize),
}
