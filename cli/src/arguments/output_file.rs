//! Checks of an output file: never over one that is read, and over another only on request.

use std::path::{Path, PathBuf};

use crate::messages::console::Console;
use knotdock::output::files::file_error;
use knotdock::output::files::whole_file::{is_link, is_stream, leftovers};
use knotdock_structures::Error;

/// Checks, before any work, that each file can be made, is no link and none of those `read` or of the others. It may
/// exist only if `force` is true. Warns of leftovers of ended commands.
pub fn check_outputs<'a>(
    files: impl IntoIterator<Item = &'a PathBuf>,
    read: &[&Path],
    force: bool,
    console: Console,
) -> Result<(), Error> {
    let mut checked: Vec<&Path> = Vec::new();
    for file in files {
        if checked.iter().any(|other| is_same(other, file)) {
            return Err(Error::input("the same file is named twice")
                .at(file)
                .help("give each output file its own name"));
        }
        check_output(file, read, force, console)?;
        checked.push(file);
    }
    Ok(())
}

fn check_output(file: &Path, read: &[&Path], force: bool, console: Console) -> Result<(), Error> {
    check_not_read(file, read.iter().copied())?;
    if is_link(file) {
        return Err(file_error::link(file));
    }
    // A device or a pipe is there and is meant to be written to.
    if !force && file.is_file() && !is_stream(file) {
        return Err(Error::input("the file is already there")
            .at(file)
            .help("choose another name, or pass --force to replace it"));
    }
    if file.is_dir() || !folder_of(file).is_dir() {
        return Err(Error::input(
            "cannot write this file: its folder does not exist, or the name is that of a folder",
        )
        .at(file)
        .help("name a file in a folder that exists"));
    }
    if !is_stream(file) {
        console.warn_leftovers(&leftovers(file));
    }
    Ok(())
}

pub fn check_not_read<'a>(
    file: &Path,
    read: impl IntoIterator<Item = &'a Path>,
) -> Result<(), Error> {
    if read.into_iter().any(|other| is_same(file, other)) {
        return Err(Error::input("the output file is one of the input files")
            .at(file)
            .help("give the output file another name"));
    }
    Ok(())
}

/// Whether two names, of which either may be of nothing yet, are of one file, by links and detours too.
pub fn is_same(one: &Path, other: &Path) -> bool {
    plain(one) == plain(other)
}

/// A file's path without links and detours; of one that is not there yet its folder's, with its name.
fn plain(file: &Path) -> PathBuf {
    let in_folder = || {
        let folder = folder_of(file).canonicalize().ok()?;
        Some(folder.join(file.file_name()?))
    };
    let there = file.canonicalize().ok();
    there.or_else(in_folder).unwrap_or_else(|| file.to_owned())
}

fn folder_of(file: &Path) -> &Path {
    let folder = file.parent();
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found by a review: `--atoms a.pdb --write ./a.pdb` wrote one over the other.
    #[test]
    fn a_file_that_is_not_there_yet_is_known_under_every_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("inner")).unwrap();
        assert!(is_same(&at("a.pdb"), &at("./inner/../a.pdb")));
        assert!(is_same(Path::new("a.pdb"), Path::new("./a.pdb")));
        assert!(!is_same(&at("a.pdb"), &at("inner/a.pdb")));
        assert!(!is_same(&at("a.pdb"), &at("b.pdb")));
        assert!(is_same(&at("nowhere/a.pdb"), &at("nowhere/a.pdb")));
    }
}
