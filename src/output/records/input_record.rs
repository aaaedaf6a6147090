//! Input files as a run records them: their paths and checksums.

use knotdock_structures::Error;
use std::path::{Path, PathBuf};

use knotdock_structures::molecule::{Format, InputSpec, Molecule, file_bytes, write_molecule};
use serde::{Deserialize, Serialize};

use crate::output::files::checksum::{sha256, sha256_of_file};
use crate::output::files::whole_file::is_stream;
use crate::plain_path::plain_path;

/// An input file as recorded.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputRecord {
    /// Absolute path.
    pub path: PathBuf,
    /// Names of the chains that were picked; `null` for all.
    pub chains: Option<Vec<String>>,
    /// The model that was picked, by its place in the file; absent if the options of reading chose it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<usize>,
    /// SHA-256 of the file on the disk, in hexadecimal.
    pub sha256: String,
}

impl InputRecord {
    /// Records a file that holds these bytes.
    pub fn new(input: &InputSpec, bytes: &[u8]) -> Self {
        let path = std::path::absolute(&input.path).unwrap_or_else(|_| input.path.clone());
        let path = plain_path(&path);
        Self {
            // JSON holds no bytes that are not Unicode: such a path is recorded for people, not to be found again.
            path: PathBuf::from(path.to_string_lossy().into_owned()),
            chains: input.chains.clone(),
            model: input.model,
            sha256: sha256(bytes),
        }
    }

    /// The record of a molecule: of its file, or of one made in memory with the checksum of its atoms in mmCIF.
    pub fn of_molecule(molecule: &Molecule) -> Result<Self, Error> {
        if let Some(spec) = &molecule.report.source {
            return Ok(Self::new(spec, &file_bytes(&spec.path)?));
        }
        let mut bytes = Vec::new();
        write_molecule(&mut bytes, Format::Mmcif, molecule, &[]).map_err(Error::machine)?;
        Ok(Self {
            path: PathBuf::new(),
            chains: None,
            model: None,
            sha256: sha256(&bytes),
        })
    }

    /// Whether the other has the same content, and the same chains and model are read of it.
    pub fn is_like(&self, other: &Self) -> bool {
        (&self.sha256, &self.chains, self.model) == (&other.sha256, &other.chains, other.model)
    }

    /// The input to read.
    pub fn spec(&self) -> InputSpec {
        InputSpec {
            path: self.path.clone(),
            chains: self.chains.clone(),
            model: self.model,
        }
    }

    /// The record with the path at which the file is found: the recorded one, or under its name in one of `folders`, for
    /// runs that were moved or copied together with their inputs.
    ///
    /// # Errors
    /// [`Error`] of the recorded path if no file with the recorded checksum is there or in the folders.
    pub fn locate(&self, folders: &[PathBuf]) -> Result<Self, Error> {
        let Err(error) = self.verify(&self.path) else {
            return Ok(self.clone());
        };
        let name = self.path.file_name().unwrap_or_default();
        let mut others = folders.iter().map(|folder| folder.join(name));
        let path = others.find(|path| self.verify(path).is_ok()).ok_or(error)?;
        Ok(Self {
            path,
            ..self.clone()
        })
    }

    /// Checks that a file is the one recorded.
    fn verify(&self, path: &Path) -> Result<(), Error> {
        let refused = |message: String, remedy: &str| {
            Err(Error::input(format!("{} {message}", path.display()))
                .at(path)
                .help(remedy))
        };
        if is_stream(path) && !path.is_dir() {
            // Opened, a pipe would wait for whoever writes to it.
            return refused(
                "is no file, but a pipe, a device or a handle of the process, which cannot be read again".to_owned(),
                "dock again from a file, or put what was read under that name beside the directory of the run",
            );
        }
        let sum = sha256_of_file(path).map_err(|error| {
            Error::input(format!("cannot read {}: {error}", path.display()))
                .at(path)
                .help("put the file where the run found it, or beside the directory of the run")
        })?;
        if sum != self.sha256 {
            return refused(
                format!(
                    "has changed since the run: its SHA-256 is {sum}, the run's was {}",
                    self.sha256
                ),
                "put back the file that the run was made from, or dock again",
            );
        }
        Ok(())
    }
}

/// The native complex that the poses were measured against.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NativeRecord {
    /// One file with both partners.
    Complex(InputRecord),
    /// A file for each partner.
    Partners {
        /// File and chains of the receptor.
        receptor: InputRecord,
        /// File and chains of the ligand.
        ligand: InputRecord,
    },
}

impl NativeRecord {
    /// Its files: one, or the receptor's and the ligand's.
    pub fn files(&self) -> Vec<&InputRecord> {
        match self {
            Self::Complex(complex) => vec![complex],
            Self::Partners { receptor, ligand } => vec![receptor, ligand],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_changed_input_is_noticed() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("input.pdb");
        fs::write(&path, "abc").unwrap();
        let record = InputRecord::new(&InputSpec::whole(&path), b"abc");
        // FIPS 180-2, appendix B.1
        assert_eq!(
            record.sha256,
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
        assert_eq!(record.locate(&[]).unwrap(), record);
        let moved = root.path().join("moved");
        fs::create_dir(&moved).unwrap();
        fs::rename(&path, moved.join("input.pdb")).unwrap();
        let error = record.locate(&[root.path().to_owned()]).unwrap_err();
        assert!(error.message().starts_with("cannot read"), "{error}");
        assert_eq!(
            record
                .locate(&[root.path().to_owned(), moved.clone()])
                .unwrap()
                .path,
            moved.join("input.pdb")
        );
        fs::write(&path, "abd").unwrap();
        let error = record.locate(&[root.path().to_owned()]).unwrap_err();
        assert!(error.message().contains("has changed"), "{error}");
        assert_eq!(error.file(), Some(path.as_path()));
    }
}
