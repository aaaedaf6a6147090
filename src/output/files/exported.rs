//! Complexes exported into a folder, where others may be already.
//!
//! They are written in a staging folder there and moved into place when all of them are on the device. A file that is
//! there stays if it has the same content. It is replaced if the run's records show that nobody has changed it since,
//! or on request. A link is never followed or replaced. In a run's own folder of complexes, `exported.json` lists
//! those that were exported, with their checksums.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::bounded_read::{MAX_RECORD, read_bounded_file};

use super::checksum::sha256_of_file;
use super::commit::NEW;
use super::disk;
use super::own_files::{Found, OwnFiles, survey};
use super::product::{EXPORTED, RUN};
use super::staging_folder::StagingFolder;
use super::whole_file::{FileError, to_json, write_whole};

/// Why complexes were not exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A file that is there differs, and nothing shows that knotdock wrote it as it is.
    #[error("{} is there and is not what would be written", .0.display())]
    Changed(PathBuf),
    /// A link or a folder has the name.
    #[error("{} is there and is no regular file", .0.display())]
    NoFile(PathBuf),
    /// Something could not be written.
    #[error(transparent)]
    Write(#[from] FileError),
}

impl ExportError {
    /// Remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Changed(_) => {
                "move the file away, choose another directory with -o, or pass --force to replace it"
            }
            Self::NoFile(_) => "move it away, or choose another directory with -o",
            Self::Write(error) => error.remedy(),
        }
    }

    /// The file in question.
    pub fn path(&self) -> &Path {
        match self {
            Self::Changed(path) | Self::NoFile(path) => path,
            Self::Write(error) => error.path(),
        }
    }
}

/// A folder that complexes of a run are exported into.
#[derive(Debug)]
pub struct ExportFolder {
    folder: PathBuf,
    staging: Option<StagingFolder>,
    /// Where complexes are written first.
    new: PathBuf,
    /// Folders that were made for it.
    made: Vec<PathBuf>,
    /// The run, where the folder is its own.
    run: Option<PathBuf>,
}

impl ExportFolder {
    /// Makes the folder, if there is none, and a staging folder in it.
    ///
    /// # Errors
    /// [`FileError::Unwritable`].
    pub fn open(folder: &Path, run: &Path) -> Result<Self, FileError> {
        let unwritable = |source| FileError::unwritable(folder, source);
        let name = OsStr::new("");
        let mut export = Self {
            folder: folder.to_owned(),
            staging: None,
            new: PathBuf::new(),
            made: disk::create_dir_all(folder).map_err(unwritable)?,
            run: None,
        };
        let is_own = RUN.folder.is_some_and(|own| {
            let own = run.join(own).canonicalize();
            own.is_ok_and(|own| folder.canonicalize().is_ok_and(|folder| folder == own))
        });
        export.run = is_own.then(|| run.to_owned());
        let others = StagingFolder::others(folder, name, None).map_err(unwritable)?;
        for left in others.left {
            left.remove().map_err(unwritable)?;
        }
        let staging = StagingFolder::create(folder, name).map_err(unwritable)?;
        export.new = staging.path().join(NEW);
        export.staging = Some(staging);
        disk::create_dir(&export.new).map_err(unwritable)?;
        Ok(export)
    }

    /// The folder to write into.
    pub fn staged(&self) -> &Path {
        &self.new
    }

    /// Moves the files into their places. With `force` those that are there are replaced, whatever they are.
    ///
    /// # Errors
    /// [`ExportError`]; of files that must not be replaced before anything is moved.
    pub fn place(mut self, force: bool) -> Result<(), ExportError> {
        let failed = |source| FileError::writing(&self.folder, source);
        disk::sync_tree(&self.new).map_err(failed)?;
        let unchanged = match &self.run {
            Some(run) => unchanged(run).map_err(failed)?,
            None => OwnFiles::default(),
        };
        let mut moves = Vec::new();
        let mut exported = BTreeMap::new();
        for name in disk::tree(&self.new).map_err(failed)? {
            let (from, to) = (self.new.join(&name), self.folder.join(&name));
            let checksum = sha256_of_file(&from).map_err(failed)?;
            let own = RUN.folder.map(|own| Path::new(own).join(&name));
            let is_unchanged = own.is_some_and(|path| unchanged.0.contains_key(&path));
            if is_to_move(&to, &checksum, is_unchanged || force)? {
                moves.push((from, to));
            }
            exported.insert(name.to_string_lossy().into_owned(), checksum);
        }
        if self.run.is_some() && !moves.is_empty() {
            self.record(exported)?;
        }
        for (from, to) in &moves {
            let moved = keep_mode(from, to).and_then(|()| match to.symlink_metadata() {
                Ok(_) => disk::rename(from, to),
                Err(_) => disk::rename_new(from, to),
            });
            moved.map_err(|source| FileError::writing(to, source))?;
        }
        disk::sync(&self.folder).map_err(failed)?;
        self.made.clear();
        if let Some(staging) = self.staging.take() {
            // The files are in their places. What stays here is cleared by the next export.
            let _ = staging.remove();
        }
        Ok(())
    }

    /// Adds files to the list of a run's exported complexes. It comes before them: a file that is
    /// recorded and not there does no harm.
    fn record(&self, exported: BTreeMap<String, String>) -> Result<(), FileError> {
        let path = self.folder.join(EXPORTED);
        let earlier = read_bounded_file(&path, MAX_RECORD).unwrap_or_default();
        let earlier: Value = serde_json::from_slice(&earlier).unwrap_or_default();
        let mut files: BTreeMap<String, Value> = BTreeMap::new();
        for (name, checksum) in earlier["files"].as_object().into_iter().flatten() {
            files.insert(name.clone(), checksum.clone());
        }
        files.extend(exported.into_iter().map(|(name, sum)| (name, sum.into())));
        let record = json!({ "program": "knotdock", "files": files });
        write_whole(&path, |stream| to_json(stream, &record))
    }
}

impl Drop for ExportFolder {
    fn drop(&mut self) {
        // A failure to tidy up has nobody to report to; the next export clears what is left.
        if let Some(staging) = self.staging.take() {
            let _ = staging.remove();
        }
        for folder in self.made.iter().rev() {
            let _ = disk::remove_dir(folder);
        }
    }
}

/// The files of a run that nobody has changed.
fn unchanged(run: &Path) -> io::Result<OwnFiles> {
    Ok(match survey(&RUN, run)? {
        Found::Run(own) => own,
        Found::Nothing | Found::Broken(_) | Found::Foreign(_) => OwnFiles::default(),
    })
}

/// Whether a file of a checksum is to be moved to a place: not where it is there already.
fn is_to_move(to: &Path, checksum: &str, may_replace: bool) -> Result<bool, ExportError> {
    let Ok(there) = to.symlink_metadata() else {
        return Ok(true);
    };
    if !there.is_file() {
        return Err(ExportError::NoFile(to.to_owned()));
    }
    let found = sha256_of_file(to).map_err(|source| FileError::unwritable(to, source))?;
    if found == checksum {
        return Ok(false);
    }
    if may_replace {
        return Ok(true);
    }
    Err(ExportError::Changed(to.to_owned()))
}

/// Gives a file the mode of the one that it replaces.
fn keep_mode(from: &Path, to: &Path) -> io::Result<()> {
    match to.symlink_metadata() {
        Ok(there) => disk::set_permissions(from, there.permissions()),
        Err(_) => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn export(folder: &Path, text: &str, force: bool) -> Result<(), ExportError> {
        let export = ExportFolder::open(folder, Path::new("no run")).unwrap();
        fs::write(export.staged().join("rank_0001.pdb"), text).unwrap();
        fs::write(export.staged().join("rank_0002.pdb"), "second").unwrap();
        export.place(force)
    }

    fn names(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    /// Found by hostile calls: a complex that a user had edited was overwritten, and one behind a link.
    #[test]
    fn a_changed_complex_or_a_link_is_not_overwritten() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("new/out");
        export(&folder, "first", false).unwrap();
        export(&folder, "first", false).unwrap();
        let first = folder.join("rank_0001.pdb");
        fs::write(&first, "edited").unwrap();
        fs::remove_file(folder.join("rank_0002.pdb")).unwrap();
        assert!(matches!(
            export(&folder, "first", false),
            Err(ExportError::Changed(_))
        ));
        assert_eq!(fs::read_to_string(&first).unwrap(), "edited");
        assert_eq!(names(&folder), 1, "nothing is moved before all are checked");
        export(&folder, "first", true).unwrap();
        assert_eq!(fs::read_to_string(&first).unwrap(), "first");
        assert_eq!(names(&folder), 2);
        #[cfg(unix)]
        {
            fs::remove_file(&first).unwrap();
            std::os::unix::fs::symlink(root.path().join("thesis"), &first).unwrap();
            for force in [false, true] {
                assert!(matches!(
                    export(&folder, "first", force),
                    Err(ExportError::NoFile(_))
                ));
            }
            assert!(!root.path().join("thesis").exists());
        }
    }
}
