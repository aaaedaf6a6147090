//! A file whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::disk::{self, NewFile};
use super::staging_folder::StagingFolder;

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The place cannot be made or written to.
    #[error("cannot write to {}: {source}", path.display())]
    Unwritable {
        /// The file or directory.
        path: PathBuf,
        /// The system's message.
        source: io::Error,
    },
    /// A file could not be written although it could be made: a full disk, for instance.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's message.
        source: io::Error,
    },
}

impl FileError {
    /// A place that cannot be written to.
    pub(crate) fn unwritable(path: &Path, source: io::Error) -> Self {
        Self::Unwritable {
            path: path.to_owned(),
            source,
        }
    }

    /// A file whose writing failed.
    pub(crate) fn writing(path: &Path, source: io::Error) -> Self {
        Self::Write {
            path: path.to_owned(),
            source,
        }
    }

    /// Remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Unwritable { .. } => "name a place that you may write to",
            Self::Write { .. } => "check the free space and the permissions there",
        }
    }

    /// The file or directory in question.
    pub fn path(&self) -> &Path {
        match self {
            Self::Unwritable { path, .. } | Self::Write { path, .. } => path,
        }
    }

    /// Whether the request was at fault (exit code 2) and not the writing (exit code 1).
    pub fn is_input(&self) -> bool {
        matches!(self, Self::Unwritable { .. })
    }
}

/// Whether a name stands for something that is written to in place, such as a device or a pipe.
///
/// A name that the system gives to the process counts too. It may be a regular file (`/dev/stdout`, redirected).
pub fn is_stream(path: &Path) -> bool {
    let is_own = path.starts_with("/proc")
        || path.starts_with("/dev/fd")
        || ["/dev/stdin", "/dev/stdout", "/dev/stderr"]
            .iter()
            .any(|name| path == Path::new(name));
    is_own || fs::metadata(path).is_ok_and(|found| !found.is_file())
}

/// Whether a file's bytes are none, or zeros as a power cut leaves them.
pub fn is_blank(bytes: &[u8]) -> bool {
    bytes.iter().all(|&byte| byte == 0)
}

/// A file that is written and not yet in its place. Dropped, it goes, and what is in its place stays.
#[derive(Debug)]
pub struct StagedFile {
    /// Where it goes; `None` for a stream, which is written to in place.
    place: Option<PathBuf>,
    folder: Option<StagingFolder>,
}

/// Name of the file in its staging folder.
const NEW: &str = "new";

impl StagedFile {
    /// Writes a file, to the device, in a staging folder beside its place. What is not a regular file (`/dev/stdout`,
    /// a pipe) is written to as it stands. Through a link, what it leads to is replaced and not the link. A file that
    /// is replaced leaves its mode.
    ///
    /// # Errors
    /// [`FileError::Unwritable`] when the file cannot be made, [`FileError::Write`] when writing to it fails.
    pub fn write(
        path: &Path,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Self, FileError> {
        if is_stream(path) {
            write_in_place(path, fill)?;
            return Ok(Self {
                place: None,
                folder: None,
            });
        }
        let unwritable = |source| FileError::unwritable(path, source);
        let place = match path.symlink_metadata() {
            // A link to nothing is an error, not a file to replace.
            Ok(_) => path.canonicalize().map_err(unwritable)?,
            Err(_) => path.to_owned(),
        };
        let (parent, name) = (parent(&place), place.file_name().unwrap_or_default());
        // A folder that cannot be read can still be written to.
        if let Ok(others) = StagingFolder::others(parent, name, None) {
            for left in others.left {
                left.remove().map_err(unwritable)?;
            }
        }
        let mut staged = Self {
            folder: Some(StagingFolder::create(parent, name).map_err(unwritable)?),
            place: None,
        };
        if let Some(folder) = &staged.folder {
            let file = folder.path().join(NEW);
            let written = write_new(&file, fill).and_then(|()| {
                if let Ok(there) = fs::metadata(&place) {
                    disk::set_permissions(&file, there.permissions())?;
                }
                disk::sync(&file)
            });
            written.map_err(|source| FileError::writing(path, source))?;
        }
        staged.place = Some(place);
        Ok(staged)
    }

    /// Puts the file into its place, at one stroke.
    ///
    /// # Errors
    /// [`FileError::Write`].
    pub fn place(mut self) -> Result<(), FileError> {
        let (Some(place), Some(folder)) = (&self.place, &self.folder) else {
            return Ok(());
        };
        let failed = |source| FileError::writing(place, source);
        disk::rename(&folder.path().join(NEW), place).map_err(failed)?;
        disk::sync(parent(place)).map_err(failed)?;
        if let Some(folder) = self.folder.take() {
            // The file is in its place. What stays here is cleared by the next one.
            let _ = folder.remove();
        }
        Ok(())
    }
}

impl Drop for StagedFile {
    fn drop(&mut self) {
        if let Some(folder) = self.folder.take() {
            // A failure to tidy up has nobody to report to; the next one clears what is left.
            let _ = folder.remove();
        }
    }
}

/// Writes a single file whole: beside `path`, then moved there at one stroke.
///
/// # Errors
/// As [`StagedFile::write`].
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FileError> {
    StagedFile::write(path, fill)?.place()
}

/// Writes a file that was not there, and does not wait for the device.
pub(super) fn write_new(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut buffer = BufWriter::new(NewFile::create(path)?);
    fill(&mut buffer)?;
    buffer.flush()
}

/// Writes to a device or a pipe.
fn write_in_place(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FileError> {
    let file = File::options()
        .append(true)
        .open(path)
        .map_err(|source| FileError::unwritable(path, source))?;
    let mut buffer = BufWriter::new(file);
    fill(&mut buffer)
        .and_then(|()| buffer.flush())
        .map_err(|source| FileError::writing(path, source))
}

/// The folder of a file.
pub(super) fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Writes a value as indented JSON with a line end.
///
/// # Errors
/// Those of the stream.
pub fn to_json(stream: &mut dyn Write, value: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *stream, value)?;
    writeln!(stream)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_whose_writing_fails_leaves_the_old_one() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("table.csv");
        fs::write(&path, "old").unwrap();
        let failed = write_whole(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::other("disk full"))
        });
        assert!(matches!(failed, Err(FileError::Write { .. })));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
    }

    /// Found by a review: a run into `/dev/shm`, whose files are files, was lost.
    #[cfg(unix)]
    #[test]
    fn streams_are_devices_pipes_and_the_process_own_handles() {
        for (name, expected) in [
            ("/dev/null", true),
            ("/dev/stdout", true),
            ("/dev/fd/3", true),
            ("/proc/self/fd/1", true),
            ("/dev/shm/knotdock-none/poses.csv", false),
            ("/dev/none", false),
            ("poses.csv", false),
        ] {
            assert_eq!(is_stream(Path::new(name)), expected, "{name}");
        }
    }

    /// Found by hostile calls: a user's `table.csv.partial` was overwritten, and a link of that name followed.
    #[test]
    fn files_of_such_names_stay() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("table.csv");
        let mine = ["table.csv.partial", ".table.csv.knotdock-abcdefghijkl"];
        for name in mine {
            fs::write(root.path().join(name), "mine").unwrap();
        }
        write_whole(&path, |file| file.write_all(b"new")).unwrap();
        for name in mine {
            assert_eq!(fs::read_to_string(root.path().join(name)).unwrap(), "mine");
        }
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 3);
    }

    /// A file that others may not read stays so when it is written anew.
    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_mode() {
        use std::os::unix::fs::PermissionsExt;
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("table.csv");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        write_whole(&path, |file| file.write_all(b"new")).unwrap();
        assert_eq!(
            fs::metadata(&path).unwrap().permissions().mode() & 0o777,
            0o640
        );
    }

    /// Found by a review: a link was replaced by the file, even where it was `/dev/stdout`.
    #[cfg(unix)]
    #[test]
    fn through_a_link_what_it_leads_to_is_replaced() {
        let root = tempfile::tempdir().unwrap();
        let (file, link) = (root.path().join("table.csv"), root.path().join("link.csv"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_whole(&link, |file| file.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
        assert!(is_stream(Path::new("/dev/stdout")) && !is_stream(&link));
    }
}
