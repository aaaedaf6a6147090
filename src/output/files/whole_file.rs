//! A file whole or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// Ending of files that are being written.
pub const PARTIAL: &str = ".partial";

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

/// Writes a single file whole: under a `.partial` name beside `path`, then renamed. What is not a regular file
/// (`/dev/stdout`, a pipe) is written to as it stands.
///
/// # Errors
/// [`FileError::Unwritable`] when the file cannot be made, [`FileError::Write`] when writing to it fails.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut dyn io::Write) -> io::Result<()>,
) -> Result<(), FileError> {
    let in_place = is_stream(path);
    // Through a link, what it leads to is replaced and not the link.
    let resolved = path.canonicalize();
    let path = match &resolved {
        Ok(resolved) if !in_place => resolved,
        _ => path,
    };
    let target = if in_place {
        path.to_owned()
    } else {
        let mut name = path.as_os_str().to_owned();
        name.push(PARTIAL);
        PathBuf::from(name)
    };
    let file = fs::OpenOptions::new()
        .append(in_place)
        .write(true)
        .create(!in_place)
        .truncate(!in_place)
        .open(&target)
        .map_err(|source| FileError::unwritable(path, source))?;
    let mut buffer = io::BufWriter::new(file);
    let written = fill(&mut buffer).and_then(|()| io::Write::flush(&mut buffer));
    if in_place {
        return written.map_err(|source| FileError::writing(path, source));
    }
    written
        .and_then(|()| fs::rename(&target, path))
        .map_err(|source| {
            let _ = fs::remove_file(&target);
            FileError::writing(path, source)
        })
}

/// Writes a value as indented JSON with a line end, whole or not at all.
///
/// # Errors
/// As [`write_whole`].
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), FileError> {
    write_whole(path, |file| {
        serde_json::to_writer_pretty(&mut *file, value)?;
        writeln!(file)
    })
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
