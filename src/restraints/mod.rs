//! Distance restraints: what experiments say of distances between receptor and ligand, read from a file.
//!
//! # Conventions
//!
//! - Distances are in Å. Atoms are indices into the atoms of the receptor and of the ligand, in that order.
//! - A restraint is on the effective distance (sum of d^-6)^(-1/6) over all its pairs of atoms. It is satisfied where
//!   lower <= effective distance <= upper.
//! - A residue stands for its heavy atoms. Hydrogens count where nothing else is named, as in `name HN`. Bounds of a
//!   `.tbl` are of all atoms, and are widened for that.
//!
//! # Files
//!
//! - `.tbl`: assign statements of CNS, X-PLOR and HADDOCK ([`tbl`]).
//! - Any other ending: a CSV table, a row a pair of residues or atoms ([`table`]). A preset of a cross-linking reagent
//!   ([`Crosslink`]) gives its rows their upper bound.

mod bounds;
pub mod crosslink;
pub mod error;
mod needed;
mod restraint;
mod side_atoms;
pub mod table;
pub mod tbl;

#[cfg(test)]
mod fuzz_tests;

pub use self::crosslink::{CROSSLINKS, Crosslink, UnknownCrosslink};
pub use self::error::{RestraintFault, RestraintFileError};
pub use self::needed::{Needed, NeededError};
pub use self::restraint::{FileRestraints, NamedRestraint, TblBounds};

use std::path::{Path, PathBuf};

use knotdock_structures::molecule::Molecule;
use serde::{Deserialize, Serialize};

use self::error::Located;
use crate::bounded_read::{MAX_RESTRAINTS, read_bounded};

/// A file of restraints as it was read. Which atoms it names depends on the molecules.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RestraintFile {
    /// Its name.
    pub path: PathBuf,
    /// What it holds.
    pub text: String,
}

impl RestraintFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`RestraintFileError`] where it cannot be read, is too large or no text.
    pub fn read(path: &Path) -> Result<Self, RestraintFileError> {
        let unreadable = |error: String| Located::in_file(RestraintFault::Unreadable(error));
        let text = read_bounded(path, MAX_RESTRAINTS)
            .map_err(|error| unreadable(error.to_string()))
            .and_then(|bytes| {
                String::from_utf8(bytes)
                    .map_err(|_| unreadable("it is no text in UTF-8".to_owned()))
            });
        Ok(Self {
            path: path.to_owned(),
            text: text.map_err(|located| located.of(path))?,
        })
    }

    /// The restraints between the molecules receptor and ligand.
    ///
    /// # Errors
    /// [`RestraintFileError`], also where a file of `.tbl` is given with a preset: its statements have their distances.
    pub fn between(
        &self,
        molecules: [&Molecule; 2],
        crosslink: Option<Crosslink>,
        bounds: TblBounds,
    ) -> Result<FileRestraints, RestraintFileError> {
        let bytes = self.text.clone().into_bytes();
        parse(bytes, is_tbl(&self.path), molecules, crosslink, bounds)
            .map_err(|located| located.of(&self.path))
    }
}

/// Whether the name of a file says that it holds assign statements.
fn is_tbl(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("tbl"))
}

/// The restraints of a file's bytes.
fn parse(
    bytes: Vec<u8>,
    is_tbl: bool,
    molecules: [&Molecule; 2],
    crosslink: Option<Crosslink>,
    bounds: TblBounds,
) -> Result<FileRestraints, Located> {
    let bytes = with_line_feeds(bytes);
    let restraints = match (is_tbl, crosslink) {
        (true, Some(crosslink)) => Err(Located::in_file(RestraintFault::CrosslinkOfTbl(
            crosslink.name,
        ))),
        (true, None) => tbl::parse(bytes, molecules, bounds),
        (false, _) => table::parse(bytes, molecules, crosslink).map(|list| FileRestraints {
            list,
            within_one_molecule: 0,
        }),
    }?;
    if restraints.list.is_empty() {
        return Err(Located::in_file(RestraintFault::NoRestraint));
    }
    Ok(restraints)
}

/// The text with LF at the end of every line, so that both readers count lines alike.
fn with_line_feeds(bytes: Vec<u8>) -> Vec<u8> {
    if !bytes.contains(&b'\r') {
        return bytes;
    }
    let mut text = Vec::with_capacity(bytes.len());
    let mut bytes = bytes.into_iter().peekable();
    while let Some(byte) = bytes.next() {
        if byte == b'\r' {
            bytes.next_if_eq(&b'\n');
            text.push(b'\n');
        } else {
            text.push(byte);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_molecules::molecules;

    fn written(name: &str, bytes: &[u8]) -> Result<Vec<NamedRestraint>, RestraintFileError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let [receptor, ligand] = molecules();
        let read = RestraintFile::read(&path)
            .and_then(|file| file.between([&receptor, &ligand], None, TblBounds::Written))
            .map(|restraints| restraints.list);
        if let Err(error) = &read {
            assert_eq!(error.path, path);
            assert!(!error.remedy().is_empty());
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
                    assert_eq!(error.line, Some(4), "{text:?}");
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_read_is_refused() {
        for name in ["a.csv", "a.tbl"] {
            let fault = |bytes: &[u8]| written(name, bytes).unwrap_err().fault;
            assert!(matches!(*fault(b"\xff\xfe"), RestraintFault::Unreadable(_)));
            let large = vec![b'\n'; MAX_RESTRAINTS as usize + 1];
            assert!(fault(&large).to_string().contains("more than 16 MiB"));
        }
        assert_eq!(
            *written("a.tbl", b"! nothing\n").unwrap_err().fault,
            RestraintFault::NoRestraint
        );
        assert_eq!(
            *written("a.csv", b"receptor,ligand,upper\n")
                .unwrap_err()
                .fault,
            RestraintFault::NoRestraint
        );
        let error = RestraintFile::read(Path::new("nowhere.csv")).unwrap_err();
        assert_eq!(
            (error.line, error.path.as_path()),
            (None, Path::new("nowhere.csv"))
        );
    }

    #[test]
    fn a_preset_is_for_tables() {
        let [receptor, ligand] = molecules();
        let text = b"assign (segid A) (segid B) 4 4 4".to_vec();
        let dss = Some(CROSSLINKS[0]);
        let error = parse(text, true, [&receptor, &ligand], dss, TblBounds::Written).unwrap_err();
        assert_eq!(error.fault, RestraintFault::CrosslinkOfTbl("DSS"));
    }
}
