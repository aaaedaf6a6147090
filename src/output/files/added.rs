//! Files added to a run that is there, or to another folder.
//!
//! They are written in a separate folder first, and each takes its place by one rename when all of them are on the device.
//! A file with the same content stays. One that differs is replaced if the run's records show that nobody has changed it,
//! or on request. The `added.json` of a run lists its additions.

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use knotdock_structures::Error;
use serde_json::{Value, json};

use crate::bounded_read::{MAX_RECORD, read_bounded_file};

use super::checksum::sha256_of_file;
use super::lock::Lock;
use super::own_files::{ADDED, ENSEMBLE, OwnFiles, is_of_us, is_run, name_of};
use super::seal::REPORT;
use super::staging::{NewFolders, Stage, locked};
use super::whole_file::{is_link, leftovers, parent, to_json, write_whole};
use super::{disk, file_error};

/// Files that are being added.
#[derive(Debug)]
pub struct Addition {
    /// Their folder.
    folder: PathBuf,
    stage: Stage,
    /// The run that the folder is in, without links.
    run: Option<PathBuf>,
    /// Leftovers of ended commands beside the run or the folder.
    pub leftovers: Vec<PathBuf>,
    _lock: Option<Lock>,
    made: NewFolders,
}

impl Addition {
    /// Files for a folder. If it is in the directory of `run`, that is locked.
    ///
    /// # Errors
    /// [`Error`] for a folder that is a link or cannot be made, and if another command writes to the run.
    pub fn open(folder: &Path, run: Option<&Path>) -> Result<Self, Error> {
        let plain: PathBuf = folder.components().collect();
        if is_link(&plain) {
            return Err(file_error::link(folder));
        }
        let unwritable = |source: io::Error| file_error::unwritable(folder, source);
        let run = run.filter(|run| match (resolved(&plain), resolved(run)) {
            (Some(folder), Some(run)) => folder.starts_with(run),
            _ => false,
        });
        let (mut place, mut made, mut lock) = (None, NewFolders::default(), None);
        if let Some(run) = run {
            let (found, above, held) = locked(run)?;
            (place, made, lock) = (Some(found), above, Some(held));
        }
        let new = disk::create_dir_all(&plain).map_err(unwritable)?;
        made.0.extend(new);
        // Beside a run, so that nothing but a run's files is ever in it.
        let inner = plain.join("files");
        let beside = place.as_deref().unwrap_or(&inner);
        Ok(Self {
            leftovers: leftovers(beside),
            stage: Stage::beside(beside, folder)?,
            folder: plain,
            run: place,
            _lock: lock,
            made,
        })
    }

    /// The folder to write to.
    pub fn stage(&self) -> &Stage {
        &self.stage
    }

    /// Moves the files into their places. With `force` those that were edited are replaced, too.
    ///
    /// # Errors
    /// [`Error`]; for files that must not be replaced, before anything is moved.
    pub fn place(mut self, force: bool) -> Result<(), Error> {
        let failed = |source| file_error::writing(&self.folder, source);
        let new = self.stage.folder();
        disk::sync_tree(new).map_err(failed)?;
        let mut own = OwnFiles::default();
        let mut inside = PathBuf::new();
        if let Some(run) = &self.run {
            own.add(run, Path::new("")).map_err(failed)?;
            let folder = self.folder.canonicalize().map_err(failed)?;
            inside = folder.strip_prefix(run).unwrap_or(Path::new("")).to_owned();
        }
        let mut moves = Vec::new();
        let mut added = BTreeMap::new();
        for name in disk::tree(new).map_err(failed)? {
            let (from, to) = (new.join(&name), self.folder.join(&name));
            let checksum = sha256_of_file(&from).map_err(failed)?;
            let in_run = inside.join(&name);
            let is_own = |run: &PathBuf| own.holds(run, &in_run).unwrap_or(false);
            let may_replace = force || self.run.as_ref().is_some_and(is_own);
            if is_to_move(&to, &checksum, may_replace)? {
                moves.push((from, to));
            }
            // A report has its own seal; with its times it would differ from call to call.
            if name != Path::new(REPORT) {
                added.insert(name_of(&in_run), checksum);
            }
        }
        // An ensemble that is not finished has no record yet; its record will list these.
        if let Some(run) = &self.run
            && !moves.is_empty()
            && is_run(run)
        {
            self.note(run, added)?;
        }
        // A record comes last: it shows that all files are there.
        moves.sort_by_key(|(_, to)| to.file_name() == Some(ENSEMBLE.as_ref()));
        for (from, to) in &moves {
            move_to(from, to).map_err(|source| file_error::writing(to, source))?;
        }
        self.made.0.clear();
        Ok(())
    }

    /// Adds files to the list of a run's additions. It comes before them: a listed file that is missing does no harm.
    fn note(&self, run: &Path, added: BTreeMap<String, String>) -> Result<(), Error> {
        let path = run.join(ADDED);
        if path.symlink_metadata().is_ok() && !is_of_us(&path) {
            let message = "this is no list of what was added to a run";
            return Err(file_error::refused(&path, message, "move it away"));
        }
        let earlier = read_bounded_file(&path, MAX_RECORD).unwrap_or_default();
        let earlier: Value = serde_json::from_slice(&earlier).unwrap_or_default();
        let mut files: BTreeMap<String, Value> = BTreeMap::new();
        for (name, sum) in earlier["files"].as_object().into_iter().flatten() {
            files.insert(name.clone(), sum.clone());
        }
        files.extend(added.into_iter().map(|(name, sum)| (name, sum.into())));
        let record = json!({ "program": "knotdock", "files": files });
        self.stage.write(ADDED, |stream| to_json(stream, &record))?;
        let written = self.stage.folder().join(ADDED);
        disk::sync(&written)
            .and_then(|()| disk::rename(&written, &path))
            .map_err(|source| file_error::writing(&path, source))
    }
}

/// Moves a file, to the device, into its place; one that is replaced leaves its mode.
fn move_to(from: &Path, to: &Path) -> io::Result<()> {
    disk::create_dir_all(parent(to))?;
    match to.symlink_metadata() {
        Ok(there) => {
            disk::set_permissions(from, there.permissions())?;
            disk::rename(from, to)?;
        }
        Err(_) => disk::rename_new(from, to)?,
    }
    disk::sync(parent(to))
}

/// Writes a file that the user named, whole; into a run's directory as an addition. Returns the leftovers of ended commands
/// there.
pub fn write_named(
    path: &Path,
    fill: impl FnOnce(&mut dyn io::Write) -> io::Result<()>,
) -> Result<Vec<PathBuf>, Error> {
    let folder = parent(path);
    let (Some(name), true) = (path.file_name(), is_run(folder) && !is_link(path)) else {
        return write_whole(path, fill).map(|()| Vec::new());
    };
    let mut addition = Addition::open(folder, Some(folder))?;
    addition.stage.write(&name.to_string_lossy(), fill)?;
    let leftovers = std::mem::take(&mut addition.leftovers);
    addition.place(true).map(|()| leftovers)
}

/// Copies files into a run's directory as additions.
pub fn add_files(run: &Path, files: &[PathBuf]) -> Result<(), Error> {
    let addition = Addition::open(run, Some(run))?;
    for path in files {
        let mut file = File::open(path).map_err(|source| file_error::reading(path, source))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let copied = |copy: &mut dyn io::Write| io::copy(&mut file, copy).map(drop);
        addition.stage.write(&name, copied)?;
    }
    addition.place(false)
}

/// A path without links, as far as it exists.
fn resolved(path: &Path) -> Option<PathBuf> {
    let whole = std::path::absolute(path).ok()?;
    whole.ancestors().find_map(|above| {
        let rest = whole.strip_prefix(above).ok()?;
        Some(above.canonicalize().ok()?.join(rest))
    })
}

/// Whether a file with a checksum is to be moved to a place: not if it is there already.
fn is_to_move(to: &Path, checksum: &str, may_replace: bool) -> Result<bool, Error> {
    let Ok(there) = to.symlink_metadata() else {
        return Ok(true);
    };
    if !there.is_file() {
        return Err(file_error::refused(
            to,
            format!("{} is there and is no regular file", to.display()),
            "move it away, or choose another directory with -o",
        ));
    }
    let found = sha256_of_file(to).map_err(|source| file_error::unwritable(to, source))?;
    if found != checksum && !may_replace {
        return Err(file_error::refused(
            to,
            format!("{} is there and is not what would be written", to.display()),
            "move the file away, choose another directory with -o, or pass --force to replace it",
        ));
    }
    Ok(found != checksum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn add(folder: &Path, text: &str, force: bool) -> Result<(), Error> {
        let addition = Addition::open(folder, None)?;
        let stage = addition.stage();
        stage.write("rank_0001.pdb", |file| file.write_all(text.as_bytes()))?;
        stage.write("rank_0002.pdb", |file| file.write_all(b"second"))?;
        addition.place(force)
    }

    fn names(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    /// Found by hostile calls: a complex that a user had edited was overwritten, and one behind a link.
    #[test]
    fn a_changed_complex_or_a_link_is_not_overwritten() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("new/out");
        add(&folder, "first", false).unwrap();
        add(&folder, "first", false).unwrap();
        let first = folder.join("rank_0001.pdb");
        fs::write(&first, "edited").unwrap();
        fs::remove_file(folder.join("rank_0002.pdb")).unwrap();
        assert!(add(&folder, "first", false).unwrap_err().is_input());
        assert_eq!(fs::read_to_string(&first).unwrap(), "edited");
        assert_eq!(names(&folder), 1, "nothing is moved before all are checked");
        add(&folder, "first", true).unwrap();
        assert_eq!(fs::read_to_string(&first).unwrap(), "first");
        assert_eq!(names(&folder), 2);
        #[cfg(unix)]
        {
            fs::remove_file(&first).unwrap();
            std::os::unix::fs::symlink(root.path().join("thesis"), &first).unwrap();
            for force in [false, true] {
                assert!(add(&folder, "first", force).unwrap_err().is_input());
            }
            assert!(!root.path().join("thesis").exists());
        }
    }
}
