//! The tests of the crate, one module a subject, in one program: each further one would link all crates again.
//! `cargo test -p knotdock-structures --test all SUBJECT` runs a subject.

mod assemblies;
mod ball_solids;
mod contact;
mod damaged_files;
mod facing;
mod hard_meshes;
mod hard_mmcif_input;
mod hard_pdb_input;
mod large_files;
mod left_out;
mod mesh_dialects;
mod mesh_files;
mod mesh_solid;
mod mesh_welding;
mod models;
mod other_names;
mod out_of_place;
mod pdb_text;
mod policies;
mod predicted_models;
mod sampler;
mod selection;
mod solids;
mod weights;
mod write_and_read_again;
