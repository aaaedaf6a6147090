//! Why a run could not be written to its directory.

use std::io;
use std::path::{Path, PathBuf};

use super::whole_file::FileError;

/// Why output could not be written.
#[derive(Debug, thiserror::Error)]
pub enum StagingError {
    /// The directory holds a run, and overwriting it was not requested.
    #[error("{} already holds a run", .0.display())]
    ExistingRun(PathBuf),
    /// The directory holds a run without its record, and overwriting it was not requested.
    #[error("{} holds a broken run: {record} is missing or damaged", directory.display())]
    BrokenRun {
        /// The directory.
        directory: PathBuf,
        /// The record.
        record: &'static str,
    },
    /// The directory holds results of another kind, with files of the same names.
    #[error(
        "{} holds {record} and results of another kind: those of one pair and those of an ensemble do not share a \
         directory",
        directory.display()
    )]
    AnotherKind {
        /// The directory.
        directory: PathBuf,
        /// The record there.
        record: &'static str,
    },
    /// Another process is writing its run there.
    #[error("another run is being written to {}: {} is in use", directory.display(), folder.display())]
    Busy {
        /// The directory.
        directory: PathBuf,
        /// The staging folder that the other process uses.
        folder: PathBuf,
    },
    /// The directory holds a run's names, but they are not of a run.
    #[error("{} holds {entry}, which no run of knotdock wrote, so it is not a run that may be overwritten", directory.display())]
    NotARun {
        /// The directory.
        directory: PathBuf,
        /// The file or folder in it that a run would replace.
        entry: &'static str,
    },
    /// Moving the run into its place failed, and so did putting back what was there.
    #[error("cannot finish the run in {}: {source}; all of it and of the older run is in {}", directory.display(), folder.display())]
    Interrupted {
        /// The directory.
        directory: PathBuf,
        /// The staging folder.
        folder: PathBuf,
        /// The system's message.
        source: io::Error,
    },
    /// Something could not be written.
    #[error(transparent)]
    Write(#[from] FileError),
}

impl StagingError {
    /// Remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::ExistingRun(_) | Self::BrokenRun { .. } => {
                "choose another directory with -o, or pass --force to replace the run"
            }
            Self::Busy { .. } => "wait for it to end, or choose another directory with -o",
            Self::NotARun { .. } | Self::AnotherKind { .. } => "choose another directory with -o",
            Self::Interrupted { .. } => {
                "make the directory writable and run again: what is left is finished first"
            }
            Self::Write(error) => error.remedy(),
        }
    }

    /// The file or directory in question.
    pub fn path(&self) -> &Path {
        match self {
            Self::ExistingRun(directory)
            | Self::BrokenRun { directory, .. }
            | Self::Busy { directory, .. }
            | Self::Interrupted { directory, .. }
            | Self::AnotherKind { directory, .. }
            | Self::NotARun { directory, .. } => directory,
            Self::Write(error) => error.path(),
        }
    }
}
