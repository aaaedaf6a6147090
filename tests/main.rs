//! The tests of the program and its library, one module a subject.
//!
//! One program holds them all: each further one would link all crates again and wait for the slowest test of the last.
//! `cargo test -p knotdock-cli --test all SUBJECT` runs a subject.

#[path = "../structures/examples/docking_parts/mod.rs"]
#[allow(dead_code)] // The example writes files, which the tests do by themselves.
mod docking_parts;
mod molecules;
mod program;
#[path = "../scoring/tests/scene/mod.rs"]
mod scene;

mod bad_input;
mod batch;
mod collide;
mod collide_exact;
mod command_line;
mod complex_models;
mod config;
mod crash;
mod dock_run;
mod documents;
mod effects;
mod ensembles;
mod example;
mod fuzz;
mod geometry;
#[cfg(feature = "gpu")]
mod graphics;
mod hard_cases;
mod hostile_names;
mod interface;
mod json_objects;
mod known_complex;
mod known_surfaces;
mod machine;
mod memory;
mod mesh_docking;
mod models;
mod paper_figures;
mod predictors;
mod reading;
mod redock;
mod refine;
mod reports;
mod residues_by_name;
mod restraints;
mod rings;
mod sample;
mod score;
mod scoring_table;
#[cfg(feature = "serve")]
mod serve;
mod sharp_fits;
mod tradeoff;
mod views;
