//! `knotdock dock` of several conformations: each pair of them a run, and one ranking.

mod aligned;
pub mod finished;
mod results;
mod run;

pub use run::{Ensemble, EnsembleRequest};
