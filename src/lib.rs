//! knotdock: the pipeline from two structures, or two meshes, to a ranked list of poses.

pub mod evaluate;
pub mod output;
pub mod pose_geometry;
pub mod priors;
pub mod score;
pub mod search;
pub mod tradeoff;
