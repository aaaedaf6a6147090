//! Knots to spectra to correlations to scores.

pub mod kernel;
pub mod se3;
pub mod transform;
