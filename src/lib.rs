//! knotdock: the pipeline from two structures, or two meshes, to a ranked list of poses.

pub mod evaluate;
pub mod output;
pub mod score;
pub mod search;
