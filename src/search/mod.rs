//! The search: a scan of all rotations, then of finer ones about the best, by the engine in use.

pub mod coarse_to_fine;
pub mod peaks;
pub mod rotations;
pub(crate) mod scan;
pub(crate) mod scan_engine;
pub mod schedule;
