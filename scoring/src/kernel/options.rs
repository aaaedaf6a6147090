//! Options of a kernel, and the errors of those that cannot be built.

use super::cone::Trim;
use knotdock_structures::numeric::bump::{AlphaError, Bump};
use serde::{Deserialize, Serialize};

/// Options of the ranking kernel. Lengths in the unit of the knots (Å for molecules).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KernelOptions {
    /// Weight of overlap against contact, B&I's lambda (dimensionless).
    pub lambda: f64,
    /// Skin offset r0 >= 0, in Å.
    pub offset: f64,
    /// Exponent alpha of the bump function.
    #[serde(with = "super::exponent")]
    pub alpha: f64,
    /// Resolution in Å: the low-pass stops at 1 / resolution.
    pub resolution: f64,
    /// Length in Å whose inverse is the pass frequency, above `resolution`.
    pub pass_length: f64,
    /// Trim along the lifted axis.
    pub trim: Trim,
}

impl Default for KernelOptions {
    /// The options that `knotdock dock` uses: lambda, r0 and the resolution were chosen on training pairs
    /// (docs/research/defaults.md), alpha is B&I's.
    fn default() -> Self {
        Self {
            lambda: 9.0,
            offset: 2.2,
            alpha: 2.0,
            resolution: 4.5,
            pass_length: 9.0,
            trim: Trim::FlatTop,
        }
    }
}

/// Why a kernel cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum KernelError {
    /// The bump exponent is not above zero.
    #[error(transparent)]
    Alpha(#[from] AlphaError),
    /// A length is negative, zero, NaN or infinite where it may not be.
    #[error("{name} is {value}; it must be finite and {bound}")]
    Length {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its range.
        bound: &'static str,
    },
    /// The kernel is so long against its resolution, or rings so long, that its tables would take more than seconds, up
    /// to hours, or all memory.
    #[error(
        "the kernel reaches {reach:.3e} at a resolution of {resolution:.3e}: its tables would take too long; use a coarser resolution, \
         or a pass length farther from it, smaller radii or a smaller offset"
    )]
    TooLong {
        /// Distance at which the kernel would end, or radius sum at which its trim does if that is farther, in Å.
        reach: f64,
        /// The requested resolution, in Å.
        resolution: f64,
    },
}

/// Longest reach of a kernel in resolutions. Tables take the square of it in time. Those of the lifted axis take 5 s
/// here on one core (measured: 2.7 s at 100, 11 s at 200), those of a pair sum a second for each sum of two radii.
pub(super) const MAX_REACH: f64 = 140.0;
/// Most resolutions that the low-pass may ring over: those of a pass length a hundredth above the resolution.
pub(super) const MAX_RING_LENGTH: f64 = 102.0;
/// Smallest balls of a kernel, in resolutions: they overlap by the cube of this, and below it lengths run into denormal
/// numbers.
pub(super) const MIN_RADII: f64 = 1e-6;
/// Name of `Trim::BehandishIlies::length` in errors.
pub(super) const TRIM_LENGTH: &str = "length of the trim";
/// Largest |lambda|: its square times weights and volumes must stay within single precision.
const MAX_LAMBDA: f64 = 1e6;

impl KernelOptions {
    /// Weights of the slices at rho = 0, r0, 2 r0 in the score: -lambda^2, 2 lambda, -1.
    ///
    /// F_S = i (f_{S+B0} - lambda f_S) (B&I eq. 51), and the product of two such functions carries i * i = -1. B&I's
    /// eq. (52)-(53) conjugate one factor and so lose this sign; their text needs it.
    pub fn slice_weights(&self) -> [f64; 3] {
        [-self.lambda * self.lambda, 2.0 * self.lambda, -1.0]
    }

    /// Offsets rho of the three slices, in Å.
    pub fn slice_offsets(&self) -> [f64; 3] {
        [0.0, self.offset, 2.0 * self.offset]
    }

    /// Largest reward and largest magnitude of B&I's own score of a pair of the radius sum `sum` (Å) over distances; the
    /// reward is 0 if there is none.
    ///
    /// # Errors
    /// [`KernelError`] on options that define no kernel.
    pub(crate) fn extremes(&self, sum: f64) -> Result<(f64, f64), KernelError> {
        let bump = self.check()?;
        let (weights, offsets) = (self.slice_weights(), self.slice_offsets());
        let (mut reward, mut largest) = (0.0f64, 0.0f64);
        for step in 0..1000 {
            let distance = (sum + offsets[2]) * f64::from(step) / 1000.0;
            let slice = |i: usize| weights[i] * bump.value(distance / (sum + offsets[i]));
            let score: f64 = (0..3).map(slice).sum();
            (reward, largest) = (reward.max(score), largest.max(score.abs()));
        }
        Ok((reward, largest))
    }

    /// Checks the numbers and gives the bump function.
    ///
    /// # Errors
    /// [`KernelError`] for one out of its range.
    pub fn check(&self) -> Result<Bump, KernelError> {
        let bump = Bump::new(self.alpha)?;
        let trim = match self.trim {
            Trim::FlatTop => 1.0,
            Trim::BehandishIlies { length } => length,
        };
        let (lambda, offset, pass) = (self.lambda, self.offset, self.pass_length);
        let resolution = self.resolution;
        let bounds = [
            (
                "lambda",
                lambda,
                lambda.abs() <= MAX_LAMBDA,
                "between -1e6 and 1e6",
            ),
            ("offset r0", offset, offset >= 0.0, "not below 0"),
            ("resolution", resolution, resolution > 0.0, "above 0"),
            (
                "pass length",
                pass,
                pass > resolution,
                "above the resolution",
            ),
            (TRIM_LENGTH, trim, trim > 0.0, "above 0"),
        ];
        for (name, value, is_within, bound) in bounds {
            if !(value.is_finite() && is_within) {
                return Err(KernelError::Length { name, value, bound });
            }
        }
        Ok(bump)
    }
}

#[cfg(test)]
impl KernelOptions {
    /// Options with whole lengths, for unit tests.
    pub(crate) const TEST: Self = Self {
        lambda: 10.0,
        offset: 2.0,
        alpha: 2.0,
        resolution: 4.0,
        pass_length: 8.0,
        trim: Trim::FlatTop,
    };
}
