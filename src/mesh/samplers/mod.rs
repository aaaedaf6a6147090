//! Samplers of meshes that dock: how a solid becomes weighted balls, and which kernel correlates these.

pub mod bi;
pub mod double_skin;
pub mod lattice;

use double_skin::DoubleSkinFit;
use knotdock_scoring::kernel::{KernelError, KernelOptions};
use knotdock_structures::mesh::Solid;
use knotdock_structures::sampling::grid::{DepthField, Grid};
use knotdock_structures::sampling::hausdorff::HausdorffMeter;
use knotdock_structures::sampling::weights::FittedWeights;
use knotdock_structures::sampling::{Ball, SampleError};
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
            Self::Bi => 6.0,
        }
    }

    /// Depth of the skin, in offsets, if the kernel is the product kernel; `None` for B&I's cone.
    pub fn skin(self) -> Option<f64> {
        (self == Self::Bi).then_some(bi::SKIN)
    }
}

/// Why a part has no balls to dock.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum SamplerError {
    #[error(transparent)]
    Sample(#[from] SampleError),
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// The fit of the double skin needs too many nodes.
    #[error(
        "at this resolution weights would be fitted on {nodes} nodes per axis; at most {most} are possible"
    )]
    Nodes {
        /// Along an axis.
        nodes: usize,
        most: usize,
    },
    /// It needs too much memory.
    #[error("the fit of the weights of {balls} balls needs {:.0} MB of memory, and {:.0} MB are allowed", needed / 1e6, *room as f64 / 1e6)]
    Memory {
        balls: usize,
        needed: f64,
        room: u64,
    },
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
    /// The kernel that weights are fitted to; `None`: weights are one.
    pub kernel: Option<KernelOptions>,
    /// Bytes that the fit may take.
    pub room: Option<u64>,
}

/// Depths of nodes in the deepest of some balls; those `reach` outside all of them or farther are that far.
pub(super) fn union(grid: Grid, balls: &[Ball], reach: f64) -> DepthField {
    let mut depth = vec![-reach; grid.nodes()];
    for ball in balls {
        grid.visit_ball(ball.center, ball.radius + reach, |node, squared| {
            depth[node] = depth[node].max(ball.radius - squared.sqrt());
        });
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
    /// The kernel that weights are fitted to, in the solid's unit; `None`: weights are one.
    pub kernel: Option<KernelOptions>,
    /// Bytes that the fit may take.
    pub room: Option<u64>,
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
    pub per_cell: Option<f64>,
    /// The fit of the weights, if they were fitted.
    pub fit: Option<FittedWeights>,
    /// The fit of the double skin.
    pub double_skin: Option<DoubleSkinFit>,
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
