//! Distance restraints between receptor and ligand, from experiments, read from a file.
//!
//! # Conventions
//!
//! - Distances are in Å. Atoms are indices into the atoms of the receptor and of the ligand, in that order.
//! - A restraint is on the effective distance (sum of d^-6)^(-1/6) over all its pairs of atoms. It is satisfied if
//!   lower <= effective distance <= upper.
//! - A residue means its heavy atoms. Hydrogens count if nothing else is named, as in `name HN`. Bounds of a `.tbl` are of
//!   all atoms, and are widened for that.
//!
//! # Files
//!
//! - `.tbl`: assign statements of CNS, X-PLOR and HADDOCK ([`tbl`]).
//! - Any other ending: a CSV table, one row per pair of residues or atoms ([`table`]). A preset of a cross-linking reagent
//!   ([`Crosslink`]) gives its rows their upper bound.

pub mod crosslink;
mod required_count;
mod restraint;
mod side_atoms;
pub mod table;
pub mod tbl;

#[cfg(test)]
mod fuzz_tests;

pub use self::crosslink::{CROSSLINKS, Crosslink};
pub use self::required_count::RequiredCount;
pub use self::restraint::{FileRestraints, NamedRestraint, TblBounds};

use std::path::{Path, PathBuf};

use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;
use serde::{Deserialize, Serialize};

use crate::bounded_read::{MAX_RESTRAINTS, read_bounded_text};

/// A file of restraints as it was read. Its atoms depend on the molecules.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RestraintFile {
    /// Its name.
    pub path: PathBuf,
    /// Its content.
    pub text: String,
}

impl RestraintFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Error`] if it cannot be read, is too large or no text.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = read_bounded_text(path, MAX_RESTRAINTS).map_err(|error| {
            Error::input(format!("the restraints cannot be read: {error}"))
                .at(path)
                .help("give a text in UTF-8: a CSV table, or a .tbl file with assign statements")
        })?;
        Ok(Self {
            path: path.to_owned(),
            text,
        })
    }

    /// The restraints between the molecules receptor and ligand.
    ///
    /// # Errors
    /// [`Error`], also if a file of `.tbl` is given with a preset: its statements have their own distances.
    pub fn between(
        &self,
        molecules: [&Molecule; 2],
        crosslink: Option<Crosslink>,
        bounds: TblBounds,
    ) -> Result<FileRestraints, Error> {
        let ending = self.path.extension();
        let is_tbl = ending.is_some_and(|ending| ending.eq_ignore_ascii_case("tbl"));
        let restraints = parse(&self.text, is_tbl, molecules, crosslink, bounds);
        restraints.map_err(|error| error.at(&self.path))
    }
}

/// The restraints of a file's text.
fn parse(
    text: &str,
    is_tbl: bool,
    molecules: [&Molecule; 2],
    crosslink: Option<Crosslink>,
    bounds: TblBounds,
) -> Result<FileRestraints, Error> {
    // LF at the end of every line, so that both readers count lines alike.
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    let restraints = match (is_tbl, crosslink) {
        (true, Some(Crosslink { name, .. })) => Err(Error::input(format!(
            "--crosslink {name} does nothing in a .tbl file, whose statements have their own distances"
        ))
        .help("leave out --crosslink, or give the cross-links as a CSV table")),
        (true, None) => tbl::parse(&text, molecules, bounds),
        (false, _) => {
            let list = table::parse(text.into_bytes(), molecules, crosslink);
            list.map(|list| FileRestraints {
                list,
                within_one_molecule: 0,
            })
        }
    }?;
    if restraints.list.is_empty() {
        return Err(Error::input("there is no restraint in the file").help(
            "add rows below `receptor,ligand,upper`, or to a .tbl file statements such as \
             `assign (resid 10 and segid A) (resid 20 and segid B) 2.0 2.0 0.0`",
        ));
    }
    Ok(restraints)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_molecules::molecules;

    fn written(name: &str, bytes: &[u8]) -> Result<Vec<NamedRestraint>, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let [receptor, ligand] = molecules();
        let read = RestraintFile::read(&path)
            .and_then(|file| file.between([&receptor, &ligand], None, TblBounds::Written))
            .map(|restraints| restraints.list);
        if let Err(error) = &read {
            assert_eq!(error.file(), Some(path.as_path()));
            assert!(error.remedy().is_some());
        }
        read
    }

    #[test]
    fn the_ending_decides_the_format() {
        let table = "receptor,ligand,upper\nA:10.CA,B:20.CA,8\n";
        let statement =
            "assign (resid 10 and name CA and segid A) (resid 20 and name CA and segid B) 4 4 4\n";
        for name in ["a.csv", "a.txt", "a"] {
            assert_eq!(written(name, table.as_bytes()).unwrap()[0].upper, 8.0);
            assert!(written(name, statement.as_bytes()).is_err());
        }
        for name in ["a.tbl", "A.TBL"] {
            let read = written(name, statement.as_bytes()).unwrap();
            let of_table = written("a.csv", table.as_bytes()).unwrap();
            assert_eq!(read[0].pairs, of_table[0].pairs);
            assert!(written(name, table.as_bytes()).is_err());
        }
    }

    #[test]
    fn line_ends_and_byte_order_marks_change_nothing() {
        let table = "receptor,ligand,upper\n\nA:10,B:20,8\nA:10,B:99,8\n";
        let statements =
            "! remark\nassign (segid A)\n(segid B) 4 4 4\nassign (segid A) (segid C) 4 4 4\n";
        for (name, text) in [("a.csv", table), ("a.tbl", statements)] {
            for end in ["\n", "\r\n", "\r"] {
                for mark in ["", "\u{feff}"] {
                    let text = format!("{mark}{}", text.replace('\n', end));
                    let error = written(name, text.as_bytes()).unwrap_err();
                    assert_eq!(error.line(), Some(4), "{text:?}");
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_read_is_refused() {
        for name in ["a.csv", "a.tbl"] {
            let error = |bytes: &[u8]| written(name, bytes).unwrap_err();
            assert!(error(b"\xff\xfe").message().contains("cannot be read"));
            let large = vec![b'\n'; MAX_RESTRAINTS as usize + 1];
            assert!(error(&large).message().contains("more than 16 MiB"));
        }
        for (name, text) in [
            ("a.tbl", "! nothing\n"),
            ("a.csv", "receptor,ligand,upper\n"),
        ] {
            let error = written(name, text.as_bytes()).unwrap_err();
            assert!(error.message().contains("no restraint"), "{error}");
        }
        let error = RestraintFile::read(Path::new("nowhere.csv")).unwrap_err();
        assert_eq!(
            (error.line(), error.file()),
            (None, Some(Path::new("nowhere.csv")))
        );
    }

    #[test]
    fn a_preset_is_for_tables() {
        let [receptor, ligand] = molecules();
        let text = "assign (segid A) (segid B) 4 4 4";
        let dss = Some(CROSSLINKS[0]);
        let error = parse(text, true, [&receptor, &ligand], dss, TblBounds::Written).unwrap_err();
        assert!(error.message().starts_with("--crosslink DSS"), "{error}");
    }
}
