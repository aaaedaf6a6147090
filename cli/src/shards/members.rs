//! The members of a file of poses: text packed by gzip, one member a pair, which all readers of gzip take as one text.
//!
//! CSV packed by gzip was chosen over Parquet: the crates `parquet` and `arrow` would double what the program is built
//! of, and a Parquet file ends in an index, so that none can be appended to. Members of gzip can be appended, cut and
//! put in another order without being unpacked.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};

use flate2::Compression;
use flate2::bufread::GzDecoder;
use flate2::write::GzEncoder;

use knotdock::output::files::folder::next_line;

/// Most bytes of a member's text.
const MAX_TEXT: u64 = 64 << 20;

/// Text as a member: the same bytes for the same text.
///
/// # Errors
/// [`io::ErrorKind::FileTooLarge`] for a text of more than 64 MB.
pub(super) fn packed(text: &[u8]) -> io::Result<Vec<u8>> {
    if text.len() as u64 > MAX_TEXT {
        return Err(too_large());
    }
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text)?;
    encoder.finish()
}

/// A member of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Member {
    /// Where it begins and where the next one does, in bytes.
    pub range: (u64, u64),
    /// Its first line, without the line end.
    pub first_line: Vec<u8>,
}

/// Reads the members of a file one by one.
pub(super) struct Members {
    file: BufReader<File>,
}

impl Members {
    /// The members of a file, from its first byte.
    pub fn of(file: File) -> Self {
        Self {
            file: BufReader::with_capacity(1 << 16, file),
        }
    }

    /// The next member; `None` where the file ends or what follows is no whole member.
    ///
    /// # Errors
    /// What the system says about reading, and [`io::ErrorKind::FileTooLarge`] for a member of more than 64 MB.
    pub fn next(&mut self) -> io::Result<Option<Member>> {
        let start = self.file.stream_position()?;
        if self.file.fill_buf()?.is_empty() {
            return Ok(None);
        }
        let mut text = BufReader::new(GzDecoder::new(&mut self.file).take(MAX_TEXT + 1));
        let mut first_line = Vec::new();
        let read = next_line(&mut text, &mut first_line)
            .and_then(|_| io::copy(&mut text, &mut io::sink()));
        match read {
            Ok(_) if text.get_ref().limit() == 0 => return Err(too_large()),
            Ok(_) => {}
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::UnexpectedEof
                        | io::ErrorKind::InvalidInput
                        | io::ErrorKind::InvalidData
                ) =>
            {
                return Ok(None);
            }
            Err(error) => return Err(error),
        }
        Ok(Some(Member {
            range: (start, self.file.stream_position()?),
            first_line,
        }))
    }
}

fn too_large() -> io::Error {
    io::Error::new(
        io::ErrorKind::FileTooLarge,
        "the poses of a pair have more than 64 MB of text",
    )
}

/// Copies a range of bytes of a file.
///
/// # Errors
/// Those of both, and [`io::ErrorKind::UnexpectedEof`] where the file ends before the range.
pub(super) fn copy_range(
    file: &mut File,
    (start, end): (u64, u64),
    to: &mut dyn Write,
) -> io::Result<()> {
    file.seek(SeekFrom::Start(start))?;
    let copied = io::copy(&mut file.take(end - start), to)?;
    if copied < end - start {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(path: &std::path::Path) -> Vec<Member> {
        let mut members = Members::of(File::open(path).unwrap());
        std::iter::from_fn(|| members.next().unwrap()).collect()
    }

    /// A file that is cut or damaged anywhere has the members before that place.
    #[test]
    fn members_end_where_the_file_is_whole_no_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("poses.csv.gz");
        let texts = ["name,rank\n", "a,1\na,2\n", "b,1\n"];
        let packed: Vec<Vec<u8>> = texts
            .iter()
            .map(|text| packed(text.as_bytes()).unwrap())
            .collect();
        let whole = packed.concat();
        std::fs::write(&path, &whole).unwrap();
        let found = all(&path);
        let lines: Vec<&[u8]> = found
            .iter()
            .map(|member| member.first_line.as_slice())
            .collect();
        assert_eq!(lines, [b"name,rank".as_slice(), b"a,1", b"b,1"]);
        assert_eq!(found[2].range.1, whole.len() as u64);
        let mut text = String::new();
        let mut joined = flate2::read::MultiGzDecoder::new(whole.as_slice());
        joined.read_to_string(&mut text).unwrap();
        assert_eq!(text, texts.concat());
        let ends: Vec<usize> = found.iter().map(|member| member.range.1 as usize).collect();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let expected = ends.iter().filter(|end| **end <= length).count();
            assert_eq!(all(&path).len(), expected, "{length}");
        }
        let mut damaged = whole.clone();
        damaged[ends[0] + 15] ^= 0x55;
        std::fs::write(&path, &damaged).unwrap();
        assert_eq!(all(&path).len(), 1);
    }
}
