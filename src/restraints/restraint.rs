//! One restraint, and how much of them is kept.

use knotdock_scoring::terms::pose::DistanceRestraint;

use crate::restraints::error::RestraintFault;

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
