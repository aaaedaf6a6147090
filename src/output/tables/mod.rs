//! Tables: `poses.csv`, refined poses, the results of batches, tables of pairs and of atoms.

pub mod atom_table;
pub mod batch_results;
pub mod collisions;
pub mod complexes;
pub mod fields;
pub mod interface;
pub mod interface_shares;
pub mod pair_table;
pub(super) mod pose_columns;
pub mod pose_list;
pub mod poses;
pub mod poses_reader;
pub mod quality;
pub mod refined;
pub mod report;
pub mod restraints;
pub mod run_table;
