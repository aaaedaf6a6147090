//! The options of an engine.

use crate::kernel::KernelOptions;
use serde::{Deserialize, Serialize};

/// Options of the engine: the kernel, and the parameters of the approximation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EngineOptions {
    /// The kernel that is correlated.
    pub kernel: KernelOptions,
    /// Grid spacing in Å; `None`: as the tolerance needs, resolution / 2 at most.
    pub spacing: Option<f64>,
    /// Error of the fast path that is aimed at, relative to the best score.
    pub tolerance: f64,
}

impl Default for EngineOptions {
    /// The kernel of `knotdock dock` on the grid that a tolerance of 1e-2 needs.
    fn default() -> Self {
        Self {
            kernel: KernelOptions::default(),
            spacing: None,
            tolerance: 1e-2,
        }
    }
}
