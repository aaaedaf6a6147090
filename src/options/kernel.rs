//! Options on the score that the search correlates.

use clap::Args;
use knotdock_scoring::engine::EngineOptions;
use knotdock_scoring::kernel::{KernelOptions as EngineKernel, Trim, exponent};
use serde::{Deserialize, Serialize};

use super::effect_choice::EffectChoice;
use super::values::{above_zero, not_negative};

/// What the search correlates: the effects, the kernel of shape, its resolution, and the modes that stand for it.
#[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[command(next_help_heading = "Kernel")]
#[serde(deny_unknown_fields)]
pub struct KernelOptions {
    /// Effects that score: auto, or names with commas between.
    ///
    /// auto takes the effects that the inputs call for. The names are shape (always on), electrostatics, contact and
    /// restraint.
    #[arg(long, value_name = "auto|NAMES", default_value = "auto")]
    pub effects: EffectChoice,
    /// Penalty of overlap against the reward of contact.
    #[arg(long, value_name = "NUMBER", value_parser = not_negative, default_value_t = 9.0)]
    pub lambda: f64,
    /// Depth r0 of the skin.
    ///
    /// For meshes it is the gap that is looked for between the parts. Its default is then twice the eps of both parts'
    /// sampling, and at most twice the smaller feature size.
    #[arg(long, value_name = "ANGSTROM", value_parser = not_negative, default_value_t = 2.2)]
    pub offset: f64,
    /// Exponent of the bump kernel: large values harden the balls, `inf` makes them sharp.
    #[arg(long, value_name = "NUMBER", value_parser = exponent::parse, default_value_t = 2.0)]
    #[serde(with = "exponent")]
    pub alpha: f64,
    /// Finest detail that is ranked: the low-pass ends at one cycle per this length.
    ///
    /// For meshes the default is 2.045 times the offset.
    #[arg(long, value_name = "ANGSTROM", value_parser = above_zero, default_value_t = 4.5)]
    pub resolution: f64,
    /// Coarsest detail that the low-pass touches [default: 2 times the resolution].
    ///
    /// It leaves whole what is below one cycle per this length, which is at least a hundredth above the resolution.
    #[arg(long, value_name = "ANGSTROM", value_parser = above_zero)]
    pub pass_length: Option<f64>,
    /// Spacing of the translation grid [default: half the resolution, or finer where the tolerance needs it].
    #[arg(long, value_name = "ANGSTROM", value_parser = above_zero)]
    pub spacing: Option<f64>,
    /// Error of the fast path that is allowed, as a share of the best score.
    ///
    /// A smaller one also lengthens the window of the kernel. Exact scores of runs with different tolerances therefore
    /// differ.
    #[arg(long, value_name = "SHARE", value_parser = above_zero, default_value_t = 1e-2)]
    pub tolerance: f64,
}

/// Default pass length as a multiple of the resolution.
pub const PASS_RATIO: f64 = 2.0;

impl KernelOptions {
    /// The options as the engine takes them.
    pub fn engine(&self) -> EngineOptions {
        EngineOptions {
            kernel: EngineKernel {
                lambda: self.lambda,
                offset: self.offset,
                alpha: self.alpha,
                resolution: self.resolution,
                pass_length: self.pass_length.unwrap_or(PASS_RATIO * self.resolution),
                trim: Trim::FlatTop,
            },
            spacing: self.spacing,
            tolerance: self.tolerance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The scoring crate's front door correlates by the kernel that `dock` uses.
    #[test]
    fn the_library_has_the_same_defaults() {
        assert_eq!(KernelOptions::default().engine(), EngineOptions::default());
    }
}
