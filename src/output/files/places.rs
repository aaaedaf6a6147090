//! A run's directory as a run finds it: what it holds, and the staging folders for it.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::commit::{self, SetAside};
use super::own_files::{Found, OwnFiles, survey};
use super::product::Product;
use super::staging_error::StagingError;
use super::staging_folder::{Others, StagingFolder};
use super::whole_file::{FileError, parent};

/// A directory, and where its staging folders may lie.
pub(super) struct Places<'a> {
    /// As the user named it.
    pub directory: &'a Path,
    /// Without links.
    pub resolved: &'a Path,
}

impl Places<'_> {
    /// Whether the staging folder may lie beside the directory: on the same file system, with the directory neither
    /// the current one nor above it, which would be lost to the processes in it.
    pub fn may_be_beside(&self) -> bool {
        if !self.resolved.is_dir() {
            return true;
        }
        let holds_current = std::env::current_dir()
            .and_then(|current| current.canonicalize())
            .is_ok_and(|current| current.starts_with(self.resolved));
        self.resolved.file_name().is_some()
            && !holds_current
            && is_one_device(self.resolved, parent(self.resolved))
    }

    /// The staging folders of other processes, those that were left behind taken.
    pub fn others(&self, own: Option<&StagingFolder>) -> Result<Others, FileError> {
        let unreadable = |source| FileError::unwritable(self.directory, source);
        let mut others = Others::default();
        let name = self.resolved.file_name().unwrap_or_default();
        for (folder, target) in [
            (parent(self.resolved), name),
            (self.resolved, OsStr::new("")),
        ] {
            let found = match StagingFolder::others(folder, target, own) {
                // A folder above that is not there or may not be read has none.
                Err(error) if is_closed(&error) => continue,
                found => found.map_err(unreadable)?,
            };
            others.left.extend(found.left);
            others.in_use = others.in_use.or(found.in_use);
        }
        Ok(others)
    }

    /// Finishes or removes what killed runs left; the files of the user's that were in the way.
    pub fn clear(&self, product: &Product) -> Result<Vec<SetAside>, StagingError> {
        let others = self.others(None)?;
        let mut set_aside = Vec::new();
        for staging in others.left {
            set_aside.extend(self.finish(product, staging)?);
        }
        match others.in_use {
            None => Ok(set_aside),
            Some(folder) => Err(StagingError::Busy {
                directory: self.directory.to_owned(),
                folder,
            }),
        }
    }

    /// Finishes or undoes what a killed run left in a staging folder.
    pub fn finish(
        &self,
        product: &Product,
        staging: StagingFolder,
    ) -> Result<Vec<SetAside>, StagingError> {
        let folder = staging.path().to_owned();
        commit::finish(product, staging, self.resolved).map_err(|source| {
            StagingError::Interrupted {
                directory: self.directory.to_owned(),
                folder,
                source,
            }
        })
    }

    /// Refuses a directory that holds a run, unless `force` is true, or what only looks like one.
    pub fn refuse_existing(&self, product: &Product, force: bool) -> Result<(), StagingError> {
        let directory = self.directory.to_owned();
        let others = product.not_beside.iter();
        if let Some(record) = others
            .copied()
            .find(|name| self.resolved.join(name).exists())
        {
            return Err(StagingError::AnotherKind { directory, record });
        }
        match self.survey(product)? {
            Found::Nothing => Ok(()),
            Found::Foreign(entry) => Err(StagingError::NotARun { directory, entry }),
            Found::Run(_) | Found::Broken(_) if force => Ok(()),
            Found::Run(_) => Err(StagingError::ExistingRun(directory)),
            Found::Broken(_) => Err(StagingError::BrokenRun {
                directory,
                record: product.record,
            }),
        }
    }

    /// The files that a new run replaces.
    pub fn own_files(&self, product: &Product) -> Result<OwnFiles, StagingError> {
        match self.survey(product)? {
            Found::Nothing => Ok(OwnFiles::default()),
            Found::Run(own) | Found::Broken(own) => Ok(own),
            Found::Foreign(entry) => Err(StagingError::NotARun {
                directory: self.directory.to_owned(),
                entry,
            }),
        }
    }

    fn survey(&self, product: &Product) -> Result<Found, FileError> {
        let unreadable = |source| FileError::unwritable(self.directory, source);
        survey(product, self.resolved).map_err(unreadable)
    }
}

/// Whether an error says that a folder is not there or may not be read.
fn is_closed(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::NotFound | io::ErrorKind::PermissionDenied
    )
}

/// A directory's path without links; of one that is not there, that of the nearest folder above with the rest.
pub(super) fn resolved(directory: &Path) -> io::Result<PathBuf> {
    if directory.symlink_metadata().is_ok() {
        let resolved = directory.canonicalize()?;
        return match resolved.is_dir() {
            true => Ok(resolved),
            false => Err(io::ErrorKind::NotADirectory.into()),
        };
    }
    let absolute = std::path::absolute(directory)?;
    match (absolute.parent(), absolute.file_name()) {
        (Some(above), Some(name)) => Ok(resolved(above)?.join(name)),
        _ => Ok(absolute),
    }
}

/// Whether two folders are on one file system.
#[cfg(unix)]
fn is_one_device(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let device = |path: &Path| fs::metadata(path).map(|found| found.dev()).ok();
    device(one).is_some() && device(one) == device(other)
}

/// Whether two folders are on one file system: there a folder beside another is.
#[cfg(not(unix))]
fn is_one_device(one: &Path, other: &Path) -> bool {
    fs::metadata(one).is_ok() && fs::metadata(other).is_ok()
}
