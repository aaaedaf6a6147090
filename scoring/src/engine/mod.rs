//! Engines: the correlation over all translations at a rotation. One plan, one answer, whatever runs it.

pub mod cpu;
pub mod plan;

pub use cpu::{CpuEngine, Workspace};
pub use plan::{EngineOptions, PairKernel, Plan, PlanError};
