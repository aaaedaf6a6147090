//! The poses that a run may have: free ones, and those of rings.

pub mod axes;
pub mod refine;
pub(crate) mod ring;
