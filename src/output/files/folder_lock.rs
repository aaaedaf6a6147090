//! A lock on a folder, which the system lets go of however the process ends.

use std::ffi::OsStr;
use std::io;
use std::path::Path;

use super::staging_folder::StagingFolder;

/// A folder that this process alone writes to, among processes that ask.
#[derive(Debug)]
pub struct FolderLock(Option<StagingFolder>);

/// What the staging folder that stands for the lock is named after.
const NAME: &str = "results.csv.lock";

impl FolderLock {
    /// Locks a folder; `None` where another process holds the lock.
    ///
    /// # Errors
    /// What the system says when nothing can be made in the folder.
    pub fn take(folder: &Path) -> io::Result<Option<Self>> {
        let name = OsStr::new(NAME);
        let own = StagingFolder::create(folder, name)?;
        // Of two that come at the same time, either sees the other: then neither goes on.
        let others = StagingFolder::others(folder, name, Some(&own))?;
        if others.in_use.is_some() {
            own.remove()?;
            return Ok(None);
        }
        for left in others.left {
            left.remove()?;
        }
        Ok(Some(Self(Some(own))))
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if let Some(own) = self.0.take() {
            // A failure to tidy up has nobody to report to, and an unlocked folder is in nobody's way.
            let _ = own.remove();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_holds_the_lock_and_the_next_one_may() {
        let folder = tempfile::tempdir().unwrap();
        let first = FolderLock::take(folder.path()).unwrap().unwrap();
        assert!(FolderLock::take(folder.path()).unwrap().is_none());
        drop(first);
        drop(FolderLock::take(folder.path()).unwrap().unwrap());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
