//! Points near a point: lists of points by the cubic cell that they lie in.
//!
//! - [`CellList`] holds points that are all known beforehand, in one piece of memory: for hot loops.
//! - [`SpatialHash`] takes points one at a time, at any distance from each other.
//! - [`CoveringBalls`] says whether one of many balls holds a point, however they crowd.
//! - `box_tree` halves things at places into a tree of boxes.
//! - [`Bins`] is the counting sort below the first: items by the number of their bin, in any number of dimensions.
//! - [`cell`] says which cell a point lies in and which cells touch it.
//!
//! The lists visit points in one fixed order: cells by rising x, then y, then z, and the points of a cell in the
//! order in which they were given. Sums over neighbours therefore have the same bits in every run.

mod bins;
pub(crate) mod box_tree;
pub mod cell;
mod cell_list;
mod covering_balls;
mod spatial_hash;

pub use bins::Bins;
pub use cell_list::{CellList, Member};
pub use covering_balls::CoveringBalls;
pub use spatial_hash::SpatialHash;
