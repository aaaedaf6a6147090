//! Knots to spectra to correlations to scores.
//!
//! # Conventions
//!
//! - Lengths are in Å for molecules (or the mesh's unit), angles in radians, frequencies in cycles per Å.
//! - A pose is a unit quaternion q and a translation t: a ligand knot at y goes to R(q) y + t; a higher score is better.
//! - Fourier: f^(w) = sum f(x) exp(-2 pi i w.x); the inverse carries 1 / volume.
//! - The score is G = -lambda^2 g(0) + 2 lambda g(r0) - g(2 r0), g(rho) the correlation's slice at radius sum r + s + rho
//!   (Behandish & Ilieş, CAD 70, 2016, section 4.2; the sign follows their text, see [`affinity`]).
//! - Further effects are weighted terms that add to it, in the same sense and through the same filter.
//! - Errors are relative: of a score to the best exact score, of a slice to its largest value.
//!
//! # The way through
//!
//! [`kernel`] defines what shape scores and [`effect`] what may come beside it, [`exact`] scores one pose by the plain
//! pair sum, [`lifted_axis`] and [`transform`] carry kernel and knots to modes, [`engine`] correlates over all translations at a
//! rotation, [`configuration`] sums chosen modes at one pose, and [`field`] reads the correlation between its grid points. Of the poses that
//! a search keeps, [`rescoring`] asks what is too dear for the grid. [`symmetry`] has the poses of rings. Fast paths stand beside a slow exact one that tests hold them to.

pub mod affinity;
pub mod engine;
pub mod exact;
pub mod kernel;
pub mod lifted_axis;
pub mod peaks;
pub mod potential_grid;
pub mod se3;
pub mod so3;
pub mod symmetry;
pub mod terms;
#[cfg(test)]
mod test_support;
pub mod transform;
pub mod truncated;
mod vectorized;

pub use terms::{effect, pose as rescoring};
