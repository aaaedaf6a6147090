//! `knotdock dock` of several conformations: each pair of them a run, and one ranking.

pub mod finished;
mod laid;
mod place;
mod run;
mod written;

pub use run::Ensemble;
