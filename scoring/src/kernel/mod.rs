//! Kernels: the bump function, its transform, the lifted cone and the low-passed kernel that ranks poses.

pub mod bump;
pub mod cone;
pub mod low_pass;
pub mod radial_transform;
pub mod ranking;
#[cfg(test)]
mod reference;
pub mod table;

pub use bump::Bump;
pub use cone::{Cone, Trim};
pub use ranking::{KernelOptions, RankingKernel};
