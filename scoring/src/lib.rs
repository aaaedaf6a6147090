//! Knots to spectra to correlations to scores.

pub mod affinity;
pub mod engine;
pub mod exact;
pub mod field;
pub mod kernel;
pub mod lifted_axis;
pub mod se3;
pub mod transform;
