//! Samplers of meshes that dock: how a solid becomes weighted balls, and which kernel correlates these.
//!
//! A new sampler is one file with its [`Sampler`] here, and one line in [`SAMPLERS`].

pub mod bi;
pub mod lattice;

use std::fmt;
use std::str::FromStr;

use knotdock_structures::mesh::Solid;
use knotdock_structures::numeric::Bump;
use knotdock_structures::sampling::grid::{DepthField, Grid};
use knotdock_structures::sampling::hausdorff::HausdorffMeter;
use knotdock_structures::sampling::weights::FittedWeights;
use knotdock_structures::sampling::{Ball, SampleError};
use serde::{Deserialize, Serialize};

/// All samplers, the default first.
pub static SAMPLERS: [&Sampler; 2] = [&lattice::SAMPLER, &bi::SAMPLER];

/// A sampler.
#[derive(Debug)]
pub struct Sampler {
    /// Its name in options and records.
    pub name: &'static str,
    /// What it makes, as the run says it.
    pub makes: &'static str,
    /// Default exponent of the bump function.
    pub alpha: f64,
    /// Default resolution, in offsets.
    pub resolution: f64,
    /// Depth of the skin, in offsets, where the kernel is the product kernel; `None`: it is B&I's cone.
    pub skin: Option<f64>,
    /// Samples a part.
    pub(super) sample: fn(&PartToSample) -> Result<WeightedBalls, SampleError>,
    /// Weighs balls of a file; `None`: it cannot dock these.
    pub(super) of_balls: Option<fn(&BallsToWeigh) -> WeightedBalls>,
}

/// Balls of a file about the origin, with what a sampler needs of them. Lengths in the file's unit.
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

/// Which nodes lie in a union of balls: depth one inside and minus one outside.
pub(super) fn union(grid: Grid, balls: &[Ball]) -> DepthField {
    let mut depth = vec![-1.0; grid.nodes()];
    for ball in balls {
        grid.visit_ball(ball.center, ball.radius, |node, _| depth[node] = 1.0);
    }
    DepthField { grid, depth }
}

/// A solid with what a sampler needs of it.
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
    /// Volume of the solid, in its unit cubed: exact where the surface is closed. An open one has as much as its grid
    /// says.
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
    /// Nodes along each edge of a cell, where balls lie on a lattice.
    pub per_cell: Option<usize>,
    /// How the weights were fitted, where they were.
    pub fit: Option<FittedWeights>,
    /// How those of the skin were.
    pub skin_fit: Option<FittedWeights>,
}

/// The name of a sampler.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct SamplerName(&'static Sampler);

impl SamplerName {
    /// The sampler.
    pub fn sampler(self) -> &'static Sampler {
        self.0
    }
}

impl Default for SamplerName {
    fn default() -> Self {
        Self(SAMPLERS[0])
    }
}

impl PartialEq for SamplerName {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name
    }
}

impl Eq for SamplerName {}

impl fmt::Display for SamplerName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}

impl From<SamplerName> for String {
    fn from(name: SamplerName) -> Self {
        name.to_string()
    }
}

impl TryFrom<String> for SamplerName {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl FromStr for SamplerName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = SAMPLERS.into_iter().find(|sampler| sampler.name == text);
        found.map(Self).ok_or_else(|| {
            let names: Vec<&str> = SAMPLERS.iter().map(|sampler| sampler.name).collect();
            format!("there is no such sampler; choose {}", names.join(" or "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_give_their_samplers() {
        for (place, sampler) in SAMPLERS.iter().enumerate() {
            let named: SamplerName = sampler.name.parse().unwrap();
            assert_eq!(named.to_string(), sampler.name);
            let others = &SAMPLERS[place + 1..];
            assert!(others.iter().all(|other| other.name != sampler.name));
            assert!(sampler.resolution > 0.0 && sampler.alpha > 0.0);
        }
        assert!(
            "voxels"
                .parse::<SamplerName>()
                .unwrap_err()
                .contains("lattice or bi")
        );
    }
}
