//! Options on reading molecules.

use std::collections::BTreeSet;

use knotdock_structures::molecule::{
    AlternateLocation, Hetatm, Hydrogens, ModelChoice, ReadOptions, Waters,
};

use super::definition::{Name, Names, Optional, Parsed, options};
use super::values::Range;

options! {
    /// What is read of the molecules that are docked. A known complex is read by the defaults.
    InputOptions as input, "Input", Molecules {
        /// Waters: drop or keep.
        waters: Waters = Waters::default(), "drop|keep", Parsed;
        /// Other HETATM records: no-additives, keep or drop.
        ///
        /// no-additives drops known buffer and cryo additives. keep keeps all. drop leaves only modified amino acids.
        hetatm: Hetatm = Hetatm::default(), "no-additives|keep|drop", Parsed;
        /// Leave out the residues of these names, such as an inhibitor in the binding site.
        ///
        /// ATOM and HETATM records alike. Several names have commas between, or the option is given again.
        drop_residue: Vec<String> = Vec::new(), "NAMES", Names(Name("the name of a residue is needed, such as HEM"));
        /// Hydrogens: drop or keep.
        ///
        /// drop: united-atom radii stand for them. keep: a molecule that has some gets all-atom radii.
        hydrogens: Hydrogens = Hydrogens::default(), "drop|keep", Parsed;
        /// Alternate location of each residue: occupancy, or a name such as A.
        ///
        /// occupancy takes the best occupied one. A name is taken where the residue has it.
        altloc: AlternateLocation = AlternateLocation::default(), "occupancy|NAME", Parsed;
        /// Model of a file that has several: 1 is the first, whatever number it carries.
        ///
        /// all reads all models as one molecule, as of a biological assembly (.pdb1). Chain A of its second model is then
        /// called A-2.
        model: ModelChoice = ModelChoice::default(), "NUMBER|all", Parsed;
        /// Build this biological assembly of a file that has it, such as 1.
        ///
        /// Copies of chain A are called and so on, and FILE:A,A-2 picks them.
        assembly: Option<String> = None, "ID", Optional(Name("the name of an assembly is needed, such as 1"));
        /// Leave out residues of a predicted model with a pLDDT below this, 0 to 100.
        ///
        /// 50 leaves out what is likely disordered. If neither file is known as a prediction, B values that can be pLDDT
        /// are taken for it.
        min_plddt: Option<f64> = None, "PLDDT", Optional(Range::above(0.0, 100.0));
    }
}

impl InputOptions {
    /// The options as the reader takes them.
    pub fn reading(&self) -> ReadOptions {
        // Sorted: the order has no effect on a run.
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
