//! A run's directory: all of a new run or all of the older one.
//!
//! A run is written in a staging folder beside its directory, `.NAME.knotdock-…`, and takes its place when all of it is
//! on the device (`commit.rs`). Where nothing may be written beside the directory, or the directory is a
//! mount point or the current one, the staging folder lies in it. A process that is killed leaves only staging
//! folders, which the next run into the same directory clears. Nothing in the directory that a run did not write is
//! ever removed.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

use super::checksum::sha256_of_file;
pub use super::commit::SetAside;
use super::commit::{self, NEW};
use super::disk;
use super::places::{Places, resolved};
use super::product::{Product, RUN};
pub use super::staging_error::StagingError;
use super::staging_folder::StagingFolder;
use super::whole_file::{FileError, parent, write_new};

/// A run's directory while the run goes on: files are written under [`Staging::folder`] and appear all together on
/// [`Staging::commit`]. Dropped before that, it leaves the directory as it was.
#[derive(Debug)]
pub struct Staging {
    product: &'static Product,
    /// As the user named it.
    directory: PathBuf,
    /// Without links.
    resolved: PathBuf,
    /// `None` once it is removed, or must stay.
    staging: Option<StagingFolder>,
    /// The folder in it that is written to.
    folder: PathBuf,
    /// Whether the staging folder lies beside the directory and not in it.
    beside: bool,
    /// Folders above the directory that were made for it.
    made: Vec<PathBuf>,
    /// Files of the user's that a commit which was cut and finished at the start found in its way.
    set_aside: Vec<SetAside>,
}

impl Staging {
    /// Makes a staging folder for a run in `directory`, which also shows that it can be written to.
    ///
    /// # Errors
    /// [`StagingError::ExistingRun`] or [`StagingError::BrokenRun`] when a run is there and `force` is false,
    /// [`StagingError::NotARun`] when what is there no run has written, [`StagingError::Busy`] when another run is
    /// being written there, [`StagingError::Write`] when nothing can be.
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
        let unwritable = |source| FileError::unwritable(directory, source);
        let resolved = resolved(directory).map_err(unwritable)?;
        let places = Places {
            directory,
            resolved: &resolved,
        };
        let set_aside = places.clear(product)?;
        places.refuse_existing(product, force)?;
        let above = parent(&resolved);
        let mut staging = Self {
            product,
            directory: directory.to_owned(),
            folder: PathBuf::new(),
            beside: places.may_be_beside(),
            made: disk::create_dir_all(above).map_err(unwritable)?,
            staging: None,
            set_aside,
            resolved: resolved.clone(),
        };
        let name = resolved.file_name().unwrap_or_default();
        let made = match staging.beside {
            true => StagingFolder::create(above, name),
            false => StagingFolder::create(&resolved, OsStr::new("")),
        };
        let made = match made {
            // Where nothing may be written beside the directory, perhaps it may in it.
            Err(_) if staging.beside && resolved.is_dir() => {
                staging.beside = false;
                StagingFolder::create(&resolved, OsStr::new(""))
            }
            made => made,
        };
        let own = made.map_err(unwritable)?;
        staging.folder = own.path().join(NEW);
        let own = staging.staging.insert(own);
        // Another run may have started or ended between the first look and the lock.
        if let Some(folder) = places.others(Some(own))?.in_use {
            let directory = directory.to_owned();
            return Err(StagingError::Busy { directory, folder });
        }
        places.refuse_existing(product, force)?;
        disk::create_dir(&staging.folder).map_err(unwritable)?;
        Ok(staging)
    }

    /// The folder to write into.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Writes a file of the run.
    ///
    /// # Errors
    /// [`FileError::Write`] when it cannot be written, under the name that it would have had.
    pub fn write(
        &self,
        name: &str,
        fill: impl FnOnce(&mut dyn io::Write) -> io::Result<()>,
    ) -> Result<(), FileError> {
        write_new(&self.folder.join(name), fill)
            .map_err(|source| FileError::writing(&self.directory.join(name), source))
    }

    /// SHA-256 of each file written so far, by its path from the directory with `/` between folders. The product's
    /// record holds them as `files`.
    ///
    /// # Errors
    /// [`FileError::Write`] when one cannot be read.
    pub fn checksums(&self) -> Result<BTreeMap<String, String>, FileError> {
        let failed = |source| FileError::writing(&self.folder, source);
        let mut checksums = BTreeMap::new();
        for path in disk::tree(&self.folder).map_err(failed)? {
            let file = self.folder.join(&path);
            if file.is_dir() {
                continue;
            }
            let names = path.iter().map(|name| name.to_string_lossy());
            let name = names.collect::<Vec<_>>().join("/");
            checksums.insert(name, sha256_of_file(&file).map_err(failed)?);
        }
        Ok(checksums)
    }

    /// Moves what was written into the run's directory, in place of an older run, once it is on the device. Returns
    /// the files of the user's that were in the way.
    ///
    /// # Errors
    /// [`StagingError::Write`] when that fails and the older run stands as it was, [`StagingError::Interrupted`] when
    /// it does not.
    pub fn commit(mut self) -> Result<Vec<SetAside>, StagingError> {
        let places = Places {
            directory: &self.directory,
            resolved: &self.resolved,
        };
        let own = places.own_files(self.product)?;
        let Some(staging) = self.staging.take() else {
            return Ok(Vec::new());
        };
        let done = commit::commit(self.product, &staging, &self.resolved, own, self.beside);
        match done {
            Ok(done) => {
                self.made.clear();
                // The run stands. What stays of the staging folder is cleared by the next run.
                if !done.is_left {
                    let _ = staging.remove();
                }
                let mut set_aside = std::mem::take(&mut self.set_aside);
                set_aside.extend(done.set_aside);
                Ok(set_aside)
            }
            Err(error) if error.undone => {
                self.staging = Some(staging);
                Err(FileError::writing(&error.path, error.source).into())
            }
            Err(error) => {
                self.made.clear();
                Err(StagingError::Interrupted {
                    directory: self.directory.clone(),
                    folder: staging.path().to_owned(),
                    source: error.source,
                })
            }
        }
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // A failure to tidy up has nobody to report to; the next run clears what is left.
        if let Some(staging) = self.staging.take() {
            let _ = staging.remove();
        }
        for folder in self.made.iter().rev() {
            let _ = disk::remove_dir(folder);
        }
    }
}

/// Finishes a commit that an interrupted run left in a directory, so that the directory can be read, and clears what
/// else such runs left. Returns the files of the user's that were in the way.
///
/// # Errors
/// [`StagingError::Interrupted`] when it cannot be finished.
pub fn finish_interrupted(directory: &Path) -> Result<Vec<SetAside>, StagingError> {
    let directory = match directory.as_os_str().is_empty() {
        true => Path::new("."),
        false => directory,
    };
    let Ok(resolved) = directory.canonicalize() else {
        return Ok(Vec::new());
    };
    let places = Places {
        directory,
        resolved: &resolved,
    };
    // Where the folder above may not be read, no run has been staged.
    let Ok(others) = places.others(None) else {
        return Ok(Vec::new());
    };
    let mut set_aside = Vec::new();
    for staging in others.left {
        if commit::is_committing(&staging) {
            set_aside.extend(places.finish(&RUN, staging)?);
        } else {
            // In a place that may not be written to it is in nobody's way.
            let _ = staging.remove();
        }
    }
    Ok(set_aside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn fill(staging: &Staging, text: &str) {
        disk::create_dir(&staging.folder().join("top")).unwrap();
        for name in ["top/rank_0001.pdb", "poses.csv"] {
            staging
                .write(name, |file| file.write_all(text.as_bytes()))
                .unwrap();
        }
        let record = serde_json::json!({
            "program": "knotdock",
            "files": staging.checksums().unwrap(),
        });
        let record = record.to_string();
        staging
            .write("run.json", |file| file.write_all(record.as_bytes()))
            .unwrap();
    }

    fn run(directory: &Path, text: &str) -> Vec<SetAside> {
        let staging = Staging::open(directory, true).unwrap();
        fill(&staging, text);
        staging.commit().unwrap()
    }

    fn text(path: &Path) -> String {
        fs::read_to_string(path).unwrap()
    }

    /// Names in a folder, in order.
    fn names(folder: &Path) -> Vec<String> {
        let entries = disk::entries(folder).unwrap().into_iter();
        entries
            .map(|(path, _)| path.file_name().unwrap().to_string_lossy().into_owned())
            .collect()
    }

    #[test]
    fn a_failed_run_loses_nothing_and_leaves_nothing() {
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("all/runs/run");
        drop(Staging::open(&directory, false).unwrap());
        assert_eq!(
            names(root.path()),
            [""; 0],
            "folders made for nothing must go"
        );

        run(&directory, "first");
        fs::write(directory.join("notes.txt"), "mine").unwrap();
        let second = Staging::open(&directory, true).unwrap();
        fill(&second, "second");
        drop(second); // the run failed before its end
        assert_eq!(text(&directory.join("poses.csv")), "first");

        assert_eq!(run(&directory, "third"), []);
        for file in ["poses.csv", "top/rank_0001.pdb"] {
            assert_eq!(text(&directory.join(file)), "third");
        }
        assert_eq!(text(&directory.join("notes.txt")), "mine");
        let expected = ["notes.txt", "poses.csv", "run.json", "top"];
        assert_eq!(names(&directory), expected);
        assert_eq!(names(directory.parent().unwrap()), ["run"]);
    }

    #[test]
    fn an_older_run_is_replaced_on_request_only_and_a_stranger_never() {
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("run");
        run(&directory, "first");
        assert!(matches!(
            Staging::open(&directory, false),
            Err(StagingError::ExistingRun(_))
        ));
        let stranger = root.path().join("stranger");
        fs::create_dir(&stranger).unwrap();
        fs::write(stranger.join("poses.csv"), "not ours").unwrap();
        // Where no run is, --force is not the remedy.
        for force in [false, true] {
            assert!(matches!(
                Staging::open(&stranger, force),
                Err(StagingError::NotARun { .. })
            ));
        }
        assert_eq!(text(&stranger.join("poses.csv")), "not ours");
    }

    /// Found by hostile calls: after a power cut neither a run nor `--force` was of use.
    #[test]
    fn a_broken_run_is_replaced_on_request() {
        let root = tempfile::tempdir().unwrap();
        for (number, torn) in [
            "",
            "\0\0\0",
            "{\"schema\": 2, \"program\": \"knotdock\", \"fi",
        ]
        .into_iter()
        .enumerate()
        {
            let directory = root.path().join(number.to_string());
            run(&directory, "first");
            fs::write(directory.join("run.json"), torn).unwrap();
            fs::write(directory.join("poses.csv"), "").unwrap();
            assert!(matches!(
                Staging::open(&directory, false),
                Err(StagingError::BrokenRun { .. })
            ));
            // The complex shows no sign of this program, so it may be the user's.
            assert_eq!(run(&directory, "second").len(), 1);
            assert_eq!(names(&directory), ["poses.csv", "run.json", "top"]);
            assert_eq!(text(&directory.join("poses.csv")), "second");
            assert_eq!(text(&directory.join("top/rank_0001.kept.pdb")), "first");
        }
    }

    /// Found by hostile calls: `--force` removed what a user had put into a run's folder of complexes.
    #[test]
    fn what_is_not_the_runs_own_is_kept() {
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("run");
        run(&directory, "first");
        fs::write(directory.join("top/rank_0001.pdb"), "edited").unwrap();
        fs::write(directory.join("top/session.cxs"), "mine").unwrap();
        let set_aside = run(&directory, "second");
        assert_eq!(set_aside.len(), 1);
        let expected = ["rank_0001.kept.pdb", "rank_0001.pdb", "session.cxs"];
        assert_eq!(names(&directory.join("top")), expected);
        assert_eq!(text(&directory.join("top/rank_0001.kept.pdb")), "edited");
        assert_eq!(text(&directory.join("top/rank_0001.pdb")), "second");
    }

    /// Found by hostile calls: a link of the staging folder's name led to a folder that was then emptied.
    #[cfg(unix)]
    #[test]
    fn no_link_is_followed() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        fs::create_dir_all(at("thesis/top")).unwrap();
        fs::write(at("thesis/top/rank_0001.pdb"), "mine").unwrap();
        fs::create_dir(at("run")).unwrap();
        for name in [
            "run/.partial",
            "run/.knotdock-abcdefghijkl",
            ".run.knotdock-abcdefghijkl",
        ] {
            symlink(at("thesis"), at(name)).unwrap();
        }
        run(&at("run"), "first");
        symlink(at("thesis/top"), at("linked_top")).unwrap();
        fs::remove_dir_all(at("run/top")).unwrap();
        symlink(at("thesis/top"), at("run/top")).unwrap();
        assert!(matches!(
            Staging::open(&at("run"), true),
            Err(StagingError::NotARun { entry: "top", .. })
        ));
        assert_eq!(text(&at("thesis/top/rank_0001.pdb")), "mine");
        assert_eq!(names(&at("thesis")), ["top"]);
        // A directory named by a link is the one that it leads to.
        symlink(at("other"), at("link")).unwrap();
        assert!(
            Staging::open(&at("link"), true).is_err(),
            "it leads nowhere"
        );
        fs::create_dir(at("other")).unwrap();
        run(&at("link"), "first");
        assert!(at("link").symlink_metadata().unwrap().is_symlink());
        assert_eq!(text(&at("other/poses.csv")), "first");
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
                Err(StagingError::Busy { .. })
            ));
        }
        first.commit().unwrap();
        assert!(matches!(
            Staging::open(&directory, false),
            Err(StagingError::ExistingRun(_))
        ));
        drop(Staging::open(&directory, true).unwrap());
        assert_eq!(text(&directory.join("poses.csv")), "first");
    }

    #[cfg(unix)]
    #[test]
    fn modes_of_a_directory_and_its_files_are_kept() {
        use std::os::unix::fs::PermissionsExt;
        let root = tempfile::tempdir().unwrap();
        let directory = root.path().join("run");
        run(&directory, "first");
        for (name, mode) in [("", 0o750), ("poses.csv", 0o640)] {
            let mode = fs::Permissions::from_mode(mode);
            fs::set_permissions(directory.join(name), mode).unwrap();
        }
        run(&directory, "second");
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(&directory), 0o750);
        assert_eq!(mode(&directory.join("poses.csv")), 0o640);
    }
}
