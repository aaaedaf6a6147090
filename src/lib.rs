//! knotdock: the pipeline from two structures, or two meshes, to a ranked list of poses.

// No input may end in a panic; tests may.
#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

pub mod bounded_read;
pub mod cli;
pub mod dock;
pub mod ensemble;
pub mod error;
pub mod evaluate;
pub mod geometry;
pub mod interface;
pub mod mesh;
pub mod named_columns;
pub mod options;
pub mod output;
pub mod plot;
pub mod pose_geometry;
pub mod pose_space;
pub mod predictions;
pub mod priors;
pub mod progress;
pub mod rank;
pub mod refine;
pub mod report;
pub mod restraints;
pub mod score;
pub mod search;
pub mod side_chains;
pub mod system_limits;
#[cfg(test)]
mod test_molecules;
pub mod threads;
pub mod tradeoff;
