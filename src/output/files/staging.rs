//! Whole files or none.
//!
//! A run is built in `DIR/.partial/` and its entries are renamed into `DIR` when all of them are written, `run.json`
//! last: a directory with a `run.json` holds a whole run. A process that is killed leaves only `.partial` names,
//! which the next run into the same directory removes. Nothing in `DIR` that is not a run's own is ever touched. A
//! run that goes on holds a lock in `DIR/.partial/`, which the system lets go of however the run ends, so that no
//! other run takes its files for a killed one's.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::output::files::exclusive::ExclusiveLock;
use crate::output::files::whole_file::{FileError, PARTIAL};

/// Files that a command puts into its directory.
#[derive(Debug, PartialEq, Eq)]
pub struct Product {
    /// The entries, in the order in which they are moved there.
    entries: &'static [&'static str],
    /// The one that comes last and says which program wrote it.
    record: &'static str,
}

impl Product {
    /// Refuses a directory that holds one of these, unless `force` is true, or entries of these names that are none.
    /// `interrupted` says that a staging folder was found there, so that entries without their record are a killed
    /// run's.
    fn refuse_existing(
        &self,
        directory: &Path,
        interrupted: bool,
        force: bool,
    ) -> Result<(), StagingError> {
        let mut entries = self.entries.iter();
        let Some(entry) = entries.find(|entry| directory.join(entry).symlink_metadata().is_ok())
        else {
            return Ok(());
        };
        if !interrupted && !is_ours(&directory.join(self.record)) {
            return Err(StagingError::NotARun {
                directory: directory.to_owned(),
                entry,
                record: self.record,
            });
        }
        if !force {
            return Err(StagingError::ExistingRun(directory.to_owned()));
        }
        Ok(())
    }
}

/// Files of `knotdock dock`.
pub const RUN: Product = Product {
    entries: &["top", "poses.csv", "run.json"],
    record: "run.json",
};

/// Files of `knotdock tradeoff`.
pub const TRADEOFF: Product = Product {
    entries: &["tradeoff.svg", "tradeoff.csv", "tradeoff.json"],
    record: "tradeoff.json",
};

/// Why output could not be written.
#[derive(Debug, thiserror::Error)]
pub enum StagingError {
    /// The directory holds a run, and overwriting it was not requested.
    #[error("{} already holds a run", .0.display())]
    ExistingRun(PathBuf),
    /// Another process is writing its run there.
    #[error("another run is being written to {}", .0.display())]
    Busy(PathBuf),
    /// The directory holds a run's names, but they are not of a run.
    #[error("{} holds {entry} but no {record} of knotdock, so it is not a run that may be overwritten", directory.display())]
    NotARun {
        /// The directory.
        directory: PathBuf,
        /// The file or folder in it that a run would replace.
        entry: &'static str,
        /// The record that would show it to be a run.
        record: &'static str,
    },
    /// Something could not be written.
    #[error(transparent)]
    Write(#[from] FileError),
}

impl StagingError {
    /// Remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::ExistingRun(_) => {
                "choose another directory with -o, or pass --force to replace the run"
            }
            Self::Busy(_) => "wait for it to end, or choose another directory with -o",
            Self::NotARun { .. } => "choose another directory with -o",
            Self::Write(error) => error.remedy(),
        }
    }

    /// The file or directory in question.
    pub fn path(&self) -> &Path {
        match self {
            Self::ExistingRun(directory)
            | Self::Busy(directory)
            | Self::NotARun { directory, .. } => directory,
            Self::Write(error) => error.path(),
        }
    }
}

/// A run's directory while the run goes on: files are written under [`Staging::folder`] and appear all together on
/// [`Staging::commit`]. Dropped before that, it leaves the directory as it was.
#[derive(Debug)]
pub struct Staging {
    product: &'static Product,
    directory: PathBuf,
    folder: PathBuf,
    made_directory: bool,
    state: State,
    /// Locked for as long as the run goes on.
    lock: Option<ExclusiveLock>,
}

/// The file in the staging folder that a run locks.
const LOCK: &str = "lock";

/// Progress of a staging, which decides what its end has to remove.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Being filled: the folder goes, and the directory if it was made for it.
    Open,
    /// Moved into place: the folder with the replaced run goes.
    Committed,
    /// Holds what could not be moved back: everything stays.
    Kept,
}

impl Staging {
    /// Makes `directory` if there is none and the staging folder in it, which also shows that it can be written to.
    ///
    /// # Errors
    /// [`StagingError::ExistingRun`] when a run is there and `force` is false, [`StagingError::NotARun`] when what is
    /// there no run has written, [`StagingError::Busy`] when another run is being written there,
    /// [`StagingError::Write`] when nothing can be.
    pub fn open(directory: &Path, force: bool) -> Result<Self, StagingError> {
        Self::of(&RUN, directory, force)
    }

    /// As [`Staging::open`], for whichever product.
    ///
    /// # Errors
    /// As [`Staging::open`].
    pub fn of(
        product: &'static Product,
        directory: &Path,
        force: bool,
    ) -> Result<Self, StagingError> {
        let folder = directory.join(PARTIAL);
        // A staging folder here means that a run goes on, as its lock will tell, or was killed, possibly between its
        // renames: what that left is ours.
        let interrupted = folder.is_dir();
        product.refuse_existing(directory, interrupted, force)?;
        Self::claim(product, directory, interrupted, force)
    }

    /// Makes and locks the staging folder of a directory in which nothing was found that may not be replaced.
    fn claim(
        product: &'static Product,
        directory: &Path,
        interrupted: bool,
        force: bool,
    ) -> Result<Self, StagingError> {
        let folder = directory.join(PARTIAL);
        let unwritable = |source| FileError::unwritable(directory, source);
        let made_directory = !directory.exists();
        fs::create_dir_all(&folder).map_err(unwritable)?;
        let lock = ExclusiveLock::take(&folder.join(LOCK)).map_err(unwritable)?;
        let Some(lock) = lock else {
            return Err(StagingError::Busy(directory.to_owned()));
        };
        let staging = Self {
            product,
            directory: directory.to_owned(),
            folder,
            made_directory,
            state: State::Open,
            lock: Some(lock),
        };
        // Another run may have come to its end between the first look and the lock.
        product.refuse_existing(directory, interrupted, force)?;
        clear(&staging.folder).map_err(unwritable)?;
        Ok(staging)
    }

    /// The folder to write into.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Moves what was written into the run's directory, in place of an older run.
    ///
    /// # Errors
    /// [`StagingError::Write`] when a rename fails; the older run's entries are put back.
    pub fn commit(mut self) -> Result<(), StagingError> {
        let replaced = self.folder.join("replaced");
        fs::create_dir(&replaced).map_err(|source| FileError::writing(&replaced, source))?;
        let entries = self.product.entries;
        let outward = entries
            .iter()
            .rev()
            .map(|entry| (self.directory.join(entry), replaced.join(entry)));
        let inward = entries
            .iter()
            .map(|entry| (self.folder.join(entry), self.directory.join(entry)));
        let mut done: Vec<(PathBuf, PathBuf)> = Vec::new();
        for (from, to) in outward.chain(inward) {
            if from.symlink_metadata().is_err() {
                continue;
            }
            if let Err(source) = fs::rename(&from, &to) {
                for (from, to) in done.iter().rev() {
                    if fs::rename(to, from).is_err() {
                        // The staging folder now holds something of the older run: leave it for the user.
                        self.state = State::Kept;
                    }
                }
                return Err(FileError::writing(&to, source).into());
            }
            done.push((from, to));
        }
        self.state = State::Committed;
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // Windows removes no file that is open; elsewhere nobody may take the folder for a killed run's before it is
        // gone.
        if cfg!(windows) {
            self.lock = None;
        }
        // A failure to tidy up has nobody to report to; the next run clears what is left.
        if self.state == State::Kept {
            return;
        }
        let _ = fs::remove_dir_all(&self.folder);
        if self.made_directory && self.state == State::Open {
            let _ = fs::remove_dir(&self.directory);
        }
    }
}

/// Removes what a killed run left in a staging folder, but for the lock.
fn clear(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            fs::remove_dir_all(&path)?;
        } else if path != folder.join(LOCK) {
            fs::remove_file(&path)?;
        }
    }
    Ok(())
}

/// Whether a record is one of ours.
fn is_ours(record: &Path) -> bool {
    fs::read(record)
        .ok()
        .and_then(|bytes| serde_json::from_slice::<serde_json::Value>(&bytes).ok())
        .is_some_and(|run| run.get("program").and_then(|name| name.as_str()) == Some("knotdock"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fill(staging: &Staging, text: &str) {
        fs::create_dir(staging.folder().join("top")).unwrap();
        fs::write(staging.folder().join("top/rank_0001.pdb"), text).unwrap();
        fs::write(staging.folder().join("poses.csv"), text).unwrap();
        fs::write(
            staging.folder().join("run.json"),
            format!(r#"{{"program":"knotdock","text":"{text}"}}"#),
        )
        .unwrap();
    }

    #[test]
    fn a_failed_run_loses_nothing_and_leaves_nothing() {
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("run");
        drop(Staging::open(&directory, false).unwrap());
        assert!(!directory.exists(), "a directory made for nothing must go");

        let first = Staging::open(&directory, false).unwrap();
        fill(&first, "first");
        first.commit().unwrap();
        fs::write(directory.join("notes.txt"), "mine").unwrap();

        let second = Staging::open(&directory, true).unwrap();
        fill(&second, "second");
        drop(second); // the run failed before its end
        assert_eq!(
            fs::read_to_string(directory.join("poses.csv")).unwrap(),
            "first"
        );
        assert!(!directory.join(PARTIAL).exists());

        let third = Staging::open(&directory, true).unwrap();
        fill(&third, "third");
        third.commit().unwrap();
        for file in ["poses.csv", "top/rank_0001.pdb"] {
            assert_eq!(fs::read_to_string(directory.join(file)).unwrap(), "third");
        }
        assert_eq!(
            fs::read_to_string(directory.join("notes.txt")).unwrap(),
            "mine"
        );
        assert!(!directory.join(PARTIAL).exists());
    }

    #[test]
    fn an_older_run_is_replaced_on_request_only_and_a_stranger_never() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("poses.csv"), "not ours").unwrap();
        // Where no run is, --force is not the remedy.
        for force in [false, true] {
            assert!(matches!(
                Staging::open(root.path(), force),
                Err(StagingError::NotARun { .. })
            ));
        }
        assert_eq!(
            fs::read_to_string(root.path().join("poses.csv")).unwrap(),
            "not ours"
        );
    }

    /// Found by an audit: a second run into one directory removed what the first had staged, which then failed at its
    /// end.
    #[test]
    fn two_runs_do_not_share_a_directory() {
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("run");
        let first = Staging::open(&directory, false).unwrap();
        fill(&first, "first");
        for force in [false, true] {
            assert!(matches!(
                Staging::open(&directory, force),
                Err(StagingError::Busy(_))
            ));
        }
        first.commit().unwrap();
        assert!(matches!(
            Staging::open(&directory, false),
            Err(StagingError::ExistingRun(_))
        ));
        drop(Staging::open(&directory, true).unwrap());
        assert_eq!(
            fs::read_to_string(directory.join("poses.csv")).unwrap(),
            "first"
        );
    }

    /// Found by a review: a run that ended after another had looked and before that one held the lock was replaced
    /// without --force.
    #[test]
    fn a_run_that_ends_before_the_lock_is_taken_is_not_replaced() {
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("run");
        let first = Staging::open(&directory, false).unwrap();
        fill(&first, "first");
        first.commit().unwrap();
        for interrupted in [false, true] {
            assert!(matches!(
                Staging::claim(&RUN, &directory, interrupted, false),
                Err(StagingError::ExistingRun(_))
            ));
        }
        assert_eq!(
            fs::read_to_string(directory.join("poses.csv")).unwrap(),
            "first"
        );
        assert!(!directory.join(PARTIAL).exists());
    }

    #[test]
    fn what_a_killed_run_left_is_cleared() {
        let root = tempfile::tempdir().unwrap();
        fs::create_dir_all(root.path().join(".partial/top")).unwrap();
        fs::write(root.path().join(".partial/poses.csv"), "half").unwrap();
        let staging = Staging::open(root.path(), false).unwrap();
        assert!(!staging.folder().join("poses.csv").exists());
    }
}
