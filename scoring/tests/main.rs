//! The tests of the crate, one module a subject, in one program: each further one would link all crates again.
//! `cargo test -p knotdock-scoring --test all SUBJECT` runs a subject.

mod scene;

mod cancellation;
mod effects;
mod fast_path;
#[cfg(feature = "gpu")]
mod gpu;
mod identities;
mod nfft;
mod potential_grid;
#[cfg(feature = "gpu")]
mod processor;
mod skin_weights;
mod truncated;
mod uniform_grid;
