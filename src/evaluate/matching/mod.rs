//! Which residues of the docked molecules are which of the native: sequences, then superposition.

pub(super) mod alignment;
pub(super) mod chain_pair;
pub(super) mod copies;
#[cfg(test)]
mod copy_tests;
pub(super) mod placement;
mod placement_builder;
pub(super) mod placements;
pub(super) mod superposition;
