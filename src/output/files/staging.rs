//! A run's directory: all of a new run or all of the older one.
//!
//! The directory is this program's: it is new or empty, or it holds an earlier run and nothing else. A run is written in a
//! folder beside it, `.NAME.knotdock-` and random letters, and takes its place by one rename when all of it is on the
//! device. An older run is exchanged for it at one stroke. If the system cannot exchange, the older one goes aside to
//! `.NAME.knotdock-old` first, and the next command puts it back if no new one came.

use crate::output::files::file_error;
use knotdock_structures::Error;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

use super::checksum::sha256_of_file;
use super::disk;
use super::lock::Lock;
use super::own_files::{MEMBERS, is_of_us, is_record, is_run, name_of, not_own};
use super::whole_file::{beside, is_link, leftovers, lock_beside, make_beside, parent, write_new};

/// A folder that this process alone writes to, until it takes its place. Dropped before that, it goes.
#[derive(Debug)]
pub struct Stage {
    folder: PathBuf,
    /// The final folder of its files, for messages.
    shown: PathBuf,
    /// Whether it stays.
    is_kept: bool,
}

impl Stage {
    /// A new folder beside a place.
    pub(super) fn beside(place: &Path, shown: &Path) -> Result<Self, Error> {
        let made = make_beside(place, disk::create_dir);
        let (_, path) = made.map_err(|source| file_error::unwritable(shown, source))?;
        let folder = path
            .keep()
            .map_err(|error| file_error::unwritable(shown, error))?;
        Ok(Self {
            folder,
            shown: shown.to_owned(),
            is_kept: false,
        })
    }

    /// The folder to write into.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Writes a file.
    ///
    /// # Errors
    /// [`Error`] for a file that cannot be written, with its final name.
    pub fn write(
        &self,
        name: &str,
        fill: impl FnOnce(&mut dyn io::Write) -> io::Result<()>,
    ) -> Result<(), Error> {
        write_new(&self.folder.join(name), fill)
            .map_err(|source| file_error::writing(&self.shown.join(name), source))
    }

    /// SHA-256 of each file written so far, by its path from the folder with `/` between folders. The record holds them
    /// as `files`. A folder of runs has its own records, and is left out.
    pub fn checksums(&self) -> Result<BTreeMap<String, String>, Error> {
        let failed = |source| file_error::writing(&self.shown, source);
        let mut checksums = BTreeMap::new();
        let files = disk::tree(&self.folder).map_err(failed)?;
        for path in files.iter().filter(|path| !path.starts_with(MEMBERS)) {
            let file = self.folder.join(path);
            if file.is_file() {
                checksums.insert(name_of(path), sha256_of_file(&file).map_err(failed)?);
            }
        }
        Ok(checksums)
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        // The next command reports a folder that stays.
        if !self.is_kept {
            let _ = disk::remove_tree(&self.folder);
        }
    }
}

/// Folders that a command made. Dropped, those that are empty go.
#[derive(Debug, Default)]
pub(super) struct NewFolders(pub Vec<PathBuf>);

impl Drop for NewFolders {
    fn drop(&mut self) {
        for folder in self.0.iter().rev() {
            let _ = disk::remove_dir(folder);
        }
    }
}

/// A run's directory while the run goes on: files are written into the stage and appear all together on
/// [`Staging::commit`]. Dropped before that, it leaves the directory as it was.
#[derive(Debug)]
pub struct Staging {
    record: &'static str,
    /// As the user named it.
    directory: PathBuf,
    /// Without links.
    place: PathBuf,
    stage: Stage,
    /// Leftovers of ended commands beside the directory.
    pub leftovers: Vec<PathBuf>,
    _lock: Lock,
    _made: NewFolders,
}

impl Staging {
    /// Makes a staging folder for a run with a record, such as `run.json`, which also shows that it can be written.
    ///
    /// # Errors
    /// [`Error`] if the directory holds a run and `force` is false, if it holds anything else, if another command writes to
    /// it, and if nothing can be written there.
    pub fn open(record: &'static str, directory: &Path, force: bool) -> Result<Self, Error> {
        let (place, made, lock) = locked(directory)?;
        if place.is_dir() && (holds_current(&place) || !is_one_device(&place, parent(&place))) {
            return Err(current(directory));
        }
        refuse(record, directory, &place, force)?;
        Ok(Self {
            record,
            directory: directory.to_owned(),
            leftovers: leftovers(&place),
            stage: Stage::beside(&place, directory)?,
            place,
            _lock: lock,
            _made: made,
        })
    }

    /// The folder to write to.
    pub fn stage(&self) -> &Stage {
        &self.stage
    }

    /// Moves the files into the run's directory, in place of an older run, once they are on the device.
    ///
    /// # Errors
    /// [`Error`]. An older run is then in its place or aside; if it has got files that are not its own, the new run stays
    /// beside it.
    pub fn commit(mut self) -> Result<(), Error> {
        let (new, place) = (self.stage.folder.clone(), self.place.as_path());
        let failed = |source| file_error::writing(&self.directory, source);
        let there = place.symlink_metadata();
        if let Ok(there) = &there {
            disk::set_permissions(&new, there.permissions()).map_err(failed)?;
        }
        disk::sync_tree(&new).map_err(failed)?;
        let older = refuse(self.record, &self.directory, place, true).map_err(|error| {
            self.stage.is_kept = true;
            error.and(format!("the new run is in {}", new.display()))
        })?;
        let Some(older) = older else {
            // An empty directory goes first; one that is not empty any more does not.
            if place.is_dir() {
                disk::remove_dir(place).map_err(failed)?;
            }
            disk::rename_new(&new, place).map_err(failed)?;
            return disk::sync(parent(place)).map_err(failed);
        };
        let aside = replace(&new, place).map_err(failed)?;
        // Files that the older run has got since are the user's.
        self.stage.is_kept = true;
        // It goes only when the new one is on the device. The next command reports remains.
        if disk::sync(parent(place)).is_ok() {
            remove(&aside, older);
        }
        Ok(())
    }
}

/// Puts a new folder in the place of an older one; returns the new place of that.
fn replace(new: &Path, place: &Path) -> io::Result<PathBuf> {
    match disk::exchange(new, place) {
        Ok(()) => return Ok(new.to_owned()),
        Err(error) if disk::is_unsupported(&error) => {}
        Err(error) => return Err(error),
    }
    let aside = aside(place);
    let taken =
        |source: io::Error| io::Error::new(source.kind(), format!("{}: {source}", aside.display()));
    disk::rename_new(place, &aside).map_err(taken)?;
    if let Err(error) = disk::rename_new(new, place) {
        // If this fails, too, the next command does it.
        let _ = disk::rename_new(&aside, place);
        return Err(error);
    }
    Ok(aside)
}

/// Removes files from a folder, and the folders that are empty then. Records go last: they list the others.
fn remove(folder: &Path, mut files: Vec<PathBuf>) {
    let mut folders: BTreeSet<&Path> = BTreeSet::new();
    files.sort_by_key(|path| (is_record(path), path.components().count() == 1));
    for file in &files {
        match folder.join(file).is_dir() {
            true => folders.extend(file.ancestors()),
            false => {
                let _ = disk::remove_file(&folder.join(file));
                folders.extend(file.ancestors().skip(1));
            }
        }
    }
    folders.insert(Path::new(""));
    for inner in folders.iter().rev() {
        let _ = disk::remove_dir(&folder.join(inner));
    }
}

/// Place of an older run between two renames.
fn aside(place: &Path) -> PathBuf {
    beside(place, "old")
}

/// A run's directory without links, the folders made above it, and its lock. An older run that a kill left aside is put
/// back, or goes if a new one has come.
pub(super) fn locked(directory: &Path) -> Result<(PathBuf, NewFolders, Lock), Error> {
    let unwritable = |source: io::Error| file_error::unwritable(directory, source);
    // Without `/` at the end, which would follow a link.
    let plain: PathBuf = directory.components().collect();
    if is_link(&plain) {
        return Err(file_error::link(directory));
    }
    let (above, name) = match plain.file_name() {
        Some(name) => (parent(&plain).to_owned(), name.to_owned()),
        // `.` and `..`.
        None => {
            let whole = plain.canonicalize().map_err(unwritable)?;
            match (whole.parent(), whole.file_name()) {
                (Some(above), Some(name)) => (above.to_owned(), name.to_owned()),
                _ => return Err(current(directory)),
            }
        }
    };
    let made = NewFolders(disk::create_dir_all(&above).map_err(unwritable)?);
    let place = above.canonicalize().map_err(unwritable)?.join(name);
    let lock = Lock::take(&lock_beside(&place))?;
    let aside = aside(&place);
    let is_there = place.symlink_metadata().is_ok();
    if is_link(&aside) {
        return Ok((place, made, lock));
    }
    if !is_there && is_run(&aside) {
        disk::rename_new(&aside, &place).map_err(unwritable)?;
    } else if is_there && aside.is_dir() {
        // The new run is in place. The older one's own files go, with folders that are empty then.
        let files = disk::tree(&aside).map_err(unwritable)?;
        let others = not_own(&aside, &files).map_err(unwritable)?;
        let is_own = |path: &PathBuf| !others.contains(path) || aside.join(path).is_dir();
        remove(&aside, files.into_iter().filter(is_own).collect());
    }
    Ok((place, made, lock))
}

/// Puts an older run back that a kill left aside, so that its directory can be read.
pub fn put_back(directory: &Path) -> Result<(), Error> {
    let lock = lock_beside(directory);
    if lock.symlink_metadata().is_ok() {
        // A lock that a kill left goes; one that is held stays, as any other file of the name.
        drop(Lock::take(&lock));
    }
    let is_aside = directory.symlink_metadata().is_err() && aside(directory).is_dir();
    is_aside.then(|| locked(directory)).transpose().map(drop)
}

fn current(directory: &Path) -> Error {
    file_error::refused(
        directory,
        "the current directory and the root of a file system cannot be the directory of a run, which is replaced as a \
         whole",
        "name a folder in it, such as -o run",
    )
}

fn holds_current(place: &Path) -> bool {
    let current = std::env::current_dir().and_then(|current| current.canonicalize());
    current.is_ok_and(|current| current.starts_with(place))
}

/// Refuses a directory without a run, and one with a run unless `force` is true; returns the files of the run.
fn refuse(
    record: &str,
    directory: &Path,
    place: &Path,
    force: bool,
) -> Result<Option<Vec<PathBuf>>, Error> {
    let unreadable = |source: io::Error| file_error::unwritable(directory, source);
    if place.symlink_metadata().is_err() || disk::entries(place).map_err(unreadable)?.is_empty() {
        return Ok(None);
    }
    let refused =
        |message: String, remedy: &str| Err(file_error::refused(directory, message, remedy));
    if !is_of_us(&place.join(record)) {
        return refused(
            format!("the directory is not empty and holds no run of knotdock with {record}"),
            "choose another directory with -o",
        );
    }
    if !force {
        return refused(
            "the directory already holds a run".to_owned(),
            "choose another directory with -o, or pass --force to replace the run",
        );
    }
    let files = disk::tree(place).map_err(unreadable)?;
    let others = not_own(place, &files).map_err(unreadable)?;
    if others.is_empty() {
        return Ok(Some(files));
    }
    let shown: Vec<String> = others.iter().take(3).map(|path| name_of(path)).collect();
    let (names, more) = (
        shown.join(", "),
        ["", " ..."][usize::from(others.len() > shown.len())],
    );
    refused(
        format!(
            "the directory holds files that are not the run's own, or were edited: {names}{more}"
        ),
        "move them away, or choose another directory with -o",
    )
}

/// Whether two folders are on one file system.
#[cfg(unix)]
fn is_one_device(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let device = |path: &Path| path.metadata().map(|found| found.dev()).ok();
    device(one) == device(other)
}

/// Whether two folders are on one file system: there a folder beside another is.
#[cfg(not(unix))]
fn is_one_device(_: &Path, _: &Path) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::super::own_files::{RUN, TRADEOFF};
    use super::*;
    use std::fs;

    fn run(directory: &Path, text: &str) -> Result<(), Error> {
        let staging = Staging::open(RUN, directory, true)?;
        let stage = staging.stage();
        disk::create_dir(&stage.folder().join("top")).unwrap();
        for name in ["top/rank_0001.pdb", "poses.csv"] {
            stage.write(name, |file| file.write_all(text.as_bytes()))?;
        }
        let record = serde_json::json!({ "program": "knotdock", "files": stage.checksums()? });
        stage.write(RUN, |file| file.write_all(record.to_string().as_bytes()))?;
        staging.commit()
    }

    fn text(path: &Path) -> String {
        fs::read_to_string(path).unwrap()
    }

    /// Files of a folder, in order.
    fn files(folder: &Path) -> Vec<String> {
        let files = disk::tree(folder).unwrap().into_iter();
        files.map(|path| name_of(&path)).collect()
    }

    #[test]
    fn a_failed_run_loses_nothing_and_leaves_nothing() {
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("all/runs/run");
        drop(Staging::open(RUN, &directory, false).unwrap());
        assert_eq!(files(root.path()), [""; 0], "folders made for nothing go");
        run(&directory, "first").unwrap();
        drop(Staging::open(RUN, &directory, true).unwrap());
        assert_eq!(text(&directory.join("poses.csv")), "first");
        run(&directory, "second").unwrap();
        assert_eq!(text(&directory.join("top/rank_0001.pdb")), "second");
        let all = ["poses.csv", "run.json", "top/rank_0001.pdb"];
        assert_eq!(
            files(root.path()),
            all.map(|name| format!("all/runs/run/{name}"))
        );
    }

    /// A run replaces only a run, on request, and no user's file in it.
    #[test]
    fn what_is_not_a_runs_own_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("run");
        fs::create_dir(&directory).unwrap();
        run(&directory, "first").unwrap();
        assert!(Staging::open(RUN, &directory, false).is_err());
        assert!(Staging::open(TRADEOFF, &directory, true).is_err());
        for (name, shown) in [
            ("notes.txt", "notes.txt"),
            ("top/rank_0001.pdb", "top/rank_0001.pdb"),
        ] {
            let file = directory.join(name);
            let before = fs::read(&file).ok();
            fs::write(&file, "mine").unwrap();
            let error = run(&directory, "second").unwrap_err().to_string();
            assert!(error.ends_with(&format!("edited: {shown}")), "{error}");
            assert_eq!(text(&file), "mine");
            match before {
                Some(before) => fs::write(&file, before).unwrap(),
                None => fs::remove_file(&file).unwrap(),
            }
        }
        run(&directory, "second").unwrap();
        for torn in ["", "\0\0\0", "{\"program\": \"knotdock\", \"fi"] {
            fs::write(directory.join(RUN), torn).unwrap();
            assert!(run(&directory, "third").unwrap_err().is_input());
        }
        assert_eq!(text(&directory.join("poses.csv")), "second");
    }

    /// What comes to an older run while the new one is made is kept, and so is the new one.
    #[test]
    fn what_comes_in_the_meantime_stays() {
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("run");
        run(&directory, "first").unwrap();
        let staging = Staging::open(RUN, &directory, true).unwrap();
        staging
            .stage()
            .write("poses.csv", |file| file.write_all(b"new"))
            .unwrap();
        fs::write(directory.join("notes.txt"), "mine").unwrap();
        let error = staging.commit().unwrap_err().to_string();
        let (_, kept) = error.rsplit_once("the new run is in ").unwrap();
        assert_eq!(text(&Path::new(kept).join("poses.csv")), "new");
        assert_eq!(leftovers(&directory), [PathBuf::from(kept)]);
        assert_eq!(text(&directory.join("notes.txt")), "mine");
    }

    /// A kill between two renames leaves the older run aside.
    #[test]
    fn an_older_run_that_is_aside_is_put_back() {
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("run");
        run(&directory, "first").unwrap();
        let old = root.path().join(".run.knotdock-old");
        fs::rename(&directory, &old).unwrap();
        put_back(&directory).unwrap();
        assert_eq!(text(&directory.join("poses.csv")), "first");
        // A user's folder of this name is none.
        fs::remove_dir_all(&directory).unwrap();
        fs::create_dir(&old).unwrap();
        put_back(&directory).unwrap();
        assert!(old.exists() && !directory.exists());
    }

    /// Found by hostile calls: a link of the staging folder's name led to a folder that was then emptied.
    #[cfg(unix)]
    #[test]
    fn no_link_is_followed() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        run(&at("mine"), "first").unwrap();
        for (link, to) in [
            ("run", "mine"),
            (".other.knotdock-lock", "mine/poses.csv"),
            (".third.knotdock-old", "mine"),
        ] {
            symlink(at(to), at(link)).unwrap();
        }
        assert!(run(&at("run"), "second").is_err());
        assert!(run(&at("run/"), "second").is_err());
        assert!(run(&at("other"), "second").is_err());
        run(&at("third"), "second").unwrap();
        assert_eq!(text(&at("mine/poses.csv")), "first");
        assert_eq!(text(&at("third/poses.csv")), "second");
        // Links above are the user's way there.
        fs::create_dir(at("far")).unwrap();
        symlink(at("far"), at("near")).unwrap();
        run(&at("near/run"), "second").unwrap();
        assert_eq!(text(&at("far/run/poses.csv")), "second");
    }
}
