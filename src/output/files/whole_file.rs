//! A file whole or not at all.

use crate::output::files::file_error;
use knotdock_structures::Error;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use tempfile::TempPath;

use super::checksum::sha256_of_file;
use super::disk;
use super::fault::point;

/// Whether a name is of a device, a pipe or the like, which is written to in place.
///
/// A name that the system gives to the process counts too. It may be a regular file (`/dev/stdout`, redirected).
pub fn is_stream(path: &Path) -> bool {
    is_of_process(path) || fs::metadata(path).is_ok_and(|found| !found.is_file())
}

/// Whether the system gives a name to the process, as it does `/dev/stdout`.
fn is_of_process(path: &Path) -> bool {
    let names = ["/dev/stdin", "/dev/stdout", "/dev/stderr"];
    path.starts_with("/proc")
        || path.starts_with("/dev/fd")
        || names.iter().any(|name| path == Path::new(name))
}

/// Whether a name is a link that the user made: nothing is written through it.
pub fn is_link(path: &Path) -> bool {
    !is_of_process(path) && path.is_symlink()
}

/// Random letters at the end of the name of a file or folder that is being written.
const RANDOM: usize = 12;

/// A name of this program beside a place: `.NAME.knotdock-` and an ending.
pub(super) fn beside(place: &Path, ending: &str) -> PathBuf {
    let mut name = prefix(place);
    name.push(ending);
    parent(place).join(name)
}

/// The lock of a place.
pub(super) fn lock_beside(place: &Path) -> PathBuf {
    beside(place, "lock")
}

fn prefix(place: &Path) -> OsString {
    // A name has 255 bytes at most in all.
    const LONGEST: usize = 200;
    let name = place.file_name().unwrap_or_default();
    let mut prefix = OsString::from(".");
    match name.len() <= LONGEST {
        true => prefix.push(name),
        false => {
            let start = name.to_string_lossy();
            prefix.push(start.chars().take(LONGEST / 4).collect::<String>());
        }
    }
    prefix.push(".knotdock-");
    prefix
}

/// Makes a file or a folder beside a place, under a new name.
pub(super) fn make_beside<R>(
    place: &Path,
    make: impl FnMut(&Path) -> io::Result<R>,
) -> io::Result<(R, TempPath)> {
    let made = tempfile::Builder::new()
        .prefix(&prefix(place))
        .rand_bytes(RANDOM)
        .make_in(parent(place), make)?;
    Ok(made.into_parts())
}

/// Files and folders of commands that were ended, or still run, beside a place. Only the user can decide whether they go.
pub fn leftovers(place: &Path) -> Vec<PathBuf> {
    let (lock, prefix) = (lock_beside(place), prefix(place));
    let entries = disk::entries(parent(place)).unwrap_or_default().into_iter();
    let is_ours = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().as_encoded_bytes();
        let rest = name.strip_prefix(prefix.as_encoded_bytes());
        rest.is_some_and(|rest| rest.len() == RANDOM || rest == b"old") && *path != lock
    };
    entries.map(|(path, _)| path).filter(is_ours).collect()
}

/// A file that is written and not yet in its place. Dropped, it goes, and the file in its place stays.
#[derive(Debug)]
pub struct StagedFile {
    place: PathBuf,
    /// Whether a file was there at the start. One that comes in the meantime is not replaced.
    replaces: bool,
    /// Its present path; `None` for a stream, which is written to in place.
    file: Option<TempPath>,
}

impl StagedFile {
    /// Writes a file, to the device, beside its place. A stream (`/dev/stdout`, a pipe) is written to in place. A file that
    /// is replaced leaves its mode.
    pub fn write(
        path: &Path,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Self, Error> {
        if is_link(path) {
            return Err(file_error::link(path));
        }
        if is_stream(path) {
            write_in_place(path, fill)?;
            return Ok(Self {
                place: path.to_owned(),
                replaces: false,
                file: None,
            });
        }
        Self::own(path, fill)
    }

    /// As [`StagedFile::write`], under a name that no user chose: any but a regular file there is refused.
    pub fn own(
        path: &Path,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Self, Error> {
        let there = path.symlink_metadata().ok();
        if there.as_ref().is_some_and(|found| !found.is_file()) {
            let message = format!("{} is there and is no regular file", path.display());
            let remedy = "move it away, or choose another place";
            return Err(file_error::refused(path, message, remedy));
        }
        let replaces = there.is_some();
        let (file, temporary) = make_beside(path, disk::create)
            .map_err(|source| file_error::unwritable(path, source))?;
        let mut buffer = BufWriter::new(file);
        let written = fill(&mut buffer).and_then(|()| {
            point("write", path)?;
            buffer.flush()?;
            if let Some(there) = there {
                disk::set_permissions(&temporary, there.permissions())?;
            }
            disk::sync(&temporary)
        });
        written.map_err(|source| file_error::writing(path, source))?;
        Ok(Self {
            place: path.to_owned(),
            replaces,
            file: Some(temporary),
        })
    }

    /// Whether a file with the same content is in its place already.
    pub fn is_there(&self) -> Result<bool, Error> {
        let (Some(file), true) = (&self.file, self.replaces) else {
            return Ok(false);
        };
        let failed = |source| file_error::reading(&self.place, source);
        let sum = sha256_of_file(file).map_err(failed)?;
        Ok(sha256_of_file(&self.place).map_err(failed)? == sum)
    }

    /// Puts the file into its place, at one stroke.
    pub fn place(self) -> Result<(), Error> {
        let Some(file) = self.file else {
            return Ok(());
        };
        let rename = match self.replaces {
            true => disk::rename,
            false => disk::rename_new,
        };
        let moved = rename(&file, &self.place).and_then(|()| {
            // It has another name now, and nothing is left to be removed.
            let _ = file.keep();
            disk::sync(parent(&self.place))
        });
        moved.map_err(|source| file_error::writing(&self.place, source))
    }
}

/// Writes a single file whole: beside `path`, then moved there at one stroke.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Error> {
    StagedFile::write(path, fill)?.place()
}

/// Writes a file that was not there, and does not wait for the device.
pub(super) fn write_new(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut buffer = BufWriter::new(disk::create(path)?);
    fill(&mut buffer)?;
    point("write", path)?;
    buffer.flush()
}

/// Writes to a device or a pipe.
fn write_in_place(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Error> {
    let file = File::options().append(true).open(path);
    let file = file.map_err(|source| file_error::unwritable(path, source))?;
    let mut buffer = BufWriter::new(file);
    let written = fill(&mut buffer).and_then(|()| buffer.flush());
    written.map_err(|source| file_error::writing(path, source))
}

/// The folder of a file.
pub(super) fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Writes a value as indented JSON with a line end.
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
        assert!(!failed.unwrap_err().is_input());
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
    fn nothing_is_written_through_a_link() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let (file, link) = (root.path().join("table.csv"), root.path().join("link.csv"));
        fs::write(&file, "old").unwrap();
        symlink(&file, &link).unwrap();
        symlink(root.path().join("nowhere"), root.path().join("dangling")).unwrap();
        for name in ["link.csv", "dangling"] {
            let written = write_whole(&root.path().join(name), |file| file.write_all(b"new"));
            assert!(written.unwrap_err().is_input());
        }
        assert_eq!(fs::read_to_string(&file).unwrap(), "old");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 3);
        assert!(is_stream(Path::new("/dev/stdout")) && !is_stream(&link));
    }

    #[test]
    fn what_was_left_is_found_and_a_long_name_fits() {
        let root = tempfile::tempdir().unwrap();
        let place = root.path().join("n".repeat(255));
        let (_, left) = make_beside(&place, disk::create).unwrap();
        let _lock = super::super::lock::Lock::take(&lock_beside(&place)).unwrap();
        assert_eq!(leftovers(&place), [left.to_path_buf()]);
        assert!(leftovers(&root.path().join("other")).is_empty());
    }
}
