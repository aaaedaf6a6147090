//! Graphics processors through wgpu (Vulkan, Metal, Direct3D 12), in single precision: the device, what its shaders
//! share, and the computations of [`crate::processor`].
//!
//! A [`Job`] uploads its input when it is made: [`Job::pair_sums`], [`Job::pair_distances`], [`Job::knot_modes`],
//! [`WaveSums`], [`GapGrid`]. It then runs on the card alone, and its results are read when they are wanted.

mod ceilings;
mod device;
mod gap_grid;
mod job;
pub(crate) mod kernel;
mod knot_modes;
pub(crate) mod line_fft;
pub(crate) mod lines;
mod pair_sums;
mod processor;
mod wave_sums;

pub use ceilings::Ceilings;
pub use device::{ADAPTER_VARIABLE, GpuDevice, GpuError};
pub use gap_grid::GapGrid;
pub use job::Job;
pub use wave_sums::WaveSums;
