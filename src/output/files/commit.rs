//! The commit of a run: its files take their places, and those of an older run go.
//!
//! Where the directory holds nothing but an older run, the new folder and the directory are exchanged at one stroke.
//! Where it holds files of the user's, or the system cannot exchange, a journal is written first. It names the files
//! that go and those that come. A commit that was interrupted is finished by [`finish`] when the directory is next
//! used. Files that a user has changed, or has put in the way, are set aside under a name of their own.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::checksum::sha256_of_file;
use super::disk;
use super::own_files::{Found, OwnFiles, survey};
use super::product::Product;
use super::staging_folder::StagingFolder;
use super::whole_file::{parent, write_new};

/// Names in a staging folder: the new run, the files that it replaces, the journal, and the note of an exchange.
pub(super) const NEW: &str = "new";
const OLD: &str = "old";
const JOURNAL: &str = "commit.json";
const EXCHANGED: &str = "exchanged";

/// A file of the user's that was in the way of a run, and its name now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetAside {
    /// Where it was.
    pub from: PathBuf,
    /// Where it is.
    pub to: PathBuf,
}

/// A commit that is done.
#[derive(Debug, Default)]
pub(super) struct Committed {
    /// Files of the user's that were in the way.
    pub set_aside: Vec<SetAside>,
    /// Whether the staging folder holds something of the older run, which the next run has to clear.
    pub is_left: bool,
}

/// What a commit does, in paths from the directory.
#[derive(Debug, Serialize, Deserialize)]
struct Journal {
    /// Files of the older run that go, with their checksums.
    replaced: BTreeMap<PathBuf, String>,
    /// Files that come.
    placed: Vec<PathBuf>,
}

/// Why a commit came to nothing.
#[derive(Debug)]
pub(super) struct CommitError {
    /// The file in question.
    pub path: PathBuf,
    /// The system's message.
    pub source: io::Error,
    /// Whether the directory is as it was. Else the staging folder must stay.
    pub undone: bool,
}

impl CommitError {
    fn undone(path: &Path, source: io::Error) -> Self {
        Self {
            path: path.to_owned(),
            source,
            undone: true,
        }
    }
}

/// Puts the new folder of `staging` in the place of `directory`, in which only files in `own` are replaced. With
/// `beside` the staging folder lies beside the directory, which then may be exchanged or not be there.
pub(super) fn commit(
    product: &Product,
    staging: &StagingFolder,
    directory: &Path,
    own: OwnFiles,
    beside: bool,
) -> Result<Committed, CommitError> {
    let new = staging.path().join(NEW);
    let failed = |source| CommitError::undone(directory, source);
    keep_modes(&new, directory).map_err(failed)?;
    disk::sync_tree(&new).map_err(failed)?;
    disk::sync(staging.path()).map_err(failed)?;
    if beside {
        if rename_whole(&new, directory).map_err(failed)? {
            return Ok(Committed::default());
        }
        if own.are_all_of(product, directory).map_err(failed)?
            && let Some(done) = exchange_whole(product, staging, directory).map_err(failed)?
        {
            return Ok(done);
        }
    }
    let journal = Journal {
        replaced: own.0,
        placed: disk::tree(&new).map_err(failed)?,
    };
    write_journal(staging.path(), &journal).map_err(failed)?;
    let set_aside = apply(staging.path(), directory, &journal, true)?;
    Ok(Committed {
        set_aside,
        is_left: false,
    })
}

/// Finishes or undoes what an interrupted process left in a staging folder of a directory, and removes the folder.
pub(super) fn finish(
    product: &Product,
    staging: StagingFolder,
    directory: &Path,
) -> io::Result<Vec<SetAside>> {
    let folder = staging.path().to_owned();
    let mut set_aside = Vec::new();
    if let Some(journal) = read_journal(&folder)? {
        set_aside = apply(&folder, directory, &journal, false).map_err(|error| error.source)?;
    } else if folder.join(EXCHANGED).exists() && folder.join(NEW).is_dir() {
        set_aside = retire(product, &folder.join(NEW), directory)?;
    }
    staging.remove()?;
    Ok(set_aside)
}

/// Whether an interrupted commit is to be finished in a staging folder.
pub(super) fn is_committing(staging: &StagingFolder) -> bool {
    [JOURNAL, EXCHANGED]
        .iter()
        .any(|name| staging.path().join(name).exists())
}

/// Gives the directory's mode, and those of files that are replaced, to the new ones.
fn keep_modes(new: &Path, directory: &Path) -> io::Result<()> {
    let own = |path: PathBuf| (new.join(&path), directory.join(path));
    let files = disk::tree(new)?.into_iter().map(own);
    for (file, replaced) in files.chain([(new.to_owned(), directory.to_owned())]) {
        let (Ok(there), Ok(made)) = (replaced.symlink_metadata(), file.symlink_metadata()) else {
            continue;
        };
        let is_like = there.is_file() == made.is_file() && there.is_dir() == made.is_dir();
        if is_like && there.permissions() != made.permissions() {
            disk::set_permissions(&file, there.permissions())?;
        }
    }
    Ok(())
}

/// Moves a new folder to where no directory is; whether there was none.
fn rename_whole(new: &Path, directory: &Path) -> io::Result<bool> {
    if directory.symlink_metadata().is_ok() {
        return Ok(false);
    }
    match disk::rename_new(new, directory) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => return Ok(false),
        done => done?,
    }
    // The run stands, whatever the device says of its folder.
    let _ = disk::sync(parent(directory));
    Ok(true)
}

/// Exchanges a new folder and a directory that holds only an older run; `None` where the system cannot.
fn exchange_whole(
    product: &Product,
    staging: &StagingFolder,
    directory: &Path,
) -> io::Result<Option<Committed>> {
    let (new, note) = (staging.path().join(NEW), staging.path().join(EXCHANGED));
    // From here on the folder may hold the older run, with what a user has just added to it.
    write_new(&note, |_| Ok(()))?;
    disk::sync(staging.path())?;
    if disk::exchange(&new, directory).is_err() {
        disk::remove_file(&note)?;
        return Ok(None);
    }
    // The new run stands. The older one goes only when the exchange is on the device. What is left of it is cleared
    // by the next run, should this fail.
    let retired = disk::sync(parent(directory)).and_then(|()| retire(product, &new, directory));
    Ok(Some(Committed {
        is_left: retired.is_err(),
        set_aside: retired.unwrap_or_default(),
    }))
}

/// Removes an older run from a folder. What is not its own goes to the directory. The record goes last, so that this
/// can be done again after an interruption.
fn retire(product: &Product, old: &Path, directory: &Path) -> io::Result<Vec<SetAside>> {
    let own = match survey(product, old)? {
        Found::Run(own) | Found::Broken(own) => own,
        Found::Nothing | Found::Foreign(_) => OwnFiles::default(),
    };
    let record = Path::new(product.record);
    let mut set_aside = Vec::new();
    for path in disk::tree(old)? {
        let is_folder = product.folder.is_some_and(|name| path == Path::new(name));
        if is_folder || own.0.contains_key(&path) {
            continue;
        }
        let to = directory.join(&path);
        disk::create_dir_all(parent(&to))?;
        let to = if to.symlink_metadata().is_ok() {
            free_name(&to)
        } else {
            to
        };
        disk::rename_new(&old.join(&path), &to)?;
        set_aside.push(SetAside {
            from: directory.join(&path),
            to,
        });
    }
    for path in own.0.keys().filter(|path| *path != record) {
        disk::remove_file(&old.join(path))?;
    }
    if own.0.contains_key(record) {
        disk::remove_file(&old.join(record))?;
    }
    set_aside.retain(|moved| moved.from != moved.to);
    Ok(set_aside)
}

/// Writes the journal, whole and to the device.
fn write_journal(staging: &Path, journal: &Journal) -> io::Result<()> {
    let (file, half) = (staging.join(JOURNAL), staging.join("commit.half"));
    write_new(&half, |to| Ok(serde_json::to_writer(to, journal)?))?;
    disk::sync(&half)?;
    disk::rename_new(&half, &file)?;
    disk::sync(staging)
}

/// Reads the journal, if there is one.
fn read_journal(staging: &Path) -> io::Result<Option<Journal>> {
    match fs::read(staging.join(JOURNAL)) {
        Ok(bytes) => Ok(Some(serde_json::from_slice(&bytes)?)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// Moves of files that were made, and how to take them back.
#[derive(Default)]
struct Moves {
    done: Vec<(PathBuf, PathBuf)>,
    /// Folders that were made for them.
    made: Vec<PathBuf>,
}

impl Moves {
    fn make(&mut self, from: PathBuf, to: PathBuf) -> Result<(), (PathBuf, io::Error)> {
        let failed = |source| (to.clone(), source);
        self.made
            .extend(disk::create_dir_all(parent(&to)).map_err(failed)?);
        disk::rename_new(&from, &to).map_err(failed)?;
        self.done.push((from, to));
        Ok(())
    }

    /// Takes the moves back; whether all could be.
    fn undo(self) -> bool {
        let mut all = true;
        for (from, to) in self.done.iter().rev() {
            all &= disk::rename_new(to, from).is_ok();
        }
        for folder in self.made.iter().rev() {
            let _ = disk::remove_dir(folder);
        }
        all
    }
}

/// Makes the moves of a journal, or those of them that are still to be made. With `undo` all are taken back when one
/// fails.
fn apply(
    staging: &Path,
    directory: &Path,
    journal: &Journal,
    undo: bool,
) -> Result<Vec<SetAside>, CommitError> {
    let mut moves = Moves::default();
    let done = move_files(staging, directory, journal, &mut moves);
    let failure = match done {
        Ok(set_aside) => return Ok(set_aside),
        Err(failure) => failure,
    };
    let (path, source) = failure;
    let undone = undo && moves.undo() && disk::remove_file(&staging.join(JOURNAL)).is_ok();
    Err(CommitError {
        path,
        source,
        undone,
    })
}

fn move_files(
    staging: &Path,
    directory: &Path,
    journal: &Journal,
    moves: &mut Moves,
) -> Result<Vec<SetAside>, (PathBuf, io::Error)> {
    let (new, old) = (staging.join(NEW), staging.join(OLD));
    let is_there = |path: &Path| path.symlink_metadata().is_ok();
    let mut set_aside = Vec::new();
    for (path, checksum) in &journal.replaced {
        let from = directory.join(path);
        let is_placed = journal.placed.contains(path) && !is_there(&new.join(path));
        // A user may have changed it since the journal was written.
        if !is_placed && sha256_of_file(&from).is_ok_and(|found| found == *checksum) {
            moves.make(from, old.join(path))?;
        }
    }
    for path in &journal.placed {
        let (from, to) = (new.join(path), directory.join(path));
        if !is_there(&from) {
            continue;
        }
        if is_there(&to) {
            let aside = free_name(&to);
            moves.make(to.clone(), aside.clone())?;
            set_aside.push(SetAside {
                from: to.clone(),
                to: aside,
            });
        }
        moves.make(from, to)?;
    }
    let folders = journal.replaced.keys().chain(&journal.placed);
    let mut folders: Vec<PathBuf> = folders
        .filter_map(|path| path.parent())
        .filter(|folder| !folder.as_os_str().is_empty())
        .map(|folder| directory.join(folder))
        .collect();
    folders.dedup();
    for folder in folders.into_iter().filter(|folder| folder.is_dir()) {
        // Only a folder in which nothing is left goes.
        let is_empty = disk::entries(&folder).is_ok_and(|entries| entries.is_empty());
        let synced = if is_empty {
            disk::remove_dir(&folder)
        } else {
            disk::sync(&folder)
        };
        synced.map_err(|source| (folder, source))?;
    }
    disk::sync(directory).map_err(|source| (directory.to_owned(), source))?;
    Ok(set_aside)
}

/// A name beside a file that nothing has: `poses.kept.csv`, `poses.kept-2.csv` ...
fn free_name(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path
        .extension()
        .map(|ending| format!(".{}", ending.to_string_lossy()))
        .unwrap_or_default();
    let names = (1u32..).map(|number| match number {
        1 => format!("{stem}.kept{ending}"),
        _ => format!("{stem}.kept-{number}{ending}"),
    });
    let mut names = names.map(|name| path.with_file_name(name));
    let is_free = |name: &PathBuf| name.symlink_metadata().is_err();
    names.find(is_free).unwrap_or_else(|| path.to_owned())
}
