//! Tables: `poses.csv`, refined poses, the results of batches, tables of pairs and of atoms.

pub mod fields;
pub(super) mod pose_columns;
pub mod poses;
pub mod poses_reader;
pub mod quality;
pub mod restraints;
pub mod run_table;
