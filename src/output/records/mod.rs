//! Records of runs in JSON: what was run, on which inputs, with which outcome.

pub mod ensemble_record;
pub mod input_record;
pub mod manifest;
pub mod program;
pub mod recorded_run;
pub mod tradeoff;
