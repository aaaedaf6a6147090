//! The non-uniform fast Fourier transform (NUFFT): both types, three or four dimensions, single or double precision.
//!
//! This is the general transform, of any points and any number of modes per axis. The search uses `pruned_type1`: type 1
//! alone, of knots inside a block of the box, with only the modes of a [`super::modes::ModeSet`].
//!
//! # Conventions
//!
//! Points are in units of the period on each axis (divide a length by the box length first); any finite value stands
//! for its fractional part. They are always f64.
//!
//! - [`Plan::forward`] (type 1, points to modes): f_k = sum_j c_j exp(-2 pi i k.x_j).
//! - [`Plan::adjoint`] (type 2, modes to values at the points): v_j = sum_k f_k exp(+2 pi i k.x_j), the exact adjoint
//!   of the first: <F c, f> = <c, F* f>. Neither is normalised.
//! - Modes of an axis with n of them are k = -floor(n/2), ..., ceil(n/2) - 1, in this order; any n >= 1. Arrays of
//!   modes are row-major, the last axis fastest.
//! - The tolerance is the error in the 2-norm over all modes (or values), relative to the norm of the whole. It is a
//!   root mean square: a value at a single point may miss it by a factor of two. Tolerances that single precision or a
//!   window of 16 points cannot reach are refused.
//! - A weight that is not finite makes modes that are not finite; a point that is not finite is an error.
//!
//! # How
//!
//! Each point is spread onto a window of a finer grid (Kaiser-Bessel, its shape chosen at planning for the least
//! error). The grid is transformed, and the window's own transform divided out. Sorting and blocking follow Barnett,
//! Magland and af Klinteberg, SIAM J. Sci. Comput. 41 (2019) C479.
//!
//! The fine grid never exists as a whole: a ring of planes along the first axis travels through the sorted points. Each
//! plane is transformed along its own axes while it is in the cache, and each axis leaves only the modes that are kept.
//! The first axis goes last.
//!
//! ```
//! use knotdock_scoring::transform::nufft::Plan;
//! use num_complex::Complex64;
//! let plan = Plan::<f64, 3>::new([8, 9, 1], 1e-6, 2)?;
//! let points = plan.locate(&[[0.1, 0.2, 0.3], [0.5, 0.75, 0.0]])?;
//! let mut work = plan.workspace();
//! let mut modes = vec![Complex64::default(); 8 * 9];
//! plan.forward(&points, &[Complex64::new(1.0, 0.0), Complex64::new(0.0, 2.0)], &mut work, &mut modes)?;
//! // k = 0 is the sum of the weights.
//! assert!((modes[4 * 9 + 4] - Complex64::new(1.0, 2.0)).norm() < 1e-5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adjoint;
mod execute;
mod forward;
mod plan;
mod sorted_points;
mod spread;
mod window;

pub use execute::Workspace;
pub use plan::{Plan, PlanError, TransformError};
pub use sorted_points::SortedPoints;

/// Lines that are transformed together: their transposed writes then fill whole cache lines.
const GROUP: usize = 8;
/// As `GROUP`, for the first axis, whose points have a stride of a plane: longer runs for each plane's page of memory.
const FIRST_GROUP: usize = 32;

/// Place of mode `index` (0 for k = -floor(modes/2)) in a transform of `length` points.
#[inline(always)]
fn place(index: usize, modes: usize, length: usize) -> usize {
    let half = modes / 2;
    if index < half {
        length - half + index
    } else {
        index - half
    }
}
