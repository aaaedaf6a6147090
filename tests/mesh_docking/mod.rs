//! Docking of meshes: three pairs of parts that fit are put together again. Also tested are the files written, and
//! what is refused.

use crate::docking_parts as parts;

mod landscape;
mod scenes;

mod assembled;
mod balls;
mod fairness;
mod refused;
mod run;
