//! Folders and files of this program: made, cleared, and read without following links, waiting for pipes or exceeding a
//! bound.

use crate::output::files::file_error;
use knotdock_structures::Error;
use std::fs::File;
use std::io::{self, BufRead, Read};
use std::path::Path;

use super::disk;

/// Most bytes of a line.
const MAX_LINE: usize = 1 << 20;

/// The names of the entries of a folder, in their order.
pub fn names_in(folder: &Path) -> Result<Vec<String>, Error> {
    let entries = disk::entries(folder).map_err(|source| file_error::unwritable(folder, source))?;
    let names = entries.iter().filter_map(|(path, _)| path.file_name());
    let names = names.map(|name| name.to_string_lossy().into_owned());
    Ok(names.collect())
}

/// Makes a folder and those above it that are missing.
pub fn make_folder(path: &Path) -> Result<(), Error> {
    let made = disk::create_dir_all(path).map(drop);
    made.map_err(|source| file_error::unwritable(path, source))
}

/// Removes files of a folder, and the folder if it is empty then. Failures have no effect.
pub fn clear(folder: &Path, names: &[&str]) {
    for name in names {
        let _ = disk::remove_file(&folder.join(name));
    }
    let _ = disk::remove_dir(folder);
}

/// Opens a file to be read.
///
/// # Errors
/// [`Error`] for a file that cannot be read, and for a name of no file, such as of a link or a pipe.
pub fn open_own(path: &Path) -> Result<File, Error> {
    disk::open(path, File::options().read(true)).map_err(|source| match source.kind() {
        io::ErrorKind::PermissionDenied => file_error::reading(path, source),
        _ => file_error::refused(
            path,
            format!("cannot read {}: {source}", path.display()),
            "move it away, or choose another directory",
        ),
    })
}

/// Reads a file of at most `limit` bytes.
///
/// # Errors
/// As [`open_own`], and [`Error`] for one that is larger.
pub fn read_own(path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    let read = open_own(path)?.take(limit + 1).read_to_end(&mut bytes);
    read.map_err(|source| file_error::reading(path, source))?;
    if bytes.len() as u64 > limit {
        let message = format!("{} has more than {limit} bytes", path.display());
        let remedy = "move it away, or choose another directory";
        return Err(file_error::refused(path, message, remedy));
    }
    Ok(bytes)
}

/// Reads the next line without its end; false if no whole line is left.
///
/// # Errors
/// Those of the file, and [`io::ErrorKind::FileTooLarge`] for a line of more than a megabyte.
pub fn next_line(file: &mut impl BufRead, line: &mut Vec<u8>) -> io::Result<bool> {
    line.clear();
    let mut bounded = file.by_ref().take(MAX_LINE as u64 + 1);
    let count = bounded.read_until(b'\n', line)?;
    let is_whole = line.pop_if(|last| *last == b'\n').is_some();
    if !is_whole && count > MAX_LINE {
        let message = "a line has more than a megabyte";
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
    }
    Ok(is_whole)
}
