//! Graphics processors through wgpu (Vulkan, Metal, Direct3D 12), in single precision: the device, and what its shaders
//! share.

mod ceilings;
mod device;
pub(crate) mod line_fft;

pub use ceilings::Ceilings;
pub use device::{ADAPTER_VARIABLE, GpuDevice, GpuError};
