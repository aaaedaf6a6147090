//! What of two molecules is not sure to be where their files show it, or is not shown: residues that are missing, and those near ends of chains.

use super::options::DockOptions;
use knotdock_structures::molecule::{Molecule, Termini, UnresolvedResidues};
use serde::Serialize;

/// What is loose of receptor and ligand; nothing where it costs nothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Loose {
    /// Residues that are missing from their files.
    pub missing_residues: [UnresolvedResidues; 2],
    /// Residues near ends of their chains.
    pub chain_end_residues: [Termini; 2],
}

impl Loose {
    /// What is loose of two molecules.
    pub(super) fn of(molecules: [&Molecule; 2], options: &DockOptions) -> Self {
        let mut loose = Self::default();
        if options.unresolved_weight > 0.0 {
            loose.missing_residues = molecules.map(Molecule::unresolved_residues);
        }
        if options.termini_weight > 0.0 {
            loose.chain_end_residues = molecules.map(Molecule::termini);
        }
        loose
    }

    /// Whether a pose can meet where residues are missing.
    pub(super) fn any_missing(&self) -> bool {
        self.missing_residues
            .iter()
            .any(|side| !side.segments.is_empty())
    }

    /// Whether a pose can meet residues near ends of chains.
    pub(super) fn any_ends(&self) -> bool {
        self.chain_end_residues
            .iter()
            .any(|side| !side.atoms.is_empty())
    }
}
