//! The inputs of a run: files named on the command line, in a table of pairs or in an earlier run's record.

mod ball_files;
pub mod batch_pairs;
pub mod bodies;
pub mod complex_sides;
pub mod conformations;
pub mod meshes;
pub mod molecules;
pub mod poses;
pub mod ranked_rows;
pub mod recent_molecules;
pub mod request;
pub mod room;
pub mod shapes;
pub mod solids;
pub mod traces;
