//! The choice between the two pair kernels.

use crate::kernel::ProductKernel;

/// The function of two balls that a plan correlates.
#[derive(Clone, Debug)]
pub enum PairKernel {
    /// The lifted cone at r + s + rho, low-passed and windowed: `Plan::kernel`.
    Lifted,
    /// The overlap of the two balls' bumps, whose transform factorises: no lifted axis is needed, radii meet as they
    /// are.
    Product(Box<ProductKernel>),
}
