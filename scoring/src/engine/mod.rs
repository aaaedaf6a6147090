//! Engines: the correlation over all translations at a rotation. One plan, one answer, whatever runs it: the CPU, or
//! with the feature `gpu` a graphics processor.

mod columns;
pub(crate) mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
mod memory;
mod packed;
mod plan;
mod rank;
pub(crate) mod receptor_spectra;

pub use cpu::{CpuEngine, Workspace};
pub use memory::EngineMemory;
pub use plan::{EngineOptions, PairKernel, Plan, PlanError};
pub(crate) use rank::measured_error;
pub use rank::{ChosenRank, choose_rank};
pub(crate) use receptor_spectra::Factors;
pub use receptor_spectra::ReceptorSpectra;
