//! Data of a molecule: atoms, residues, chains, and what follows from where they stand.

pub(crate) mod accessible;
pub(crate) mod atom;
pub(crate) mod buried;
pub(crate) mod chains;
pub(crate) mod copies;
pub(crate) mod cut_ends;
pub(crate) mod dihedral;
pub(crate) mod format;
pub(crate) mod groups;
pub(crate) mod held_side_chain;
pub(crate) mod molecule;
pub(crate) mod polar_atoms;
pub(crate) mod report;
pub(crate) mod report_text;
pub(crate) mod residue_selection;
pub(crate) mod sequence;
pub(crate) mod side_chains;
pub(crate) mod termini;
pub(crate) mod unresolved;
pub(crate) mod wording;
