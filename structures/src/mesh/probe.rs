//! Whether a sample of the surface is a point of the solid: whether some of the solid lies beside it at once.

use crate::mesh::solid::Solid;
use crate::mesh::surface::SurfaceSample;
use crate::mesh::vector::along;

/// Samples of one triangle that bound nothing, after which only every so many are looked at.
const PATIENCE: usize = 32;

/// Looks at samples of one triangle, in turn. Where many in a row bound nothing, most of those that follow are
/// taken to bound nothing either.
#[derive(Default)]
pub(crate) struct Probe {
    idle: usize,
}

impl Probe {
    /// Whether the solid lies under a sample, at steps from `reach` / 2^40 to `reach` / 2^5.
    pub fn is_under(&mut self, solid: &Solid, sample: &SurfaceSample, reach: f64) -> bool {
        let passes = self.idle > PATIENCE && !self.idle.is_multiple_of(PATIENCE);
        let found = !passes && is_along(solid, sample, -reach, 1);
        self.idle = if found { 0 } else { self.idle + 1 };
        found
    }
}

/// Whether the solid lies on either side of a sample, at fewer such steps.
pub(crate) fn is_beside(solid: &Solid, sample: &SurfaceSample, reach: f64) -> bool {
    is_along(solid, sample, -reach, 3) || is_along(solid, sample, reach, 3)
}

fn is_along(solid: &Solid, sample: &SurfaceSample, reach: f64, stride: usize) -> bool {
    (1..=8).step_by(stride).any(|step| {
        let share = 0.5f64.powi(5 * step);
        solid.is_inside(along(sample.point, share * reach, sample.normal))
    })
}
