//! What is wrong with a shard's files.

use std::path::{Path, PathBuf};

use crate::output::files::whole_file::FileError;

/// Why shards cannot be written or merged.
#[derive(Debug, thiserror::Error)]
pub enum ShardError {
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's message.
        source: std::io::Error,
    },
    /// A file is not what its name says.
    #[error("{message}")]
    Wrong {
        /// The file or folder.
        path: PathBuf,
        /// The fault.
        message: String,
        /// What to do about it.
        remedy: String,
    },
}

impl ShardError {
    /// A fault of a file or folder, and what to do about it.
    pub fn wrong(path: &Path, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Wrong {
            path: path.to_owned(),
            message: message.into(),
            remedy: remedy.into(),
        }
    }

    /// What the system says about a file that is read.
    pub(super) fn reading(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        |source| Self::Unreadable {
            path: path.to_owned(),
            source,
        }
    }

    /// The file or folder in question.
    pub fn path(&self) -> &Path {
        match self {
            Self::File(error) => error.path(),
            Self::Unreadable { path, .. } | Self::Wrong { path, .. } => path,
        }
    }

    /// Remedy for the user.
    pub fn remedy(&self) -> String {
        match self {
            Self::File(error) => error.remedy().to_owned(),
            Self::Unreadable { .. } => "check the disk and the permissions there".to_owned(),
            Self::Wrong { remedy, .. } => remedy.clone(),
        }
    }

    /// Whether the request was at fault (exit code 2) and not the writing (exit code 1).
    pub fn is_input(&self) -> bool {
        match self {
            Self::File(error) => error.is_input(),
            Self::Unreadable { .. } => false,
            Self::Wrong { .. } => true,
        }
    }
}
