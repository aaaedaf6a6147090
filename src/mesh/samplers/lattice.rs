//! Sampler `lattice`: balls of one radius, which B&I's cone correlates.
//!
//! A sum over pairs of balls counts pairs. Over balls of very different size that is no volume. A large ball that
//! overlaps another by its whole volume counts as much as two tiny ones that touch. The many balls of an edge
//! outweigh the one that fills the middle.
//!
//! So these balls are of one radius, on a lattice. Weights are fitted so that their bumps add up to one inside and
//! zero outside. The sum over pairs is then an integral over both volumes, for any position of the lattices. The kernel is
//! that of molecules, B&I's cone, whose balls are all of about one size.
//!
//! # Lengths
//!
//! Two flat faces with a gap g between them score, per area, E(g) = pi times the integral from g on of K(d) d (d -
//! g)^2. K is the ranking kernel. With these lengths and lambda = 9 E is greatest at g = r0, above half of that from
//! 0.65 to 1.55 r0, and below zero under 0.3 r0.

use knotdock_structures::numeric::Bump;
use knotdock_structures::sampling::lattice::lattice;
use knotdock_structures::sampling::weights;

use super::{PartToSample, RESOLUTION, SamplerError, WeightedBalls};

/// Radius of the balls in offsets: 2.5 Å for an offset of 2.2 Å.
pub const RADIUS: f64 = 2.5 / 2.2;
/// Width of the lattice's cells in offsets: half the default resolution.
const CELL: f64 = 0.5 * RESOLUTION;

pub(in crate::mesh) fn sample(part: &PartToSample) -> Result<WeightedBalls, SamplerError> {
    let unit = part.solid.frame().unit;
    let (offset, spacing) = (part.offset * unit, part.field.grid.spacing() * unit);
    let per_cell = (CELL * offset / spacing).max(1.0);
    let balls = lattice(part.field, per_cell, RADIUS * offset / unit);
    let bump = part.kernel.and_then(|kernel| Bump::new(kernel.alpha).ok());
    let fit = bump.map(|bump| weights::fit(part.field, &balls, bump, part.volume()));
    let weight = |place: usize| fit.as_ref().map_or(1.0, |fit| fit.weights[place]);
    let weighted = balls
        .into_iter()
        .enumerate()
        .map(|(place, ball)| (ball, weight(place)));
    // A ball without weight would only cost time.
    let (balls, weights) = weighted.filter(|(_, weight)| *weight > 0.0).unzip();
    Ok(WeightedBalls {
        balls,
        weights,
        skin_weights: Vec::new(),
        per_cell: Some(per_cell),
        fit,
        double_skin: None,
    })
}
