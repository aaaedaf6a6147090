//! knotdock docks two proteins, or fits two solids, and ranks the poses.
//!
//! # Example
//!
//! Two structures become a plan, and the plan a ranked list (`cargo run --release --example dock`):
//!
//! ```
// No input may end in a panic; tests may.
#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]
#![doc = include_str!("../examples/dock.rs")]
//! ```
//!
//! # Where things are
//!
//! | module | content |
//! |---|---|
//! | [`options`] | the options of a run, each defined once |
//! | [`dock`] | plan, run and outcome of a docking |
//! | [`evaluate`] | distance of poses from a known complex |
//! | [`interface`], [`refine`], [`score`] | contacts of complexes, better models, one pose |
//! | [`mesh`], [`geometry`] | meshes that dock; collisions, obstacles, Minkowski operations |
//! | [`ensemble`], [`tradeoff`] | several conformations in one ranking; accuracy against time |
//! | [`output`], [`report`] | files of runs, reports in a browser |
//! | [`cli`] | the command line |
//!
//! Structures are read by `knotdock_structures`, correlations computed by `knotdock_scoring`. Lengths are in Å for
//! molecules and in the files' unit for meshes. A pose takes a ligand atom at x to R x + t. A higher score is better.

pub mod bounded_read;
pub mod dock;
pub mod ensemble;
mod error;
pub mod evaluate;
pub mod geometry;
pub mod interface;
pub mod memory_size;
pub mod mesh;
pub mod options;
pub mod output;
pub mod plain_path;
pub mod pose_geometry;
pub mod pose_space;
pub mod predictions;
pub mod priors;
pub mod progress;
pub mod rank;
pub mod refine;
pub mod restraints;
pub mod score;
pub mod search;
pub mod side_chains;
pub mod table_text;
#[cfg(test)]
mod test_molecules;
pub mod threads;

pub use geometry::collide::Collision;
pub use knotdock_structures::Error;
