//! The search: a scan of all rotations, then of finer ones about the best, by the engine in use.

pub(crate) mod allowed;
pub mod coarse_to_fine;
pub(crate) mod deadline;
pub mod plan;
pub(crate) mod scan;
pub mod scan_engine;
pub(crate) mod schedule;
