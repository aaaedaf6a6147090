//! Knots to spectra to correlations to scores.

pub mod se3;
