//! Small files whole: options, records, tables and potentials, each within a bound on its size.
//!
//! A name may be that of an endless device (`/dev/zero`) or of a file far larger than any of these. Nothing beyond the
//! bound is read. The readers of structures and meshes have bounds too.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use crate::memory_size::in_words;

/// Most bytes of a file of options and of a cost model: both are written by hand or hold a few numbers.
pub const MAX_OPTIONS: u64 = 1 << 20;

/// Most bytes of a table of potentials or of a batch's results.
pub const MAX_TABLE: u64 = 64 << 20;

/// Most bytes of a table of pairs: some five million rows.
pub const MAX_PAIRS: u64 = 256 << 20;

/// Most bytes of a file of distance restraints.
pub const MAX_RESTRAINTS: u64 = 16 << 20;

/// Most bytes of a `run.json`, which lists the residues left out of the inputs.
pub const MAX_RECORD: u64 = 256 << 20;

/// Most bytes of a table of poses: ten million rows, the most that a run keeps.
pub const MAX_POSES: u64 = 4 << 30;

/// Most bytes of a pipe or a device, whose size is not known before it is read.
const MAX_PIPED: u64 = 256 << 20;

/// Reads a file of at most `limit` bytes, or a pipe to its end.
///
/// # Errors
/// What the system reports, and [`ErrorKind::FileTooLarge`] with the limit.
pub fn read_bounded(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    match metadata.is_file() {
        true if metadata.len() > limit => Err(too_large(limit)),
        true => bounded(file, limit),
        false => bounded(file, limit.min(MAX_PIPED)),
    }
}

/// As [`read_bounded`], for a name that the program expects in a folder: a pipe or a device is an
/// [`ErrorKind::InvalidInput`] and not opened, since the opening of a pipe waits for whoever writes to it.
pub fn read_bounded_file(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let kind = fs::metadata(path)?.file_type();
    if kind.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    if !kind.is_file() {
        return Err(io::Error::new(
            ErrorKind::InvalidInput,
            "it is a pipe or a device, where a file is needed",
        ));
    }
    read_bounded(path, limit)
}

/// As [`read_bounded`], of a text in UTF-8; any other is an [`ErrorKind::InvalidData`].
pub fn read_bounded_text(path: &Path, limit: u64) -> io::Result<String> {
    String::from_utf8(read_bounded(path, limit)?)
        .map_err(|_| io::Error::new(ErrorKind::InvalidData, "it is not text in UTF-8"))
}

/// All that there is to read, if that is within the limit.
fn bounded(source: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        return Err(too_large(limit));
    }
    Ok(bytes)
}

fn too_large(limit: u64) -> io::Error {
    let most = in_words(limit);
    let message = format!("it has more than {most}, the most that are read of it");
    io::Error::new(ErrorKind::FileTooLarge, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_end_is_read_up_to_the_limit() {
        let read = std::cell::Cell::new(0);
        struct Counted<'a>(&'a std::cell::Cell<u64>);
        impl Read for Counted<'_> {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                self.0.set(self.0.get() + buffer.len() as u64);
                buffer.fill(0);
                Ok(buffer.len())
            }
        }
        let error = bounded(Counted(&read), 1000).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        assert!(error.to_string().contains("more than 1 kB"));
        assert_eq!(read.get(), 1001);
        assert_eq!(bounded(&[7; 1000][..], 1000).unwrap(), [7; 1000]);
        assert!(bounded(&[7; 1001][..], 1000).is_err());
    }

    #[test]
    fn a_text_is_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        std::fs::write(&path, b"\xff").unwrap();
        let error = read_bounded_text(&path, 10).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidData);
        std::fs::write(&path, "Å").unwrap();
        assert_eq!(read_bounded_text(&path, 2).unwrap(), "Å");
        assert!(read_bounded_text(&path, 1).is_err());
        assert!(read_bounded_file(folder.path(), 10).is_err());
    }
}
