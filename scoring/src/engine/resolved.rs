//! Balls that an engine cannot resolve: the low-pass or the grid leaves too little of them to count on.
//!
//! The low-passed kernel scores every pair, but of balls much smaller than the resolution it sees little more than
//! points: what is left of their overlap falls like (radius / resolution)^3. The exact sum has the same low-pass, so
//! that no error between the two shows it. That is why these balls are named. Between coincident balls of radius 1.5
//! and 1.9 Å at a resolution of 4.5 Å nine tenths of the overlap or more are left.

use super::plan::{PairKernel, Plan};
use super::uniform_grid::UniformGridPlan;
use crate::kernel::Band;
use knotdock_structures::Knots;

/// Share of the overlap of two coincident balls that must be left for them to count as resolved.
const SHARE: f64 = 0.1;

impl Plan {
    /// Indices of the knots that the planned correlation cannot resolve.
    ///
    /// Of two of them at one place the low-pass leaves less than a tenth of the overlap. Without a low-pass their
    /// radius is below the grid spacing.
    pub fn unresolved(&self, knots: &Knots) -> Vec<usize> {
        match &self.pair() {
            PairKernel::Product(kernel) if kernel.band() == Band::Whole => {
                by_radius(knots, |radius| radius < self.spacing())
            }
            _ => by_radius(knots, |radius| {
                self.kernel().overlap_left(2.0 * radius) < SHARE
            }),
        }
    }
}

impl UniformGridPlan {
    /// Indices of the knots that the grid cannot resolve: their radius is below the grid spacing, so that how many
    /// voxels they fill depends on where they fall.
    pub fn unresolved(&self, knots: &Knots) -> Vec<usize> {
        by_radius(knots, |radius| radius < self.options.spacing)
    }
}

fn by_radius(knots: &Knots, unresolved: impl Fn(f64) -> bool) -> Vec<usize> {
    let (radii, classes) = knots.radius_classes();
    let lost: Vec<bool> = radii.into_iter().map(unresolved).collect();
    (0..knots.len())
        .filter(|&index| lost[classes[index]])
        .collect()
}
