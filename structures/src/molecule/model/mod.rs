//! Data of a molecule: atoms, residues, chains, and what follows from their places.

pub(crate) mod chains;
pub(crate) mod copies;
pub(crate) mod groups;
pub(crate) mod molecule;
pub(crate) mod polar_atoms;
pub(crate) mod report;
pub(crate) mod residue_selection;
pub(crate) mod sequence;
pub(crate) mod side_chains;
pub(crate) mod surface;
pub(crate) mod unresolved;
