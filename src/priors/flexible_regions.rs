//! Flexible regions of two molecules: unresolved segments and residues near termini.

use crate::options::DockOptions;
use knotdock_structures::molecule::{Molecule, Termini, UnresolvedResidues};
use serde::Serialize;

/// Flexible regions of receptor and ligand. Those that no pose term reads are left empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FlexibleRegions {
    /// Residues that the files do not resolve.
    #[serde(rename = "unresolved_residues")]
    pub unresolved: [UnresolvedResidues; 2],
    /// Residues near termini and gaps.
    #[serde(rename = "terminus_residues")]
    pub termini: [Termini; 2],
}

impl FlexibleRegions {
    /// The regions of two molecules. A region is left empty if its pose term has no weight.
    pub(crate) fn of(molecules: [&Molecule; 2], options: &DockOptions) -> Self {
        let mut regions = Self::default();
        if options.terms.unresolved_weight > 0.0 {
            regions.unresolved = molecules.map(Molecule::unresolved_residues);
        }
        if options.terms.termini_weight > 0.0 {
            regions.termini = molecules.map(Molecule::termini);
        }
        regions
    }
}
