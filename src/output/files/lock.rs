//! A lock: one command at a time writes to a place. The system releases it however the process ends.

use crate::output::files::file_error;
use knotdock_structures::Error;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use super::disk;

/// A lock file that this process holds. Dropped, it goes.
///
/// On a file system without locks, the new file itself is the lock. After a kill it has to be removed by hand there.
#[derive(Debug)]
pub struct Lock {
    file: Option<File>,
    path: PathBuf,
}

impl Lock {
    /// Takes the lock of a path, at which there is no file or an empty one.
    ///
    /// # Errors
    /// [`Error`] if another process holds it, if something else has the name, and if no file can be made.
    pub fn take(path: &Path) -> Result<Self, Error> {
        // The process that holds the lock may remove the file at any moment.
        const ATTEMPTS: usize = 16;
        let failed = |source| file_error::unwritable(path, source);
        for _ in 0..ATTEMPTS {
            let (file, is_new) = match disk::create(path) {
                Ok(file) => (file, true),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    match disk::open(path, File::options().read(true).write(true)) {
                        Ok(file) => (file, false),
                        Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                        Err(_) => return Err(in_the_way(path)),
                    }
                }
                Err(error) => return Err(failed(error)),
            };
            if file.metadata().map_err(failed)?.len() > 0 {
                return Err(in_the_way(path));
            }
            match try_lock(&file) {
                Ok(()) if is_at(&file, path) => {}
                Ok(()) => continue,
                Err(TryLockError::Error(_)) if is_new => {}
                Err(error) => return Err(held(path, matches!(error, TryLockError::Error(_)))),
            }
            return Ok(Self {
                file: Some(file),
                path: path.to_owned(),
            });
        }
        Err(held(path, false))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Windows removes no file that is open; elsewhere nobody may lock it before it is gone.
        if cfg!(windows) {
            self.file = None;
        }
        // One that stays is taken over by the next command.
        let _ = disk::remove_file(&self.path);
    }
}

fn try_lock(file: &File) -> Result<(), TryLockError> {
    // So that tests take the way of file systems without locks.
    if cfg!(debug_assertions) && std::env::var_os("KNOTDOCK_NO_LOCKS").is_some() {
        return Err(TryLockError::Error(io::ErrorKind::Unsupported.into()));
    }
    file.try_lock()
}

fn in_the_way(path: &Path) -> Error {
    file_error::refused(path, "this is no lock of knotdock's", "move it away")
}

fn held(path: &Path, may_be_left: bool) -> Error {
    let remedy = match may_be_left {
        true => "wait for it to end; if none runs, one that was ended left this file: remove it",
        false => "wait for it to end, or choose another directory with -o",
    };
    file_error::refused(path, "another command is writing there", remedy)
}

/// Whether an open file is the one at a path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let key = |found: fs::Metadata| (found.dev(), found.ino());
    match (file.metadata(), path.symlink_metadata()) {
        (Ok(open), Ok(there)) => key(open) == key(there),
        _ => false,
    }
}

/// Whether an open file is the one at a path: there no file that is open is removed.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    fs::metadata(path).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_holds_the_lock_and_the_next_one_may() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(".run.knotdock-lock");
        let first = Lock::take(&path).unwrap();
        assert!(Lock::take(&path).is_err());
        drop(first);
        // A kill leaves the file, and not the lock.
        fs::write(&path, "").unwrap();
        drop(Lock::take(&path).unwrap());
        assert!(!path.exists());
        fs::write(&path, "mine").unwrap();
        assert!(Lock::take(&path).is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    }
}
