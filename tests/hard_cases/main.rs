//! The numerical hard cases, one file a family, each with its reason: what could go wrong there, and the independent reference that holds
//! the code to its bound. One program, since each would compile the transforms anew.

#[path = "../../scoring/tests/scene/mod.rs"]
mod scene;

mod identities;
mod kernel;
mod knots;
mod precision;
mod properties;
mod transform;
mod wrap_around;
