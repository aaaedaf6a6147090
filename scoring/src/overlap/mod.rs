//! Overlap energy of two weighted ball sets at a pose, with force and torque.
//!
//! E(R, t) = <f_A, f_B o pose^-1> = sum over pairs of w_i v_j <psi_ri, psi_sj>(|R y_j + t - x_i|), with f the sum of a
//! body's weighted bumps. It is B&I eq. 50 with the product kernel ([`crate::kernel::product`]): an integral over
//! space, so that balls of any size count by volume. Energies are volumes, in the cube of the balls' unit.
//!
//! - Pairs: [`PairOverlap`] is the kernel, [`Accumulator`] the sum that a tree traversal feeds, [`overlap_of_all`] the
//!   sum over all pairs.
//! - Modes: [`OverlapModes`] sums the lowest Fourier modes of both bodies, with a bound on the rest that can certify a
//!   hit; [`OverlapModes::start`] does so block by block, until a deadline or a certified hit.
//!
//! [`pairs_nanoseconds`] and [`OverlapModes::nanoseconds`] estimate the costs. Those of pairs grow with the pairs that
//! meet; modes cost the same at every pose, and certify a hit of deep bodies after about a hundred.
//!
//! ```
//! use knotdock_scoring::overlap::{Accumulator, OverlapModes, PairOverlap, WeightedBall, overlap_of_all};
//! use knotdock_scoring::se3::Pose;
//!
//! let ball = |x: f64, radius| WeightedBall { center: [x, 0.0, 0.0], radius, weight: 1.0 };
//! let (a, b) = ([ball(0.0, 2.0), ball(1.5, 1.0)], [ball(0.0, 1.0), ball(0.5, 0.25)]);
//! let kernel = PairOverlap::new(2.0)?;
//! let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [1.0, 0.5, 0.0]);
//! // All pairs, with the torque about the origin.
//! let pairs = overlap_of_all(&kernel, &a, &b, &pose, [0.0; 3]);
//! // A traversal feeds the same sum.
//! let mut sum = Accumulator::new(&kernel, [0.0; 3]);
//! assert!(sum.add(&a[0], &WeightedBall { center: pose.apply(b[0].center), ..b[0] }));
//! assert!(sum.sum().energy < pairs.energy);
//! // The lowest 2000 modes, until they certify the hit.
//! let modes = OverlapModes::new(&kernel, &a, &b, 2000)?;
//! let hit = modes.start(&pose, &mut modes.workspace()).advance(|sum| sum.certifies_hit());
//! assert!(hit.certifies_hit());
//! assert!((hit.energy - pairs.energy).abs() <= hit.tail + hit.rounding);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//!
//! The force is -dE/dt on body B, the torque minus the slope of E by a turn of B about a chosen point, both in A's
//! frame. Body A feels the opposite. A pose takes a ball of B at y to R y + t.
//!
//! Bumps vanish with all their derivatives at the end of their ball, so the energy of balls that graze underflows:
//! grazing contact is decided by d < r + s ([`meet`], [`Overlap::pairs`]). An energy above its error shows a hit; an
//! energy of 0 shows nothing.

mod accumulator;
mod modes;
mod pair;
mod pair_table;
mod quadrature;
#[cfg(test)]
mod tests;

pub use accumulator::{Accumulator, Overlap, WeightedBall, overlap_of_all, pairs_nanoseconds};
pub use modes::{ModesOverlap, ModesSum, ModesWorkspace, OverlapModes};
pub use pair::{PairOverlap, meet};
