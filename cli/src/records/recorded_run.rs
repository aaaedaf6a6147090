//! The part of a `run.json` that later commands read.

use std::path::Path;

use serde::Deserialize;

use crate::records::{ENSEMBLE_RECORD, is_ensemble};
use knotdock::bounded_read::{MAX_RECORD, read_bounded_file};
use knotdock::options::{DockOptions, MachineOptions};
use knotdock::output::files::file_error;
use knotdock::output::records::input_record::{InputRecord, NativeRecord};
use knotdock::output::records::manifest::SCHEMA;
use knotdock::output::records::program::{COMMIT, VERSION};
use knotdock::redock::Redocking;
use knotdock_structures::Error;

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
#[derive(Debug, Deserialize)]
pub struct RecordedRun {
    /// Version of the program that wrote it.
    pub version: String,
    /// Commit of the program that wrote it.
    pub commit: String,
    /// CPU feature level of the run.
    pub cpu_features: String,
    /// The input files.
    pub inputs: RecordedInputs,
    /// The options.
    pub options: DockOptions,
    /// The comparison with a predicted complex, if the run docked one again.
    pub redocking: Option<Redocking>,
}

/// The input files of a recorded run.
#[derive(Debug, Deserialize)]
pub struct RecordedInputs {
    /// The receptor's file.
    pub receptor: InputRecord,
    /// The ligand's file.
    pub ligand: InputRecord,
    /// The native's files, if there was one.
    pub native: Option<NativeRecord>,
}

impl RecordedInputs {
    /// Receptor and ligand.
    pub fn pair(&self) -> [&InputRecord; 2] {
        [&self.receptor, &self.ligand]
    }
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
        let directory = path.parent().unwrap_or(Path::new(""));
        let names_record = path.file_name().is_some_and(|name| name == ENSEMBLE_RECORD);
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
        serde_json::from_slice(&text).map_err(malformed)
    }

    /// Whether this very program wrote it.
    pub fn is_of_this_program(&self) -> bool {
        (self.version.as_str(), self.commit.as_str()) == (VERSION, COMMIT)
    }

    /// Whether it is the same request: files of the same content (wherever they lie), the same chains of them, and
    /// the same options except those of the machine.
    pub fn is_same_request<'a>(
        &'a self,
        inputs: [&'a InputRecord; 2],
        native: Option<&'a NativeRecord>,
        options: &DockOptions,
    ) -> bool {
        let files = |pair: [&'a InputRecord; 2], native: Option<&'a NativeRecord>| {
            let natives = native.map_or(Vec::new(), NativeRecord::files);
            pair.into_iter().chain(natives).collect::<Vec<_>>()
        };
        let own = files(self.inputs.pair(), self.inputs.native.as_ref());
        let other = files(inputs, native);
        own.len() == other.len()
            && own.iter().zip(other).all(|(own, other)| own.is_like(other))
            && self.options
                == options.changed(|options| options.machine = MachineOptions::default())
    }
}
