//! Samplers: from a solid to balls.
//!
//! # Conventions
//!
//! - All coordinates, lengths and volumes are in the solid's own [`crate::mesh::Frame`]; what is written for users is
//!   in the file's unit.
//! - A depth is a signed distance to the surface, above zero inside.
//! - S is the solid, S(A) the union of the balls of a set A, X the nodes of the grid strictly inside S.
//!
//! # The samplers
//!
//! - [`decomposition`]: Behandish and Ilieş' Algorithm 1.
//! - [`packing`]: Weller and Zachmann's distance-greedy packing.
//! - [`octree`], and [`Method::Voxels`]: balls about the cells of an octree, and about voxels.
//! - [`medial`]: balls about points of the medial axis.
//! - [`lattice`]: balls of one radius, for correlating solids at a known resolution.
//!
//! The first five share one [`grid`], cover the same nodes X and are measured by [`hausdorff`]. [`feature_size`] says
//! how thick a solid is.

pub mod ball_tree;
mod beyond;
pub mod cover;
pub mod decomposition;
pub mod feature_size;
pub mod grid;
pub mod hausdorff;
pub mod lattice;
pub mod medial;
pub mod octree;
mod outward;
pub mod packing;
pub mod sample;
pub mod skeletal_density;
pub mod weights;

pub use self::sample::{BallSet, Method, SampleError, Sampling, SetName, Step, knots, sample};
pub use crate::ball::Ball;
