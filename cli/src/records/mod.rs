//! Records in JSON that the program writes or reads again.

pub mod ensemble_record;
pub mod recorded_run;
pub mod tradeoff;
