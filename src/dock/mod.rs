//! A docking run: from the scene and the options to ranked poses.

mod effect_costs;
pub mod effect_decisions;
pub mod gaps;
pub mod memory;
pub mod outcome;
pub mod pair;
pub mod plan;
mod plan_text;
pub mod run;
pub mod scene;
pub mod shared_process;
pub mod stopwatch;
