//! Kernels: the bump function, its transform, the lifted cone, the low-passed kernel that ranks poses, and the product
//! kernel of rasterised bumps.

mod cone;
pub mod exponent;
mod options;
pub mod product;
mod product_sum;
pub(crate) mod radial_filter;
pub mod radial_transform;
mod ranking;
#[cfg(test)]
mod reference;
pub mod table;

pub use cone::Trim;
pub use knotdock_structures::numeric::{Bump, bump};
pub use options::{KernelError, KernelOptions};
pub use product::{Band, ProductKernel};
pub use product_sum::ProductScorer;
pub use radial_filter::smooth_step_down;
pub use ranking::RankingKernel;
