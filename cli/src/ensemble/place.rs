//! The directory of an ensemble while it is docked.
//!
//! A new one grows in its directory, member by member, so that one that was stopped goes on; the joint files come at the
//! end. One that takes the place of another is docked beside it.

use std::path::{Path, PathBuf};

use knotdock::output::files::added::Addition;
use knotdock::output::files::own_files::{ENSEMBLE, MEMBERS, is_run};
use knotdock::output::files::staging::{Stage, Staging};

use knotdock_structures::Error;

/// Names that a directory may hold in which an ensemble was begun.
const BEGUN: [&str; 6] = [
    MEMBERS,
    "poses.csv",
    "top",
    "view.pml",
    "view.cxc",
    "report.html",
];

/// Where an ensemble is written.
pub(super) enum Place {
    /// In its directory.
    New(PathBuf, Box<Addition>),
    /// Beside it.
    Replacing(Box<Staging>),
}

impl Place {
    /// The place of an ensemble in a directory: beside it if it holds another run and `force` is true.
    ///
    /// # Errors
    /// [`Error`] if the directory holds anything but an ensemble that was begun.
    pub fn open(directory: &Path, force: bool) -> Result<Self, Error> {
        let is_begun = match std::fs::read_dir(directory) {
            Ok(entries) => entries.flatten().all(|entry| {
                let name = entry.file_name();
                BEGUN.iter().any(|begun| name == *begun)
            }),
            Err(_) => true,
        };
        if is_begun && !is_run(directory) {
            let addition = Addition::open(directory, Some(directory))?;
            return Ok(Self::New(directory.to_owned(), Box::new(addition)));
        }
        let staging = Staging::open(ENSEMBLE, directory, force)?;
        Ok(Self::Replacing(Box::new(staging)))
    }

    /// Files that ended commands left there.
    pub fn leftovers(&self) -> &[PathBuf] {
        match self {
            Self::New(_, addition) => &addition.leftovers,
            Self::Replacing(staging) => &staging.leftovers,
        }
    }

    /// The folder of a member.
    pub fn member(&self, name: &str) -> PathBuf {
        let folder = match self {
            Self::New(directory, _) => directory,
            Self::Replacing(staging) => staging.stage().folder(),
        };
        folder.join(MEMBERS).join(name)
    }

    /// The stage of the joint files.
    pub fn stage(&self) -> &Stage {
        match self {
            Self::New(_, addition) => addition.stage(),
            Self::Replacing(staging) => staging.stage(),
        }
    }

    /// Puts the joint files into their place.
    ///
    /// # Errors
    /// [`Error`] if they cannot be placed.
    pub fn commit(self) -> Result<(), Error> {
        match self {
            Self::New(_, addition) => addition.place(false)?,
            Self::Replacing(staging) => staging.commit()?,
        }
        Ok(())
    }
}
