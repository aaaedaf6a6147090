//! Knowledge of where molecules touch: residues that a user names, and those of active sites and of antibodies.

pub mod active_residues;
pub mod restraints;
