//! Search: rotations, peaks, refinement, clusters and ranks.

pub mod cluster;
pub mod options;
pub mod outcome;
pub mod peaks;
pub mod plan;
mod ranking;
pub mod refine;
pub mod rotations;
pub mod run;
mod scan;

pub use options::{DockOptions, Effect, SearchError};
pub use outcome::{DockOutcome, EffectCost, MeasuredError, RankedPose, StageTime};
pub use plan::{DockPlan, plan};
pub use run::{Progress, dock};
