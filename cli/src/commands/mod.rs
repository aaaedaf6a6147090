//! The commands, one file or folder each: options, calls of the library, output.

pub mod batch;
pub mod collide;
pub mod completions;
pub mod dock;
pub mod evaluate;
pub mod export;
pub mod inspect;
pub mod interface;
pub mod merge;
pub mod models;
pub mod morph;
pub mod obstacle;
pub mod preset;
pub mod refine;
pub mod report;
pub mod sample;
pub mod score;
pub mod se3;
pub mod serve;
pub mod tradeoff;
