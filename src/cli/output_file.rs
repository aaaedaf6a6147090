//! Where a single file may be written: never over one that is read, and over another only on request.

use std::path::Path;

use knotdock::output::whole_file::is_stream;

use super::failure::Failure;

/// Checks, before any work, that `file` can be made, is none of those that are `read`, and is not there unless `force` is true.
pub fn check_output<'a>(
    file: &Path,
    read: impl IntoIterator<Item = &'a Path>,
    force: bool,
) -> Result<(), Failure> {
    check_replaced(file, read, force)?;
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    if file.is_dir() || !folder.unwrap_or(Path::new(".")).is_dir() {
        return Err(Failure::input(
            "cannot write there: the folder does not exist or the name is a folder's",
        )
        .at(file)
        .remedy("name a file in a folder that exists"));
    }
    Ok(())
}

/// Checks that `file` is none of those that are `read`, and is not there unless `force` is true.
pub fn check_replaced<'a>(
    file: &Path,
    read: impl IntoIterator<Item = &'a Path>,
    force: bool,
) -> Result<(), Failure> {
    if read.into_iter().any(|other| is_same(file, other)) {
        return Err(Failure::input("the file to write is one of those read")
            .at(file)
            .remedy("give the file to write a name of its own"));
    }
    // A device or a pipe is there and is meant to be written to.
    if !force && file.is_file() && !is_stream(file) {
        return Err(Failure::input("the file is already there")
            .at(file)
            .remedy("choose another name, or pass --force to replace it"));
    }
    Ok(())
}

/// Whether two names, of which either may be of nothing yet, are of one file, by links and detours too.
fn is_same(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => one == other,
    }
}
