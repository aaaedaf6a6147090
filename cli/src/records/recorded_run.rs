//! The part of a `run.json` that later commands read.

use knotdock_structures::Error;
use std::path::Path;

use serde::Deserialize;

use crate::records::ensemble_record::{RECORD, is_ensemble};
use knotdock::bounded_read::{MAX_RECORD, read_bounded_file};
use knotdock::options::{DockOptions, MachineOptions};
use knotdock::output::files::file_error;
use knotdock::output::records::input_record::{InputRecord, NativeRecord};
use knotdock::output::records::manifest::SCHEMA;
use knotdock::output::records::program::{COMMIT, VERSION};

const REMEDY: &str = "give a run that `knotdock dock` of this version wrote";

/// The bytes of a `run.json`.
///
/// # Errors
/// [`Error`] when the file cannot be read.
pub fn read_record(path: &Path) -> Result<Vec<u8>, Error> {
    read_bounded_file(path, MAX_RECORD).map_err(|source| {
        let message = format!("cannot read {}: {source}", path.display());
        file_error::refused(path, message, REMEDY)
    })
}

/// The part of a `run.json` that later commands read.
#[derive(Debug)]
pub struct RecordedRun {
    /// Version of the program that wrote it.
    pub version: String,
    /// Commit of the program that wrote it.
    pub commit: String,
    /// CPU feature level of the run.
    pub cpu_features: String,
    /// The receptor's file.
    pub receptor: InputRecord,
    /// The ligand's file.
    pub ligand: InputRecord,
    /// The native's files, if there was one.
    pub native: Option<NativeRecord>,
    /// The options.
    pub options: DockOptions,
}

impl RecordedRun {
    /// Reads a `run.json`: a file, no pipe, because its inputs are looked for beside it.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be read, is no record of this schema, or belongs to an ensemble.
    pub fn read(path: &Path) -> Result<Self, Error> {
        #[derive(Deserialize)]
        struct Header {
            schema: u32,
            program: String,
        }
        #[derive(Deserialize)]
        struct File {
            version: String,
            commit: String,
            cpu_features: String,
            inputs: FileInputs,
            options: DockOptions,
        }
        #[derive(Deserialize)]
        struct FileInputs {
            receptor: InputRecord,
            ligand: InputRecord,
            native: Option<NativeRecord>,
        }
        let directory = path.parent().unwrap_or(Path::new(""));
        let names_record = path.file_name().is_some_and(|name| name == RECORD);
        if names_record || (!path.exists() && is_ensemble(directory)) {
            return Err(file_error::refused(
                directory,
                format!(
                    "{} is an ensemble: each of its members is a run",
                    directory.display()
                ),
                "name the run of a member, a folder in members/; column `member` of poses.csv says which, and \
                 `member_rank` the rank there",
            ));
        }
        let text = read_record(path)?;
        let refused = |fault: String| {
            let message = format!(
                "{} is not a run.json that this version can read: {fault}",
                path.display()
            );
            file_error::refused(path, message, REMEDY)
        };
        let malformed = |error: serde_json::Error| {
            let line = u64::try_from(error.line()).ok().filter(|&line| line > 0);
            refused(error.to_string()).on_line(line)
        };
        // A record of another schema may hold anything else.
        let header: Header = serde_json::from_slice(&text).map_err(malformed)?;
        if header.program != "knotdock" {
            return Err(refused(format!("it was written by {}", header.program)));
        }
        if header.schema != SCHEMA {
            return Err(refused(format!(
                "its schema is {}, this version's is {SCHEMA}",
                header.schema
            )));
        }
        let file: File = serde_json::from_slice(&text).map_err(malformed)?;
        Ok(Self {
            version: file.version,
            commit: file.commit,
            cpu_features: file.cpu_features,
            receptor: file.inputs.receptor,
            ligand: file.inputs.ligand,
            native: file.inputs.native,
            options: file.options,
        })
    }

    /// Whether this very program wrote it.
    pub fn is_of_this_program(&self) -> bool {
        (self.version.as_str(), self.commit.as_str()) == (VERSION, COMMIT)
    }

    /// Whether it is the same request: files of the same content (wherever they lie), the same chains of them, and
    /// the same options except those of the machine.
    pub fn is_same_request(
        &self,
        [receptor, ligand]: [&InputRecord; 2],
        native: Option<&NativeRecord>,
        options: &DockOptions,
    ) -> bool {
        let own = self.native.as_ref().map(NativeRecord::files);
        let other = native.map(NativeRecord::files);
        let natives = match (&own, &other) {
            (Some(own), Some(other)) => {
                own.len() == other.len() && own.iter().zip(other).all(|(a, b)| a.is_like(b))
            }
            (own, other) => own.is_none() && other.is_none(),
        };
        self.receptor.is_like(receptor)
            && self.ligand.is_like(ligand)
            && natives
            && self.options
                == options.changed(|options| options.machine = MachineOptions::default())
    }
}
