//! Restraints as read, their bounds, and a limit on their atoms.

use knotdock_scoring::terms::pose::DistanceRestraint;
use knotdock_structures::Error;
use serde::{Deserialize, Serialize};

use crate::table_text::named_columns::shortened;

/// The restraints of a file between two molecules.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileRestraints {
    /// Those between the two.
    pub list: Vec<NamedRestraint>,
    /// Number of restraints that are, or may be, within one of them. They are left out: rigid docking keeps their distances.
    pub within_one_molecule: usize,
}

/// Use of the upper bounds of a `.tbl`.
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
    pub line: u64,
    /// Alternatives, each as indices of atoms of receptor and ligand, rising. Every atom of the one set pairs with
    /// every atom of the other. A pair of atoms that is in two alternatives counts twice.
    pub pairs: Vec<[Vec<usize>; 2]>,
    /// Smallest effective distance that satisfies it, in Å.
    pub lower: f64,
    /// Most likely distance, in Å, if the file gives one.
    pub target: Option<f64>,
    /// Largest effective distance that satisfies it, in Å.
    pub upper: f64,
    /// Largest effective distance as the file gives it, in Å: of all atoms in a `.tbl`.
    pub written_upper: f64,
}

impl NamedRestraint {
    /// Its atoms and bounds, which score.
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
    pub(super) fn add(&mut self, pair: &[Vec<usize>; 2]) -> Result<(), Error> {
        self.0 += pair[0].len() + pair[1].len();
        if self.0 > MAX_SELECTED {
            let message = format!("the restraints hold more than {MAX_SELECTED} atoms in all");
            return Err(
                Error::input(message).help("select residues or atoms in place of whole chains")
            );
        }
        Ok(())
    }
}

/// Largest distance in a file, in Å: far beyond any molecule, and its sixth power is finite.
const MAX_DISTANCE: f64 = 1e10;

/// Bounds of an effective distance, in Å: 0 <= lower <= target <= upper, and upper is above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) lower: f64,
    pub(super) target: Option<f64>,
    pub(super) upper: f64,
}

impl Bounds {
    /// Bounds as a table gives them.
    pub(super) fn new(lower: f64, target: Option<f64>, upper: f64) -> Result<Self, Error> {
        let wrong = |message: String| {
            Err(Error::input(message).help(
                "correct the numbers, so that 0 <= lower <= target <= upper and upper is above 0",
            ))
        };
        if lower > upper {
            return wrong(format!("lower is {lower}, above upper, which is {upper}"));
        }
        if upper == 0.0 {
            return wrong("the upper bound is 0, and atoms cannot be in one place".to_owned());
        }
        match target {
            Some(target) if !(lower..=upper).contains(&target) => wrong(format!(
                "target is {target}, outside the bounds {lower} and {upper}"
            )),
            target => Ok(Self {
                lower,
                target,
                upper,
            }),
        }
    }

    /// Bounds of an assign statement: `minus` below the distance, but not below 0, to `plus` above it.
    pub(super) fn about(distance: f64, minus: f64, plus: f64) -> Result<Self, Error> {
        Self::new((distance - minus).max(0.0), Some(distance), distance + plus)
    }
}

/// A distance as written, in Å.
pub(super) fn distance(name: &str, text: &str) -> Result<f64, Error> {
    match text.parse() {
        // + 0.0 turns a negative zero into 0.
        Ok(number) if (0.0..=MAX_DISTANCE).contains(&number) => Ok(number + 0.0),
        _ => Err(Error::input(format!(
            "{name} is `{}`; it must be a number of Å from 0 to {MAX_DISTANCE}",
            shortened(text)
        ))
        .help("write the number with a decimal point, as in 8.5")),
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
        let error = atoms.add(&[vec![0], Vec::new()]).unwrap_err();
        assert!(
            error.message().contains(&MAX_SELECTED.to_string()),
            "{error}"
        );
    }

    #[test]
    fn a_statement_gives_a_distance_and_its_tolerances() {
        let bounds = |lower, target, upper| {
            Ok(Bounds {
                lower,
                target: Some(target),
                upper,
            })
        };
        assert_eq!(Bounds::about(2.0, 2.0, 0.0), bounds(0.0, 2.0, 2.0));
        assert_eq!(Bounds::about(5.0, 1.0, 2.5), bounds(4.0, 5.0, 7.5));
        // No distance is below 0, so this bound excludes nothing.
        assert_eq!(Bounds::about(2.0, 3.0, 0.0), bounds(0.0, 2.0, 2.0));
    }

    #[test]
    fn bounds_that_nothing_satisfies_are_refused() {
        for (lower, target, upper) in [
            (3.0, None, 2.0),
            (0.0, None, 0.0),
            (1.0, Some(0.5), 2.0),
            (1.0, Some(2.5), 2.0),
        ] {
            let bounds = Bounds::new(lower, target, upper);
            assert!(bounds.unwrap_err().remedy().is_some());
        }
        assert!(Bounds::new(2.0, Some(2.0), 2.0).is_ok());
    }

    #[test]
    fn only_numbers_are_distances() {
        for text in [
            "nan", "inf", "-inf", "-1", "1e11", "1e999", "", "8 Å", "8,5", "0x10",
        ] {
            let error = distance("upper", text).unwrap_err();
            assert!(error.message().starts_with("upper is `"), "{error}");
        }
        assert_eq!(distance("upper", "+8.5e0"), Ok(8.5));
        assert!(distance("upper", "-0").unwrap().is_sign_positive());
    }
}
