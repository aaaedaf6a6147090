//! knotdock docks two proteins, or fits two solids, and ranks the poses.
//!
//! # Example
//!
//! [`dock()`] is the entry (`cargo run --release --example dock`); [`Docking`] adds progress and a deadline:
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
//! | [`mod@dock`] | plan, run and outcome of a docking |
//! | [`evaluate`] | distance of poses from a known complex |
//! | [`interface`], [`refine`], [`score`] | contacts of complexes, better models, one pose |
//! | [`models`], [`redock`] | predicted models with their confidence; predicted poses docked again |
//! | [`mesh`], [`geometry`] | meshes that dock; collisions, obstacles, Minkowski operations |
//! | [`ensemble`] | several conformations in one ranking |
//! | [`output`] | the folder of a run: `poses.csv`, complexes, `run.json` |
//!
//! The program is the crate `knotdock-cli`. Structures are read by `knotdock_structures`, correlations computed by `knotdock_scoring`. Lengths are in Å for
//! molecules and in the files' unit for meshes. A pose takes a ligand atom at x to R x + t. A higher score is better.

pub mod bounded_read;
pub mod dock;
mod docking;
pub mod ensemble;
mod error;
pub mod evaluate;
pub mod geometry;
pub mod interface;
pub mod memory_size;
pub mod mesh;
pub mod models;
pub mod options;
pub mod output;
pub mod plain_path;
pub mod pose_geometry;
pub mod pose_space;
pub mod predictions;
pub mod priors;
pub mod progress;
pub mod rank;
pub mod redock;
pub mod refine;
pub mod restraints;
pub mod score;
pub mod search;
pub mod side_chains;
pub mod table_text;
#[cfg(test)]
mod test_molecules;
pub mod threads;

pub use docking::{Docking, Run, dock};
pub use geometry::collide::Collision;
pub use knotdock_structures::Error;
pub use knotdock_structures::mesh::Mesh;
pub use knotdock_structures::molecule::Molecule;
pub use options::DockOptions;
