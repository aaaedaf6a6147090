//! Options of the commands, by subject, and the values that they take.

pub mod idle;
pub mod machine;
pub mod memory;
pub mod native;
pub mod output_file;
pub mod ranks;
pub mod reading;
pub mod search;
pub mod values;
