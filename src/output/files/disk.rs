//! Changes of the disk: all that the program makes, moves and removes goes through here.
//!
//! New files and folders are made exclusively: what is there already, a link too, is an error and stays. Each change
//! is announced to [`fault`], so that tests can end the program at any of them.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io;
use std::path::{Path, PathBuf};

use super::fault::point;

/// Makes a file with the mode that the process gives to new files; [`io::ErrorKind::AlreadyExists`] if something has the
/// name.
pub(super) fn create(path: &Path) -> io::Result<File> {
    point("create", path)?;
    File::create_new(path)
}

/// Makes a folder that was not there.
pub(super) fn create_dir(path: &Path) -> io::Result<()> {
    point("mkdir", path)?;
    fs::create_dir(path)
}

/// Makes a folder and those above it that are missing; returns the new ones, from the top.
pub(super) fn create_dir_all(path: &Path) -> io::Result<Vec<PathBuf>> {
    let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.is_dir();
    let missing: Vec<&Path> = path.ancestors().take_while(is_missing).collect();
    let mut made = Vec::new();
    for folder in missing.into_iter().rev() {
        match create_dir(folder) {
            Ok(()) => made.push(folder.to_owned()),
            // Another process may have made it.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => {}
            Err(error) => return Err(error),
        }
    }
    Ok(made)
}

/// Opens a file that is there: no link, and nothing that is no file, such as a pipe, for which one would wait.
pub(super) fn open(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags((OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed());
    }
    let none = || io::Error::new(io::ErrorKind::InvalidInput, "it is a link, or no file");
    if !path.symlink_metadata()?.is_file() {
        return Err(none());
    }
    let file = options.open(path)?;
    match file.metadata()?.is_file() {
        true => Ok(file),
        false => Err(none()),
    }
}

/// Whether a file has no other name (hard link), under which it would change, too.
pub(super) fn has_one_name(file: &File) -> io::Result<bool> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        Ok(file.metadata()?.nlink() == 1)
    }
    #[cfg(not(unix))]
    file.metadata().map(|_| true)
}

/// Moves a file or folder within a file system, in place of a file of the new name.
pub(super) fn rename(from: &Path, to: &Path) -> io::Result<()> {
    point("rename", to)?;
    fs::rename(from, to)
}

/// Moves a file or folder within a file system to a name that nothing has; [`io::ErrorKind::AlreadyExists`] if something
/// has it.
pub(super) fn rename_new(from: &Path, to: &Path) -> io::Result<()> {
    point("rename", to)?;
    match rename_with(Rename::New, from, to) {
        Err(error) if is_unsupported(&error) => {
            // Between the look and the move another process could take the name; there is no better way there.
            if to.symlink_metadata().is_ok() {
                return Err(io::ErrorKind::AlreadyExists.into());
            }
            fs::rename(from, to)
        }
        done => done,
    }
}

/// Exchanges two files or folders of a file system at one stroke. See [`is_unsupported`] for systems that cannot do it.
pub(super) fn exchange(one: &Path, other: &Path) -> io::Result<()> {
    point("exchange", other)?;
    // So that tests take the way of systems without it.
    if cfg!(debug_assertions) && std::env::var_os("KNOTDOCK_NO_EXCHANGE").is_some() {
        return Err(io::ErrorKind::Unsupported.into());
    }
    rename_with(Rename::Exchange, one, other)
}

/// Ways to rename that `std` lacks.
enum Rename {
    New,
    Exchange,
}

/// Renames in a way that only some systems have.
#[cfg(any(target_os = "linux", target_os = "android", target_os = "macos"))]
fn rename_with(way: Rename, from: &Path, to: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    let flags = match way {
        Rename::New => RenameFlags::NOREPLACE,
        Rename::Exchange => RenameFlags::EXCHANGE,
    };
    Ok(renameat_with(CWD, from, CWD, to, flags)?)
}

/// Renames in a way that this system does not have.
#[cfg(not(any(target_os = "linux", target_os = "android", target_os = "macos")))]
fn rename_with(_: Rename, _: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Whether an error says that the system or the file system knows no such operation.
pub(super) fn is_unsupported(error: &io::Error) -> bool {
    // A file system that does not know a flag calls it an invalid argument.
    matches!(
        error.kind(),
        io::ErrorKind::Unsupported | io::ErrorKind::InvalidInput
    )
}

/// Removes a file, or a link itself.
pub(super) fn remove_file(path: &Path) -> io::Result<()> {
    point("unlink", path)?;
    fs::remove_file(path)
}

/// Removes an empty folder.
pub(super) fn remove_dir(path: &Path) -> io::Result<()> {
    point("rmdir", path)?;
    fs::remove_dir(path)
}

/// Removes a folder with all that is in it. Links are removed, not followed.
pub(super) fn remove_tree(folder: &Path) -> io::Result<()> {
    for (path, is_folder) in entries(folder)? {
        let remove = if is_folder { remove_tree } else { remove_file };
        remove(&path)?;
    }
    remove_dir(folder)
}

/// The entries of a folder in the order of their names, each with whether it is a folder itself and no link.
pub(super) fn entries(folder: &Path) -> io::Result<Vec<(PathBuf, bool)>> {
    let entries = fs::read_dir(folder)?.map(|entry| {
        let entry = entry?;
        Ok((entry.path(), entry.file_type()?.is_dir()))
    });
    let mut entries: Vec<_> = entries.collect::<io::Result<_>>()?;
    entries.sort();
    Ok(entries)
}

/// The files below a folder, links among them, by their paths from it, in order; folders that are empty too.
pub(super) fn tree(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for (path, is_folder) in entries(folder)? {
        let name = PathBuf::from(path.file_name().unwrap_or_default());
        let inner = if is_folder { tree(&path)? } else { Vec::new() };
        match inner.is_empty() {
            true => found.push(name),
            false => found.extend(inner.iter().map(|inner| name.join(inner))),
        }
    }
    Ok(found)
}

/// Has a file or folder written to the device, so that a power cut does not undo it.
pub(super) fn sync(path: &Path) -> io::Result<()> {
    point("sync", path)?;
    // Windows opens no folder as a file, and keeps their entries itself.
    if cfg!(windows) && path.is_dir() {
        return Ok(());
    }
    match File::open(path)?.sync_all() {
        // Some network file systems know no such call for folders.
        Err(error) if is_unsupported(&error) => Ok(()),
        done => done,
    }
}

/// Has a folder and all that is in it written to the device.
pub(super) fn sync_tree(folder: &Path) -> io::Result<()> {
    for (path, is_folder) in entries(folder)? {
        let sync = if is_folder { sync_tree } else { sync };
        sync(&path)?;
    }
    sync(folder)
}

/// Gives a file or folder a mode.
pub(super) fn set_permissions(path: &Path, permissions: Permissions) -> io::Result<()> {
    point("chmod", path)?;
    fs::set_permissions(path, permissions)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_there_is_never_replaced_by_something_new() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        fs::write(at("mine"), "mine").unwrap();
        fs::write(at("new"), "new").unwrap();
        let exists = |error: io::Error| error.kind() == io::ErrorKind::AlreadyExists;
        assert!(exists(create(&at("mine")).unwrap_err()));
        assert!(exists(rename_new(&at("new"), &at("mine")).unwrap_err()));
        #[cfg(unix)]
        {
            // A link to nothing is something, too.
            std::os::unix::fs::symlink(at("nowhere"), at("link")).unwrap();
            assert!(exists(create(&at("link")).unwrap_err()));
            assert!(exists(rename_new(&at("new"), &at("link")).unwrap_err()));
            assert!(!at("nowhere").exists());
        }
        assert_eq!(fs::read_to_string(at("mine")).unwrap(), "mine");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_a_tree_is_removed_and_not_followed() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        fs::create_dir_all(at("tree/inner")).unwrap();
        fs::create_dir(at("thesis")).unwrap();
        fs::write(at("thesis/chapter"), "mine").unwrap();
        std::os::unix::fs::symlink(at("thesis"), at("tree/inner/link")).unwrap();
        assert_eq!(tree(&at("tree")).unwrap(), [Path::new("inner/link")]);
        remove_tree(&at("tree")).unwrap();
        assert!(!at("tree").exists());
        assert_eq!(fs::read_to_string(at("thesis/chapter")).unwrap(), "mine");
    }
}
