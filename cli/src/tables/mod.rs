//! Tables of the program's commands, and those of the terminal.

pub mod atom_table;
pub mod batch_results;
pub mod collisions;
pub mod complexes;
pub mod interface;
pub mod pair_table;
pub mod pose_list;
pub mod refined;
pub mod report;
