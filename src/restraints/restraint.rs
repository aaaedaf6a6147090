//! One restraint, and how much of them is kept.

use knotdock_scoring::terms::pose::DistanceRestraint;
use serde::{Deserialize, Serialize};

use crate::restraints::error::RestraintFault;

/// The restraints of a file between two molecules.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileRestraints {
    /// Those between the two.
    pub list: Vec<NamedRestraint>,
    /// How many more are, or may be, within one of them, and are left out: rigid docking keeps their distances.
    pub within_one_molecule: usize,
}

/// How upper bounds of a `.tbl` are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TblBounds {
    /// Widened for the hydrogens that HADDOCK counts and that are not read.
    #[default]
    Widened,
    /// As written.
    Written,
}

/// A restraint on the effective distance between atoms of the receptor and atoms of the ligand.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedRestraint {
    /// Name for reports: the group or the two residues of a row, or the number of the statement.
    pub name: String,
    /// 1-based line on which it begins.
    pub line: usize,
    /// Alternatives, each as indices of atoms of receptor and ligand, rising. Every atom of the one set pairs with
    /// every atom of the other. A pair of atoms that is in two alternatives counts twice.
    pub pairs: Vec<[Vec<usize>; 2]>,
    /// Smallest effective distance that satisfies it, in Å.
    pub lower: f64,
    /// Most likely distance, in Å, where the file gives one.
    pub target: Option<f64>,
    /// Largest effective distance that satisfies it, in Å.
    pub upper: f64,
    /// Largest effective distance as the file gives it, in Å: of all atoms in a `.tbl`.
    pub written_upper: f64,
}

impl NamedRestraint {
    /// What scores: atoms and bounds.
    pub fn distance(&self) -> DistanceRestraint {
        DistanceRestraint {
            pairs: self.pairs.clone(),
            lower: self.lower,
            upper: self.upper,
        }
    }
}

/// Most atoms that the selections of a file may hold together: 80 MB, and three times as much while a table is read.
/// Each statement may name whole molecules, so that a small file could fill the memory.
const MAX_SELECTED: usize = 10_000_000;

/// Counts the atoms of all restraints, up to [`MAX_SELECTED`].
#[derive(Default)]
pub(super) struct SelectedAtoms(usize);

impl SelectedAtoms {
    /// Counts the atoms of an alternative.
    pub(super) fn add(&mut self, pair: &[Vec<usize>; 2]) -> Result<(), RestraintFault> {
        self.0 += pair[0].len() + pair[1].len();
        if self.0 > MAX_SELECTED {
            return Err(RestraintFault::TooManyAtoms(MAX_SELECTED));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Statements on whole molecules: 30 bytes of the file to thousands of indices.
    #[test]
    fn a_small_file_cannot_fill_the_memory() {
        let mut atoms = SelectedAtoms::default();
        let pair = [vec![0; MAX_SELECTED / 4], vec![0; MAX_SELECTED / 4]];
        assert_eq!(atoms.add(&pair), Ok(()));
        assert_eq!(atoms.add(&pair), Ok(()));
        assert_eq!(
            atoms.add(&[vec![0], Vec::new()]),
            Err(RestraintFault::TooManyAtoms(MAX_SELECTED))
        );
    }
}
