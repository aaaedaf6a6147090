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
    #[arg(long, value_name = "drop|keep", default_value_t = Waters::default())]
    pub waters: Waters,
    /// Other HETATM records: no-additives, keep or drop.
    ///
    /// no-additives drops known buffer and cryo additives. keep keeps all. drop leaves only modified amino acids.
    #[arg(long, value_name = "no-additives|keep|drop", default_value_t = Hetatm::default())]
    pub hetatm: Hetatm,
    /// Leave out the residues of these names, such as an inhibitor in the binding site.
    ///
    /// ATOM and HETATM records alike. Several names have commas between, or the option is given again.
    #[arg(long, value_name = "NAMES", value_parser = residue_name, value_delimiter = ',')]
    pub drop_residue: Vec<String>,
    /// Hydrogens: drop or keep.
    ///
    /// drop: united-atom radii stand for them. keep: a molecule that has some gets all-atom radii.
    #[arg(long, value_name = "drop|keep", default_value_t = Hydrogens::default())]
    pub hydrogens: Hydrogens,
    /// Alternate location of each residue: occupancy, or a name such as A.
    ///
    /// occupancy takes the best occupied one. A name is taken where the residue has it.
    #[arg(long, value_name = "occupancy|NAME", default_value_t = AlternateLocation::default())]
    pub altloc: AlternateLocation,
    /// Model of a file that has several: 1 is the first, whatever number it carries.
    ///
    /// all reads all models as one molecule, as of a biological assembly (.pdb1). Chain A of its second model is then
    /// called A-2.
    #[arg(long, value_name = "NUMBER|all", default_value_t = ModelChoice::default())]
    pub model: ModelChoice,
    /// Build this biological assembly of a file that has it, such as 1.
    ///
    /// Copies of chain A are called and so on, and FILE:A,A-2 picks them.
    #[arg(long, value_name = "ID", value_parser = assembly_name)]
    pub assembly: Option<String>,
    /// Leave out residues of a predicted model with a pLDDT below this, 0 to 100.
    ///
    /// 50 leaves out what is likely disordered. If neither file is known as a prediction, B values that can be pLDDT
    /// are taken for it.
    #[arg(long, value_name = "PLDDT", value_parser = plddt)]
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
