//! Staging folders: where files are written before they take their places.
//!
//! A staging folder lies beside what it is for, under a name that nothing had: `.TARGET.knotdock-` and twelve random
//! letters. It holds a file `lock`, which says what the folder is for. The process that made it keeps that file
//! locked, and the system lets go of the lock however the process ends. So a later process knows a staging folder
//! that was left behind from one in use, and from a user's folder of such a name.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use super::disk::{self, NewFile};

/// The file that is locked.
const LOCK: &str = "lock";

/// First line of the file that is locked; the second is the name of the target.
const MARKER: &str = "knotdock staging folder";

/// Bytes of the target's name that the folder's name repeats at most: a name has 255 at most in all.
const MAX_NAME: usize = 200;

/// A staging folder that this process alone uses.
#[derive(Debug)]
pub(super) struct StagingFolder {
    path: PathBuf,
    /// Locked while the folder is in use. `None` in a folder that was left empty.
    lock: Option<File>,
}

/// The staging folders of a target that other processes made.
#[derive(Debug, Default)]
pub(super) struct Others {
    /// Those that were left behind; this process has them now.
    pub left: Vec<StagingFolder>,
    /// One that another process uses.
    pub in_use: Option<PathBuf>,
}

impl StagingFolder {
    /// Makes a staging folder in `parent` for a target of a name; of an empty name for `parent` itself.
    ///
    /// # Errors
    /// What the system says when it cannot be made.
    pub fn create(parent: &Path, target: &OsStr) -> io::Result<Self> {
        // A process that clears what others left may take a folder in the moment in which it is not locked yet.
        const ATTEMPTS: usize = 8;
        let mut last = io::Error::from(io::ErrorKind::WouldBlock);
        for _ in 0..ATTEMPTS {
            match Self::create_once(parent, target) {
                Ok(folder) => return Ok(folder),
                Err(error) if error.kind() == io::ErrorKind::NotFound && parent.is_dir() => {
                    last = error;
                }
                Err(error) => return Err(error),
            }
        }
        Err(last)
    }

    fn create_once(parent: &Path, target: &OsStr) -> io::Result<Self> {
        let parent = if parent.as_os_str().is_empty() {
            Path::new(".")
        } else {
            parent
        };
        let made = tempfile::Builder::new()
            .prefix(&prefix(target))
            .rand_bytes(RANDOM)
            .make_in(parent, disk::create_dir)?;
        let path = made.into_temp_path().keep().map_err(|error| error.error)?;
        let lock = disk::NewFile::create(&path.join(LOCK)).and_then(|mut file| {
            let text = marker(target);
            file.write_all(text.as_bytes()).map(|()| file)
        });
        let lock = lock
            .map(NewFile::into_file)
            .and_then(|file| match file.try_lock() {
                Err(TryLockError::WouldBlock) => Err(io::ErrorKind::NotFound.into()),
                Ok(()) if !is_at(&file, &path.join(LOCK)) => Err(io::ErrorKind::NotFound.into()),
                // Where the file system knows no locks, nobody takes the folder for one that was left behind.
                Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
            });
        match lock {
            Ok(lock) => Ok(Self {
                path,
                lock: Some(lock),
            }),
            Err(error) => {
                let _ = fs::remove_file(path.join(LOCK));
                let _ = fs::remove_dir(&path);
                Err(error)
            }
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes it with all that is in it.
    ///
    /// # Errors
    /// What the system says.
    pub fn remove(self) -> io::Result<()> {
        let Self { path, mut lock } = self;
        let locked = path.join(LOCK);
        for (entry, is_folder) in disk::entries(&path)? {
            if is_folder {
                disk::remove_tree(&entry)?;
            } else if entry != locked {
                disk::remove_file(&entry)?;
            }
        }
        // Windows removes no file that is open; elsewhere nobody may lock it before it is gone.
        if cfg!(windows) {
            lock = None;
        }
        if locked.symlink_metadata().is_ok() {
            disk::remove_file(&locked)?;
        }
        drop(lock);
        disk::remove_dir(&path)
    }

    /// Takes the staging folders in `parent` that other processes left behind, for a target of a name; of an empty
    /// name for `parent` itself.
    ///
    /// # Errors
    /// What the system says when `parent` cannot be read.
    pub fn others(parent: &Path, target: &OsStr, own: Option<&Self>) -> io::Result<Others> {
        let parent = if parent.as_os_str().is_empty() {
            Path::new(".")
        } else {
            parent
        };
        let prefix = prefix(target);
        let mut others = Others::default();
        for entry in fs::read_dir(parent)? {
            let entry = entry?;
            let name = entry.file_name();
            let bytes = name.as_encoded_bytes();
            let is_named = bytes.len() == prefix.len() + RANDOM
                && bytes.starts_with(prefix.as_encoded_bytes());
            if !is_named
                || !entry.file_type()?.is_dir()
                || own.is_some_and(|own| own.path.file_name() == Some(&name))
            {
                continue;
            }
            match Self::claim(&entry.path(), target) {
                Claim::Free(folder) => others.left.push(folder),
                Claim::InUse => others.in_use = Some(entry.path()),
                Claim::NotOurs => {}
            }
        }
        others.left.sort_by(|one, other| one.path.cmp(&other.path));
        Ok(others)
    }

    /// Locks a folder that has the name of a staging folder.
    fn claim(path: &Path, target: &OsStr) -> Claim {
        let own = |lock| {
            Claim::Free(Self {
                path: path.to_owned(),
                lock,
            })
        };
        let Ok(entries) = disk::entries(path) else {
            return Claim::NotOurs;
        };
        let locked = path.join(LOCK);
        let is_file = locked.symlink_metadata().is_ok_and(|found| found.is_file());
        if !is_file {
            // Left between its making and its lock's.
            return if entries.is_empty() {
                own(None)
            } else {
                Claim::NotOurs
            };
        }
        // Network file systems lock only what may be written to.
        let Ok(mut file) = File::options().read(true).write(true).open(&locked) else {
            return Claim::NotOurs;
        };
        let mut text = Vec::new();
        let limit = marker(target).len() as u64 + 1;
        if (&mut file).take(limit).read_to_end(&mut text).is_err() {
            return Claim::NotOurs;
        }
        let is_marked =
            text == marker(target).as_bytes() || (text.is_empty() && entries.len() == 1);
        if !is_marked {
            return Claim::NotOurs;
        }
        match file.try_lock() {
            Ok(()) if is_at(&file, &locked) => own(Some(file)),
            // Without locks nobody knows whether it is in use.
            Ok(()) | Err(TryLockError::WouldBlock | TryLockError::Error(_)) => Claim::InUse,
        }
    }
}

/// A folder that has the name of a staging folder.
enum Claim {
    /// It was left behind, and is this process's now.
    Free(StagingFolder),
    /// Another process uses it.
    InUse,
    /// It is a user's.
    NotOurs,
}

/// Random letters at the end of a staging folder's name.
const RANDOM: usize = 12;

/// Beginning of the name of a target's staging folders.
fn prefix(target: &OsStr) -> OsString {
    let mut prefix = OsString::from(if target.is_empty() { "" } else { "." });
    if target.len() <= MAX_NAME {
        prefix.push(target);
    } else {
        // The marker has the whole name.
        let start: String = target
            .to_string_lossy()
            .chars()
            .take(MAX_NAME / 4)
            .collect();
        prefix.push(start);
    }
    prefix.push(".knotdock-");
    prefix
}

/// Content of the file that is locked.
fn marker(target: &OsStr) -> String {
    format!("{MARKER}\n{}\n", target.to_string_lossy())
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
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target() -> &'static OsStr {
        OsStr::new("run")
    }

    #[test]
    fn one_process_uses_a_folder_and_the_next_one_may_clear_it() {
        let root = tempfile::tempdir().unwrap();
        let folder = StagingFolder::create(root.path(), target()).unwrap();
        fs::write(folder.path().join("half"), "half").unwrap();
        let others = || StagingFolder::others(root.path(), target(), None).unwrap();
        assert!(others().in_use.is_some() && others().left.is_empty());
        let elsewhere = StagingFolder::others(root.path(), OsStr::new("ru"), None).unwrap();
        assert!(elsewhere.in_use.is_none() && elsewhere.left.is_empty());
        drop(folder); // as after a kill: the folder stays, the lock goes
        let Others { left, in_use } = others();
        assert!(in_use.is_none() && left.len() == 1);
        for folder in left {
            folder.remove().unwrap();
        }
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
    }

    /// Found by hostile calls: a folder of the staging folder's name was emptied, whoever made it.
    #[test]
    fn a_folder_of_such_a_name_that_is_not_marked_is_a_users() {
        let root = tempfile::tempdir().unwrap();
        let mine = root.path().join(".run.knotdock-abcdefghijkl");
        fs::create_dir(&mine).unwrap();
        let others = || StagingFolder::others(root.path(), target(), None).unwrap();
        for (file, text) in [("thesis", "mine"), (LOCK, "mine"), (LOCK, "")] {
            fs::write(mine.join(file), text).unwrap();
            let found = others();
            assert!(found.in_use.is_none() && found.left.is_empty(), "{file}");
        }
        // A folder marked for another target is another target's.
        fs::write(mine.join(LOCK), marker(OsStr::new("other"))).unwrap();
        assert!(others().left.is_empty());
        #[cfg(unix)]
        {
            let link = root.path().join(".run.knotdock-mnopqrstuvwx");
            std::os::unix::fs::symlink(&mine, link).unwrap();
            assert!(others().left.is_empty());
        }
        assert_eq!(fs::read_to_string(mine.join("thesis")).unwrap(), "mine");
    }

    /// A kill between the first two changes leaves an empty folder, or one with an empty lock.
    #[test]
    fn what_a_kill_left_at_once_is_cleared() {
        let root = tempfile::tempdir().unwrap();
        fs::create_dir(root.path().join(".run.knotdock-abcdefghijkl")).unwrap();
        let second = root.path().join(".run.knotdock-mnopqrstuvwx");
        fs::create_dir(&second).unwrap();
        fs::write(second.join(LOCK), "").unwrap();
        for folder in StagingFolder::others(root.path(), target(), None)
            .unwrap()
            .left
        {
            folder.remove().unwrap();
        }
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
    }

    #[test]
    fn long_names_fit() {
        let root = tempfile::tempdir().unwrap();
        let long = OsString::from("n".repeat(255));
        let folder = StagingFolder::create(root.path(), &long).unwrap();
        drop(folder);
        let left = StagingFolder::others(root.path(), &long, None)
            .unwrap()
            .left;
        assert_eq!(left.len(), 1);
    }
}
