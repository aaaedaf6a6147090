//! Options on reading molecules.

use std::collections::BTreeSet;

use clap::Args;
use knotdock_structures::molecule::{
    AlternateLocation, Hetatm, Hydrogens, ModelChoice, ReadOptions, Waters,
};
use serde::{Deserialize, Serialize};

use super::values::{assembly_name, plddt, residue_name};

/// What is read of the molecules that are docked. A known complex is read by the defaults.
#[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[command(next_help_heading = "Input (molecules)")]
#[serde(deny_unknown_fields)]
pub struct InputOptions {
    /// Waters: drop or keep.
    #[arg(long, value_name = "WHAT", default_value_t = Waters::default())]
    pub waters: Waters,
    /// HETATM records but waters: no-additives drops known buffer and cryo additives, keep keeps all, drop leaves only
    /// modified amino acids.
    #[arg(long, value_name = "WHAT", default_value_t = Hetatm::default())]
    pub hetatm: Hetatm,
    /// Leave out the residues of these names, such as an inhibitor in the binding site, whatever their record; with
    /// commas between, or given again.
    #[arg(long, value_name = "NAME", value_parser = residue_name, value_delimiter = ',')]
    pub drop_residue: Vec<String>,
    /// Hydrogens: drop (united-atom radii stand for them) or keep (all-atom radii for a molecule that has some).
    #[arg(long, value_name = "WHAT", default_value_t = Hydrogens::default())]
    pub hydrogens: Hydrogens,
    /// Alternate location of a residue: occupancy, the best occupied, or the name of one, such as A, where it is
    /// offered.
    #[arg(long, value_name = "NAME", default_value_t = AlternateLocation::default())]
    pub altloc: AlternateLocation,
    /// Model of a file that has several: 1 is the first, whatever number it carries. all reads all models as one
    /// molecule, as of a biological assembly (.pdb1). Chain A of its second model is then called A-2.
    #[arg(long, value_name = "N", default_value_t = ModelChoice::default())]
    pub model: ModelChoice,
    /// Build this biological assembly of a file that has it, such as 1; copies of chain A are called ...,
    /// which is how FILE:A,A-2 picks them.
    #[arg(long, value_name = "ID", value_parser = assembly_name)]
    pub assembly: Option<String>,
    /// Of a predicted model leave out residues with a pLDDT below this, 0 to 100: 50 leaves out what is likely
    /// disordered. Where no file is known as a prediction, B values that can be pLDDT are taken for it.
    #[arg(long, value_name = "X", value_parser = plddt)]
    pub min_plddt: Option<f64>,
}

impl InputOptions {
    /// The options as the reader takes them.
    pub fn reading(&self) -> ReadOptions {
        // In one order, so that runs that leave out the same residues are the same run.
        let names: BTreeSet<String> = self.drop_residue.iter().cloned().collect();
        ReadOptions {
            waters: self.waters,
            hetatm: self.hetatm,
            hydrogens: self.hydrogens,
            altloc: self.altloc,
            model: self.model,
            assembly: self.assembly.clone(),
            min_plddt: self.min_plddt,
            drop_residue: names.into_iter().collect(),
            ..ReadOptions::default()
        }
    }
}
