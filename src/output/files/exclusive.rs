//! A lock on a folder, which the system lets go of however the process ends.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// A file that this process alone has locked. Dropped, it lets go of the lock and leaves the file.
#[derive(Debug)]
pub struct ExclusiveLock {
    path: PathBuf,
    file: File,
}

impl ExclusiveLock {
    /// Makes and locks a file; `None` where another process holds the lock. Where the file system knows no locks the
    /// file is there all the same.
    ///
    /// # Errors
    /// What the system says when the file cannot be made.
    pub fn take(path: &Path) -> io::Result<Option<Self>> {
        // Network file systems lock only what may be written to.
        let mut options = File::options();
        let options = options.read(true).write(true).create(true).truncate(false);
        let file = options.open(path)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => Ok(None),
            // A process that has just ended took the file with it.
            Ok(()) if !is_at(&file, path) => Ok(None),
            Ok(()) | Err(TryLockError::Error(_)) => Ok(Some(Self {
                path: path.to_owned(),
                file,
            })),
        }
    }

    /// Removes the file and lets go of the lock.
    pub fn remove(self) {
        let Self { path, file } = self;
        // Windows removes no file that is open; elsewhere nobody may lock it before it is gone.
        if cfg!(windows) {
            drop(file);
        }
        // A failure to tidy up has nobody to report to, and an unlocked file is in nobody's way.
        let _ = std::fs::remove_file(path);
    }
}

/// Whether an open file is the one at a path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let key = |found: std::fs::Metadata| (found.dev(), found.ino());
    match (file.metadata(), path.symlink_metadata()) {
        (Ok(open), Ok(there)) => key(open) == key(there),
        _ => false,
    }
}

/// Whether an open file is the one at a path: there no file that is open is removed.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_holds_the_lock_and_the_next_one_may() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let first = ExclusiveLock::take(&path).unwrap().unwrap();
        assert!(ExclusiveLock::take(&path).unwrap().is_none());
        drop(first);
        let second = ExclusiveLock::take(&path).unwrap().unwrap();
        second.remove();
        assert!(!path.exists());
        assert!(ExclusiveLock::take(&path).unwrap().is_some());
    }

    /// The file may go and come again between opening and locking it: then two would hold locks of one name.
    #[cfg(unix)]
    #[test]
    fn a_lock_on_a_file_that_is_gone_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let file = File::create(&path).unwrap();
        assert!(is_at(&file, &path));
        std::fs::remove_file(&path).unwrap();
        let _other = File::create(&path).unwrap();
        assert!(!is_at(&file, &path));
    }
}
