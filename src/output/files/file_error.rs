//! Errors of files and folders.

use std::fmt::Display;
use std::path::Path;

use knotdock_structures::Error;

/// A place that cannot be made or written to.
pub fn unwritable(path: &Path, source: impl Display) -> Error {
    refused(
        path,
        format!("cannot write to {}: {source}", path.display()),
        "name a place that you may write to",
    )
}

/// A file that could not be written although it could be made: a full disk, for instance.
pub fn writing(path: &Path, source: impl Display) -> Error {
    Error::machine(format!("cannot write {}: {source}", path.display()))
        .at(path)
        .help("check the free space and the permissions there")
}

/// A file that the system does not give.
pub fn reading(path: &Path, source: impl Display) -> Error {
    Error::machine(format!("cannot read {}: {source}", path.display()))
        .at(path)
        .help("check the disk and the permissions there")
}

/// A file or folder that is refused, and the remedy.
pub fn refused(path: &Path, message: impl Display, remedy: impl Display) -> Error {
    Error::input(message).at(path).help(remedy)
}

/// A link where a file or a folder is to be written.
pub fn link(path: &Path) -> Error {
    refused(
        path,
        "this is a link, and nothing is written through links",
        "name what it leads to, or another place",
    )
}
