//! Matching of the docked molecules' residues with the native's: by sequence, then by superposition.

pub(super) mod alignment;
pub(super) mod chain_pair;
pub(super) mod copies;
#[cfg(test)]
mod copy_tests;
pub(super) mod placements;
pub(super) mod superposition;
