//! Engines: the correlation over all translations at a rotation. One plan, one answer, whatever runs it: the CPU, or
//! with the feature `gpu` a graphics processor.
//!
//! [`uniform_grid`] is the baseline to compare with: rasterised bumps on a grid, the product kernel alone, a plan of
//! its own.

mod columns;
pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
mod memory;
mod packed;
pub mod plan;
mod preparation;
mod probes;
mod rank;
pub mod receptor_spectra;
mod resolved;
mod traffic;
pub mod uniform_grid;

pub use cpu::{CpuEngine, Workspace};
pub use memory::EngineMemory;
pub use plan::{EngineOptions, PairKernel, Plan, PlanError};
pub(crate) use probes::measured_error;
pub use rank::{ChosenRank, choose_rank};
pub use receptor_spectra::{Factors, ReceptorSpectra};
pub use uniform_grid::{UniformGrid, UniformGridOptions, UniformGridPlan, UniformGridWorkspace};
