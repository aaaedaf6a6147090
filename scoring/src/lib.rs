//! The scoring crate: knots to spectra to correlations to scores.
//!
//! # Example
//!
//! [`Correlator`] is the entry (`cargo run -p knotdock-scoring --example correlate`):
//!
//! ```

// No input may end in a panic; tests may.
#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]
#![doc = include_str!("../examples/correlate.rs")]
//! ```
//!
//! # Conventions
//!
//! - Lengths are in Å for molecules (or the mesh's unit), angles in radians, frequencies in cycles per Å.
//! - A pose is a unit quaternion q and a translation t: a ligand knot at y goes to R(q) y + t.
//! - A higher score is better.
//! - Fourier: f^(w) = sum f(x) exp(-2 pi i w.x); the inverse carries 1 / volume.
//! - The score is G = -lambda^2 g(0) + 2 lambda g(r0) - g(2 r0), where g(rho) is the correlation's slice at radius sum
//!   r + s + rho. Source: Behandish & Ilieş, CAD 70, 2016, section 4.2; the sign follows their text: eq. 52-53 conjugate
//!   one of two affinity functions and so lose the factor i * i = -1.
//! - Further effects are weighted terms that add to it, in the same sense and through the same filter.
//! - Errors are relative: of a score to the best exact score, of a slice to its largest value.
//!
//! # Modules
//!
//! | module | content |
//! |---|---|
//! | [`kernel`], [`quantity`] | shape: pair kernels, score and slices |
//! | [`terms::effect`] | terms of the search: shape, and sums over labelled pairs of knots |
//! | [`exact`] | the plain pair sum of one pose, which every fast path is tested against |
//! | [`transform`] | knots to modes and modes to grids |
//! | [`lifted_axis`] | the fourth axis: modes along the radius |
//! | [`engine`] | the correlation over all translations at a rotation: plan, rank, CPU, graphics processor |
//! | `gpu` | graphics processors, with the feature of this name |
//! | [`truncated`] | the correlation at one pose from chosen modes |
//! | [`overlap`] | overlap energy of weighted balls at one pose: force, torque, certified hits |
//! | [`minkowski`], [`gap_grid`] | Minkowski sums of balls by pairs; the gap function on a uniform grid |
//! | [`processor`] | these, and sums and transforms of knots, on the CPU or a graphics processor |
//! | [`potential_grid`] | score and gradient between the voxels |
//! | [`se3`], [`so3`], [`peaks`] | poses, rotation sets, the best voxels of a grid |
//! | [`grid_turn`] | turns that map a grid onto itself |
//! | [`sharp`] | the energy of rigid bodies at atomic resolution, and its optima near a pose |
//! | [`symmetry`] | poses of cyclic and dihedral rings |
//! | [`terms::pose`] | terms that score the poses which a search keeps |

mod blocks;
mod correlator;
mod distance_floors;
pub mod engine;
pub mod exact;
pub mod exact_sum;
pub mod gap_grid;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod grid_turn;
pub mod kernel;
mod lanes;
pub mod lifted_axis;
pub mod minkowski;
pub mod overlap;
pub mod peaks;
pub mod potential_grid;
mod precision;
pub mod processor;
pub mod quantity;
mod rigid_move;
pub mod se3;
pub mod sharp;
pub mod so3;
pub mod symmetry;
pub mod terms;
#[cfg(test)]
mod test_support;
pub mod transform;
pub mod truncated;
pub mod vectorized;

pub use correlator::{Correlation, Correlator, CorrelatorError, GridPose};
/// The engine's options, under the name that the front door gives them.
pub use engine::EngineOptions as Options;
pub use precision::Precision;
