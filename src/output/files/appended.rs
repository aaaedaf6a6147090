//! A file that grows by whole entries.

use crate::output::files::file_error;
use knotdock_structures::Error;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::disk;
use super::fault::point;

/// A file to which entries are appended, each to the device before the next.
///
/// An entry that is cut short, by a kill or a full disk, is no entry. The next caller opens the file at the end of the
/// last whole one, and the rest is cut off.
#[derive(Debug)]
pub struct AppendedFile {
    file: File,
    path: PathBuf,
    length: u64,
}

impl AppendedFile {
    /// Opens a file after its first `length` bytes; the rest is cut off. A missing file is made; no link is followed.
    pub fn open(path: &Path, length: u64) -> Result<Self, Error> {
        let failed = |source| file_error::unwritable(path, source);
        point("open", path).map_err(failed)?;
        let mut file = match disk::create(path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                let file = disk::open(path, File::options().write(true)).map_err(failed)?;
                if !disk::has_one_name(&file).map_err(failed)? {
                    return Err(failed(io::Error::other("it has another name, too")));
                }
                file
            }
            made => made.map_err(failed)?,
        };
        let cut = |file: &mut File| {
            if file.metadata()?.len() != length {
                point("cut", path)?;
                file.set_len(length)?;
            }
            file.seek(SeekFrom::Start(length)).map(drop)
        };
        cut(&mut file).map_err(failed)?;
        Ok(Self {
            file,
            path: path.to_owned(),
            length,
        })
    }

    /// Start of the next entry, in bytes.
    pub fn end(&self) -> u64 {
        self.length
    }

    /// Appends an entry, to the device; returns its start and end. One that cannot be written whole is taken back.
    pub fn append(&mut self, entry: &[u8]) -> Result<(u64, u64), Error> {
        let written = self.write(entry);
        if written.is_err() {
            // A rest that stays is cut off when the file is opened again.
            let _ = self.file.set_len(self.length);
            let _ = self.file.seek(SeekFrom::Start(self.length));
        }
        written.map_err(|source| file_error::writing(&self.path, source))?;
        let start = self.length;
        self.length += entry.len() as u64;
        Ok((start, self.length))
    }

    fn write(&mut self, entry: &[u8]) -> io::Result<()> {
        // Two halves, so that tests can end the program between them.
        let (first, second) = entry.split_at(entry.len() / 2);
        point("append", &self.path)?;
        self.file.write_all(first)?;
        point("append", &self.path)?;
        self.file.write_all(second)?;
        point("sync", &self.path)?;
        self.file.sync_data()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_follow_the_last_whole_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let mut file = AppendedFile::open(&path, 0).unwrap();
        file.append(b"one\n").unwrap();
        file.append(b"two\n").unwrap();
        drop(file);
        std::fs::write(&path, "one\ntwo\nthr").unwrap();
        let mut file = AppendedFile::open(&path, 8).unwrap();
        file.append(b"four\n").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "one\ntwo\nfour\n");
    }
}
