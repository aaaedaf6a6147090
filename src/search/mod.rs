//! Search: rotations, peaks, refinement, clusters and ranks.

pub mod attracted;
pub mod axes;
mod candidates;
pub mod chance;
pub mod cluster;
pub mod coarse_to_fine;
mod correlator;
mod costs;
pub mod effect_choice;
pub mod effects;
pub mod error;
pub mod loose;
pub mod meshes;
pub mod options;
pub mod outcome;
pub mod peaks;
pub mod plan;
mod ranking;
pub mod refine;
mod rescoring;
pub mod restraints;
mod ring;
pub mod rotations;
pub mod run;
mod scan;

pub use attracted::AssumedSite;
pub use effect_choice::EffectChoice;
pub use effects::{Decision, LengthUnit, Scene};
pub use error::SearchError;
pub use knotdock_scoring::effect::Effect;
pub use loose::Loose;
pub use options::DockOptions;
pub use outcome::{Adapter, DockOutcome, EffectCost, MeasuredError, RankedPose, StageTime};
pub use plan::{DockPlan, plan, plan_scene};
pub use restraints::AntibodySurface;
pub use run::{Progress, dock, molecule_points};
