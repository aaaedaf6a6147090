//! Numerical building blocks: the bump function, quadrature of functions with steep ends, and Chebyshev interpolation.

pub mod bump;
pub mod chebyshev;
pub mod double_exponential;

pub use bump::Bump;
