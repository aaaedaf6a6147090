//! Graphics processors through wgpu (Vulkan, Metal, Direct3D 12), in single precision: the device, what its shaders
//! share, and the computations of [`crate::processor`].
//!
//! A computation is made from its input, which it uploads. `run` then computes on the card alone and waits, as often as
//! one likes, and `read` brings the result back.

mod device;
mod gap_grid;
pub(crate) mod kernel;
mod knot_modes;
pub(crate) mod line_fft;
pub(crate) mod lines;
mod pair_sums;
mod processor;
mod wave_sums;

pub use device::{ADAPTER_VARIABLE, GpuDevice, GpuError};
pub use gap_grid::GapGrid;
pub use knot_modes::KnotModes;
pub use pair_sums::{PairDistances, PairSums};
pub use wave_sums::{WaveHits, WaveSums};
