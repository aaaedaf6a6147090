//! Tradeoff of accuracy and time: settings around a default, each run and measured, and which of them is worth taking.
//!
//! # Conventions
//!
//! - Time is that of all stages of a run, in seconds; settings are compared by processor time. Errors are shares of
//!   the best exact score.
//! - Sampling, planning and searching are those of `knotdock dock`: nothing is modelled that can be run.

pub mod advice;
pub mod choice;
pub mod measured;
pub mod plot;
pub mod settings;
pub mod sweep;

pub use measured::{Measured, Tradeoff};
pub use settings::Parameter;
pub use sweep::sweep;
