//! Pictures as SVG: charts with logarithmic axes, and a small writer for drawings that are no charts.
//!
//! Charts are drawn by plotters, whose SVG backend needs no font: a viewer sets the text in its own monospaced face.

pub mod chart;
mod labels;
pub mod svg;
