//! Options of the commands, by subject, and the values that they take.

pub mod conformations;
pub mod machine;
pub mod memory;
pub mod options;
pub mod output_file;
pub mod program;
pub mod ranks;
pub mod solid_output;
pub mod viewer;
