//! Folders and files that are this program's own: made, cleared, and read without following links, waiting for pipes or taking more than a
//! bound.

use crate::output::files::file_error;
use knotdock_structures::Error;
use std::fs::File;
use std::io::{self, BufRead, Read};
use std::path::Path;

use super::disk;

/// Most bytes of a line.
pub const MAX_LINE: usize = 1 << 20;

/// The names of what is in a folder, in their order.
///
/// # Errors
/// [`Error`] when it cannot be read.
pub fn names_in(folder: &Path) -> Result<Vec<String>, Error> {
    let entries = disk::entries(folder).map_err(|source| file_error::unwritable(folder, source))?;
    let names = entries.iter().filter_map(|(path, _)| path.file_name());
    Ok(names
        .map(|name| name.to_string_lossy().into_owned())
        .collect())
}

/// Makes a folder and those above it, where they are not there.
///
/// # Errors
/// [`Error`] when it cannot be made.
pub fn make_folder(path: &Path) -> Result<(), Error> {
    let made = disk::create_dir_all(path).map(drop);
    made.map_err(|source| file_error::unwritable(path, source))
}

/// Removes files of a folder, and the folder if nothing is left in it. What cannot be removed stays.
pub fn clear(folder: &Path, names: &[&str]) {
    for name in names {
        let _ = disk::remove_file(&folder.join(name));
    }
    let _ = disk::remove_dir(folder);
}

/// Opens a file to be read.
///
/// # Errors
/// [`Error`] where it is no file, such as a link or a pipe, and where it cannot be read.
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
        return Err(file_error::refused(
            path,
            message,
            "move it away, or choose another directory",
        ));
    }
    Ok(bytes)
}

/// Reads the next line without its end; false where there is none that is whole.
///
/// # Errors
/// What the system says, and [`io::ErrorKind::FileTooLarge`] for a line of more than a megabyte.
pub fn next_line(file: &mut impl BufRead, line: &mut Vec<u8>) -> io::Result<bool> {
    line.clear();
    let count = file
        .by_ref()
        .take(MAX_LINE as u64 + 1)
        .read_until(b'\n', line)?;
    if line.pop_if(|last| *last == b'\n').is_some() {
        return Ok(true);
    }
    match count > MAX_LINE {
        true => Err(io::Error::new(
            io::ErrorKind::FileTooLarge,
            "a line has more than a megabyte",
        )),
        false => Ok(false),
    }
}
