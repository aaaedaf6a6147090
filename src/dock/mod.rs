//! A docking run: from the scene and the options to ranked poses.

mod effect_timings;
pub mod flexible_regions;
pub mod outcome;
pub mod pair;
pub mod plan;
pub mod run;
pub mod scene;
