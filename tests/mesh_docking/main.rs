//! Docking of meshes: three pairs of parts that fit together, put together again; what comes of it in files; and what is refused.

#[path = "../../structures/examples/docking_parts/mod.rs"]
mod parts;

mod landscape;
mod scenes;

mod assembled;
mod refused;
mod run;
