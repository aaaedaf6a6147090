//! Records of runs in JSON: what was run, on which inputs, with which outcome.

pub mod input_record;
pub mod manifest;
pub mod program;
