//! Search: rotations, peaks, refinement, clusters and ranks.

pub mod outcome;
