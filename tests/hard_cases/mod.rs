//! The numerical hard cases and identities of kernels, transforms, precision and the periodic box: one file a family,
//! each case with its reason, and its story where it first failed.

mod identities;
mod kernel;
mod knots;
mod precision;
mod properties;
mod proteins;
mod transform;
mod wrap_around;
