//! The inputs of a run: files named on the command line, in a table of pairs or in an earlier run's record.

pub mod bodies;
pub mod checks;
pub mod complex_sides;
pub mod conformations;
pub mod molecules;
pub mod native;
pub mod poses;
pub mod request;
pub mod robot;
pub mod solids;
