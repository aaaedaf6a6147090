//! Points near a point: lists of points by cubic cell.
//!
//! - [`CellList`] holds points that are all known beforehand, in one piece of memory: for hot loops.
//! - [`SpatialHash`] takes points one at a time, at any distance from each other.
//! - `box_tree` halves things at places into a tree of boxes.
//! - [`Bins`] sorts items by the number of their bin, in any number of dimensions.
//!
//! The lists visit points in one fixed order: cells by rising x, then y, then z, and the points of a cell in the
//! order in which they were given. Sums over neighbours therefore have the same bits in every run.

pub(crate) mod box_tree;
mod cell_list;
mod spatial_hash;

pub use cell_list::{Bins, CellList, Member};
pub use spatial_hash::SpatialHash;
#[cfg_attr(not(feature = "mesh"), allow(unused_imports))]
pub(crate) use spatial_hash::{Cell, around, cell_of};
