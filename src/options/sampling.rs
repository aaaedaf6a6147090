//! Options on sampling meshes.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::mesh::SampleWeights;
use crate::mesh::samplers::Sampler;

use super::definition::{Choice, Optional, Parsed, options};

options! {
    /// How meshes are sampled. Molecules are balls as they come.
    SamplingOptions as sampling, "Sampling", Meshes {
        /// Nodes of the grid on which each mesh is sampled, as 2^18 or 262144 [default: 2^18].
        sample_grid: Option<SampleGrid> = None, "COUNT", Optional(Parsed);
        /// Weights of the balls of meshes: fitted or unit [default: fitted].
        ///
        /// fitted: the summed bumps come closest to one inside and to zero outside. unit: one each.
        sample_weights: Option<SampleWeights> = None, "fitted|unit", Optional(Choice);
        /// How a mesh becomes balls: lattice or bi [default: lattice].
        ///
        /// lattice: balls of one radius. bi: the balls of Behandish and Ilieş' Algorithm 1, which count by volume.
        sampler: Option<Sampler> = None, "lattice|bi", Optional(Choice);
    }
}

/// Maximum number of nodes an axis of a grid: beyond it the depths alone take a gibibyte.
pub const MAX_PER_AXIS: usize = 512;

/// A grid that meshes are sampled on, as its number of nodes along each edge. Written as 64^3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct SampleGrid {
    /// Nodes along each edge.
    pub per_axis: usize,
}

impl Default for SampleGrid {
    /// m = 2^18 nodes.
    fn default() -> Self {
        Self { per_axis: 64 }
    }
}

impl fmt::Display for SampleGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}^3", self.per_axis)
    }
}

impl From<SampleGrid> for String {
    fn from(grid: SampleGrid) -> Self {
        grid.to_string()
    }
}

impl TryFrom<String> for SampleGrid {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl FromStr for SampleGrid {
    type Err = String;

    /// The grid of M nodes, M written as 2^18 or 262144: the cube root of M to the nearest whole number.
    fn from_str(text: &str) -> Result<Self, String> {
        let nodes = match text.split_once('^') {
            Some((base, power)) => {
                let (base, power) = (base.trim().parse::<u64>(), power.trim().parse::<u32>());
                base.ok()
                    .zip(power.ok())
                    .and_then(|(base, power)| base.checked_pow(power))
            }
            None => text.parse::<u64>().ok(),
        };
        let max = (MAX_PER_AXIS as u64).pow(3);
        match nodes.filter(|nodes| (8..=max).contains(nodes)) {
            Some(nodes) => Ok(Self {
                per_axis: (nodes as f64).cbrt().round() as usize,
            }),
            None => Err(format!(
                "a whole number of nodes from 8 to {max} is needed, such as 2^18 or 262144"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_are_cubes() {
        for (text, per_axis) in [
            ("2^12", 16),
            ("2^21", 128),
            ("262144", 64),
            ("64^3", 64),
            ("1000", 10),
            ("8", 2),
        ] {
            let grid: SampleGrid = text.parse().unwrap();
            assert_eq!(grid.per_axis, per_axis, "{text}");
            assert_eq!(grid.to_string().parse(), Ok(grid));
        }
        for text in ["", "7", "2^28", "9^99", "2^x", "-8", "1e6", "2^", "nan"] {
            assert!(text.parse::<SampleGrid>().is_err(), "{text}");
        }
    }
}
