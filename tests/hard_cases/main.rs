//! The numerical hard cases and identities of kernels, transforms, precision and the periodic box: one file a family,
//! each case with its reason, and its story where it first failed. One program, since every one that uses the engines
//! compiles them anew.

#[path = "../../scoring/tests/scene/mod.rs"]
mod scene;

mod identities;
mod kernel;
mod knots;
mod precision;
mod properties;
mod proteins;
mod transform;
mod wrap_around;
