//! Options on the score that the search correlates.

use knotdock_scoring::engine::EngineOptions;
use knotdock_scoring::kernel::{KernelOptions as EngineKernel, Trim, exponent};

use super::definition::{Optional, Word, options};
use super::effect_choice::EffectChoice;
use super::values::{ABOVE_ZERO, Exponent, NOT_NEGATIVE};

options! {
    /// What the search correlates: the effects, the kernel of shape, its resolution, and the modes that stand for it.
    KernelOptions as kernel, "Kernel", Both {
        /// Effects that score: auto, or names with commas between.
        ///
        /// auto takes the effects that the inputs call for. The names are shape (always on), electrostatics, contact and
        /// restraint.
        effects: EffectChoice = EffectChoice::Auto, "auto|NAMES", Word;
        /// Penalty of overlap against the reward of contact.
        lambda: f64 = 9.0, "NUMBER", NOT_NEGATIVE;
        /// Depth r0 of the skin.
        ///
        /// For meshes it is the gap that is looked for between the parts. Its default is then twice the eps of both parts'
        /// sampling, and at most twice the smaller feature size. The sampler `lattice` searches 0.65 of that too, and
        /// keeps the better gap, unless --offset, --resolution, --pass-length, --spacing or --budget is given.
        offset: f64 = 2.2, "ANGSTROM", NOT_NEGATIVE;
        /// Exponent of the bump kernel: large values harden the balls, `inf` makes them sharp.
        #[serde(with = "exponent")]
        alpha: f64 = 2.0, "NUMBER", Exponent;
        /// Finest detail that is ranked: the low-pass ends at one cycle per this length.
        ///
        /// For meshes the default is 2.045 times the offset.
        resolution: f64 = 4.5, "ANGSTROM", ABOVE_ZERO;
        /// Coarsest detail that the low-pass touches [default: 2 times the resolution].
        ///
        /// It leaves whole what is below one cycle per this length, which is at least a hundredth above the resolution.
        pass_length: Option<f64> = None, "ANGSTROM", Optional(ABOVE_ZERO);
        /// Spacing of the translation grid [default: half the resolution, or finer where the tolerance needs it].
        spacing: Option<f64> = None, "ANGSTROM", Optional(ABOVE_ZERO);
        /// Error of the fast path that is allowed, as a share of the best score.
        ///
        /// A smaller one also lengthens the window of the kernel. Exact scores of runs with different tolerances therefore
        /// differ.
        tolerance: f64 = 1e-2, "SHARE", ABOVE_ZERO;
    }
}

pub use crate::mesh::PASS_RATIO;

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
