//! A folder whose files are written elsewhere first: on a disk that is near, and then moved to one that is shared.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::checksum::sha256;
use super::disk;
use super::whole_file::{FileError, parent};

/// Where the files of a folder are while they grow.
#[derive(Debug)]
pub struct Workplace {
    folder: PathBuf,
    /// Where they go in the end, if that is elsewhere.
    place: Option<PathBuf>,
}

impl Workplace {
    /// The place to work on the files of a folder: itself, or a folder in `scratch`, which begins as whichever of the
    /// two has gone further by the length of its `progress` file.
    ///
    /// # Errors
    /// [`FileError`] where a folder cannot be made or copied.
    pub fn open(place: &Path, scratch: Option<&Path>, progress: &str) -> Result<Self, FileError> {
        let unwritable = |path: &Path| {
            let path = path.to_owned();
            move |source| FileError::unwritable(&path, source)
        };
        let Some(scratch) = scratch else {
            disk::create_dir_all(place).map_err(unwritable(place))?;
            return Ok(Self {
                folder: place.to_owned(),
                place: None,
            });
        };
        disk::create_dir_all(parent(place)).map_err(unwritable(place))?;
        let shared = parent(place).canonicalize().map_err(unwritable(place))?;
        let name = place.file_name().unwrap_or_default();
        // Directories of the same name are told apart by where they are.
        let mut own = format!(
            "knotdock-{}-",
            &sha256(shared.to_string_lossy().as_bytes())[..12]
        );
        own += &name.to_string_lossy();
        let folder = scratch.join(own);
        let length =
            |folder: &Path| fs::metadata(folder.join(progress)).map_or(0, |found| found.len());
        if length(place) > length(&folder) {
            disk::create_dir_all(scratch).map_err(unwritable(scratch))?;
            // A copy that is cut short is none.
            let copy = folder.with_extension("new");
            for left in [&folder, &copy] {
                if left.exists() {
                    disk::remove_tree(left).map_err(unwritable(left))?;
                }
            }
            copy_tree(place, &copy)
                .and_then(|()| disk::rename(&copy, &folder))
                .map_err(unwritable(&folder))?;
        }
        disk::create_dir_all(&folder).map_err(unwritable(&folder))?;
        Ok(Self {
            folder,
            place: Some(shared.join(name)),
        })
    }

    /// Where to work.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Puts the files into their place by one rename, and clears the scratch folder.
    ///
    /// # Errors
    /// [`FileError::Write`]; the files are still in the scratch folder then.
    pub fn place(self) -> Result<(), FileError> {
        let Some(place) = &self.place else {
            return Ok(());
        };
        let failed = |source| FileError::writing(place, source);
        let beside = |end: &str| {
            let name = place.file_name().unwrap_or_default().to_string_lossy();
            place.with_file_name(format!(".{name}.{end}"))
        };
        let (new, old) = (beside("new"), beside("old"));
        for left in [&new, &old] {
            if left.exists() {
                disk::remove_tree(left).map_err(failed)?;
            }
        }
        copy_tree(&self.folder, &new)
            .and_then(|()| disk::sync_tree(&new))
            .map_err(failed)?;
        let is_there = place.exists();
        if is_there {
            disk::rename(place, &old).map_err(failed)?;
        }
        disk::rename(&new, place).map_err(failed)?;
        disk::sync(parent(place)).map_err(failed)?;
        if is_there {
            disk::remove_tree(&old).map_err(failed)?;
        }
        disk::remove_tree(&self.folder).map_err(|source| FileError::writing(&self.folder, source))
    }
}

/// Copies a folder with all that is in it to a name that nothing has.
fn copy_tree(from: &Path, to: &Path) -> io::Result<()> {
    disk::create_dir(to)?;
    for (path, is_folder) in disk::entries(from)? {
        let name = path.file_name().unwrap_or_default();
        let copy = to.join(name);
        match is_folder {
            true => copy_tree(&path, &copy)?,
            false => disk::copy(&path, &copy)?,
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_further_of_two_places_is_gone_on_with() {
        let root = tempfile::tempdir().unwrap();
        let (place, scratch) = (root.path().join("shared/part"), root.path().join("scratch"));
        let grow = |folder: &Path, text: &str| fs::write(folder.join("table"), text).unwrap();
        let read = |folder: &Path| fs::read_to_string(folder.join("table")).unwrap();

        let work = Workplace::open(&place, Some(&scratch), "table").unwrap();
        grow(work.folder(), "one");
        // A process that is killed leaves its work, and the next one finds it.
        let work = Workplace::open(&place, Some(&scratch), "table").unwrap();
        assert_eq!(read(work.folder()), "one");
        work.place().unwrap();
        assert_eq!(read(&place), "one");
        assert_eq!(fs::read_dir(&scratch).unwrap().count(), 0);

        let work = Workplace::open(&place, Some(&scratch), "table").unwrap();
        assert_eq!(read(work.folder()), "one");
        grow(work.folder(), "one two");
        grow(&place, "one two three");
        let work = Workplace::open(&place, Some(&scratch), "table").unwrap();
        assert_eq!(read(work.folder()), "one two three");
        work.place().unwrap();
        assert_eq!(read(&place), "one two three");
        assert_eq!(fs::read_dir(root.path().join("shared")).unwrap().count(), 1);
        let work = Workplace::open(&place, None, "table").unwrap();
        assert_eq!(work.folder(), place);
        work.place().unwrap();
    }
}
