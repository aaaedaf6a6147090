//! The part of a `run.json` that later commands read.

use knotdock_structures::Error;
use std::io;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::records::ensemble_record::{RECORD, is_ensemble};
use knotdock::bounded_read::{MAX_RECORD, read_bounded_file};
use knotdock::options::{DockOptions, MachineOptions};
use knotdock::output::records::input_record::{InputRecord, NativeRecord};
use knotdock::output::records::manifest::SCHEMA;
use knotdock::output::records::program::{COMMIT, VERSION};

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

/// Why a `run.json` cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RecordedRunError {
    /// The file cannot be opened.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's message.
        source: io::Error,
    },
    /// The directory is that of an ensemble, each member of which has a record of its own.
    #[error("{} is an ensemble: each of its members is a run", directory.display())]
    Ensemble {
        /// The directory.
        directory: PathBuf,
    },
    /// The file is no manifest that this version understands.
    #[error("{} is not a run.json that this version can read: {message}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// 1-based line, where known.
        line: Option<u64>,
        /// The fault, in words.
        message: String,
    },
}

impl RecordedRunError {
    /// The file in question.
    pub fn path(&self) -> &Path {
        match self {
            Self::Open { path, .. } | Self::Content { path, .. } => path,
            Self::Ensemble { directory } => directory,
        }
    }

    /// The 1-based line in question, where there is one.
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::Open { .. } | Self::Ensemble { .. } => None,
            Self::Content { line, .. } => *line,
        }
    }

    /// Remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Ensemble { .. } => {
                "name the run of a member, a folder in members/; column `member` of poses.csv says which, and \
                 `member_rank` the rank there"
            }
            _ => "give a run that `knotdock dock` of this version wrote",
        }
    }
}

impl RecordedRun {
    /// Reads a `run.json`: a file, no pipe, for its inputs are looked for beside it.
    ///
    /// # Errors
    /// [`RecordedRunError`].
    pub fn read(path: &Path) -> Result<Self, RecordedRunError> {
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
            let directory = directory.to_owned();
            return Err(RecordedRunError::Ensemble { directory });
        }
        let text =
            read_bounded_file(path, MAX_RECORD).map_err(|source| RecordedRunError::Open {
                path: path.to_owned(),
                source,
            })?;
        let content = |line, message| RecordedRunError::Content {
            path: path.to_owned(),
            line,
            message,
        };
        let wrong = |error: serde_json::Error| {
            let line = u64::try_from(error.line()).ok().filter(|&line| line > 0);
            content(line, error.to_string())
        };
        // What else a record of another schema holds may be anything.
        let header: Header = serde_json::from_slice(&text).map_err(wrong)?;
        if header.program != "knotdock" {
            let message = format!("it was written by {}", header.program);
            return Err(content(None, message));
        }
        if header.schema != SCHEMA {
            let message = format!(
                "its schema is {}, this version's is {SCHEMA}",
                header.schema
            );
            return Err(content(None, message));
        }
        let file: File = serde_json::from_slice(&text).map_err(wrong)?;
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

impl From<RecordedRunError> for Error {
    fn from(error: RecordedRunError) -> Self {
        Self::input(&error)
            .at(error.path())
            .on_line(error.line())
            .help(error.remedy())
    }
}
