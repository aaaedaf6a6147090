//! knotdock: the pipeline from two structures to a ranked list of poses.

pub mod output;
pub mod search;
