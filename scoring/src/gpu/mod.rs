//! Graphics processors through wgpu (Vulkan, Metal, Direct3D 12), in single precision: the device, and what its shaders
//! share.

mod device;
pub(crate) mod line_fft;

pub use device::{ADAPTER_VARIABLE, GpuDevice, GpuError};
