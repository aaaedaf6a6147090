//! Docking of meshes: three pairs of parts that fit are put together again. Also tested are the files written, and
//! what is refused.

#[path = "../../structures/examples/docking_parts/mod.rs"]
#[allow(dead_code)] // The example writes files, which the tests do by themselves.
mod parts;

mod landscape;
mod scenes;

mod assembled;
mod balls;
mod fairness;
mod refused;
mod run;
