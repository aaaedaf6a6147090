//! Cysteines and histidines that bind a metal, whose charge follows from it at any pH.
//!
//! A cysteine that binds zinc, iron, copper or their like is a thiolate: Dudev & Lim, J. Am. Chem. Soc. 124 (2002) 6759-6766. A histidine binds by the
//! nitrogen that has no proton, and so is neutral with its proton on the other; between two metals it has none. Where a residue's name says its state
//! (`CYM`, `HID`, `HIP`, ...), the name decides.

use super::groups::{NON_METALS, Residue};
use super::{Molecule, squared_distance};

/// Longest distance in Å of a metal from the sulphur or nitrogen that binds it.
const BOUND: f64 = 2.8;

/// Metals that sulphur and nitrogen seldom bind: theirs are oxygens, and what lies nearer is as likely a water.
const HARD: [&str; 11] = [
    "Li", "Na", "K", "Rb", "Cs", "Be", "Mg", "Ca", "Sr", "Ba", "Al",
];

impl Molecule {
    /// Places of the metals that thiolates and imidazoles bind (Å), ions and those of cofactors.
    pub(super) fn metals(&self, groups: &[Residue<'_>]) -> Vec<[f64; 3]> {
        let others = groups.iter().filter(|group| !group.is_peptide());
        let atoms = others.flat_map(|group| group.atoms.iter().filter_map(|&i| self.atoms.get(i)));
        atoms
            .filter(|atom| {
                let element = atom.element.as_str();
                !(element.is_empty() || NON_METALS.contains(&element) || HARD.contains(&element))
            })
            .map(|atom| atom.position)
            .collect()
    }

    /// The state of a residue that binds one of these metals, as the table of charges names it.
    pub(super) fn metal_bound(
        &self,
        residue: &Residue<'_>,
        metals: &[[f64; 3]],
    ) -> Option<&'static str> {
        let binds = |name: &str| {
            self.atom(residue, name).is_some_and(|atom| {
                let near =
                    |metal: &[f64; 3]| squared_distance(*metal, atom.position) <= BOUND * BOUND;
                metals.iter().any(near)
            })
        };
        match residue.known_as {
            "CYS" => binds("SG").then_some("CYM"),
            "HIS" => match (binds("ND1"), binds("NE2")) {
                (true, true) => Some("HIS-"),
                (true, false) => Some("HIE"),
                (false, true) => Some("HID"),
                (false, false) => None,
            },
            _ => None,
        }
    }
}
