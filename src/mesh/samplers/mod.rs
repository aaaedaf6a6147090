//! Samplers of meshes that dock: how a solid becomes weighted balls, and which kernel correlates these.

pub mod bi;
pub mod lattice;

use knotdock_structures::mesh::Solid;
use knotdock_structures::numeric::Bump;
use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::grid::{DepthField, Grid};
use knotdock_structures::sampling::hausdorff::HausdorffMeter;
use knotdock_structures::sampling::weights::FittedWeights;
use serde::{Deserialize, Serialize};

/// A sampler.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sampler {
    /// Balls of one radius, which B&I's cone correlates ([`lattice`]).
    #[default]
    Lattice,
    /// The balls of Algorithm 1, which the product kernel correlates ([`bi`]).
    Bi,
}

impl Sampler {
    /// Name in options and records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lattice => "lattice",
            Self::Bi => "bi",
        }
    }

    /// Its balls and its kernel, as a run reports them.
    pub fn makes(self) -> &'static str {
        match self {
            Self::Lattice => "all balls are of one radius, so the kernel is the cone",
            Self::Bi => {
                "balls are of every size, so the kernel is the product kernel, which counts by volume"
            }
        }
    }

    /// Default exponent of the bump function.
    pub fn alpha(self) -> f64 {
        match self {
            Self::Lattice => 2.0,
            Self::Bi => 16.0,
        }
    }

    /// Depth of the skin, in offsets, if the kernel is the product kernel; `None` for B&I's cone.
    pub fn skin(self) -> Option<f64> {
        (self == Self::Bi).then_some(bi::SKIN)
    }
}

/// Default resolution in offsets: that of molecules.
pub const RESOLUTION: f64 = 4.5 / 2.2;

/// Balls of a file about the origin, as samplers read them. Lengths in the file's unit.
pub(super) struct BallsToWeigh<'a> {
    pub balls: Vec<Ball>,
    /// Weights of the file; `None`: they are fitted.
    pub weights: Option<&'a [f64]>,
    /// The grid that weights are fitted on.
    pub grid: Grid,
    pub offset: f64,
    /// The bump whose weights are fitted; `None`: weights are one.
    pub fitted: Option<Bump>,
}

/// The nodes in a union of balls: depth one inside and minus one outside.
pub(super) fn union(grid: Grid, balls: &[Ball]) -> DepthField {
    let mut depth = vec![-1.0; grid.nodes()];
    for ball in balls {
        grid.visit_ball(ball.center, ball.radius, |node, _| depth[node] = 1.0);
    }
    DepthField { grid, depth }
}

/// A solid as samplers read it.
pub(super) struct PartToSample<'a> {
    pub solid: &'a Solid,
    /// Depths on the grid.
    pub field: &'a DepthField,
    /// Offset r0, in the solid's unit.
    pub offset: f64,
    /// The bump whose weights are fitted; `None`: weights are one.
    pub fitted: Option<Bump>,
}

impl PartToSample<'_> {
    /// Volume of the solid, in its unit cubed: exact if the surface is closed, else that of its grid.
    pub fn volume(&self) -> f64 {
        match self.solid.mesh().is_closed() {
            true => self.solid.mesh().volume(),
            false => HausdorffMeter::new(self.solid, self.field).volume(),
        }
    }
}

/// A part as balls, in the solid's unit.
pub(super) struct WeightedBalls {
    pub balls: Vec<Ball>,
    pub weights: Vec<f64>,
    /// Weights of the balls grown by the skin; empty where the sampler has none.
    pub skin_weights: Vec<f64>,
    /// Nodes along each edge of a cell, for balls on a lattice.
    pub per_cell: Option<usize>,
    /// The fit of the weights, if they were fitted.
    pub fit: Option<FittedWeights>,
    /// The fit of the skin's weights.
    pub skin_fit: Option<FittedWeights>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_records() {
        for sampler in [Sampler::Lattice, Sampler::Bi] {
            let record = serde_json::to_string(&sampler).unwrap();
            assert_eq!(record, format!("{:?}", sampler.name()));
        }
    }
}
