//! From a path to text: opening, unpacking, and telling PDB from mmCIF.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use flate2::bufread::GzDecoder;

use crate::molecule::model::format::Format;
use crate::molecule::read::error::ReadError;
use crate::molecule::read::foreign::{Foreign, archive};
use crate::molecule::read::lines::lines;
use crate::molecule::read::record_filter::atom_line::is_atom;
use crate::molecule::read::record_filter::displaced::{Displaced, displaced};

/// The first two bytes of every gzip stream (RFC 1952, section 2.3.1).
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Larger texts are refused: the largest entry of the PDB is about 0.6 GB as mmCIF (3J3Q, 2.4 million atoms).
const LIMIT: u64 = 4 << 30;

/// Bytes that show what is packed in a gzip stream: a block of a tar.
const BLOCK: u64 = 512;

/// A file as unpacked text.
pub(crate) struct Source {
    /// The text; bytes that are not UTF-8 (Latin-1 in old remarks) are replaced.
    pub(crate) text: String,
    /// Whether the file was gzip-compressed.
    pub(crate) compressed: bool,
}

/// The bytes of a structure's file as it stands, packed or not. What is read once can be a pipe.
///
/// # Errors
/// [`ReadError::Missing`], [`ReadError::Directory`], [`ReadError::Unreadable`] and [`ReadError::TooLarge`].
pub fn file_bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
    let file = || path.to_path_buf();
    let unreadable = |source: std::io::Error| match source.kind() {
        ErrorKind::NotFound => ReadError::Missing { file: file() },
        _ => ReadError::Unreadable {
            file: file(),
            source,
        },
    };
    if std::fs::metadata(path).map_err(unreadable)?.is_dir() {
        return Err(ReadError::Directory { file: file() });
    }
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|opened| opened.take(LIMIT + 1).read_to_end(&mut bytes))
        .map_err(unreadable)?;
    within_limit(path, bytes)
}

/// Refuses what is too large.
fn within_limit(path: &Path, bytes: Vec<u8>) -> Result<Vec<u8>, ReadError> {
    if bytes.len() as u64 > LIMIT {
        return Err(ReadError::TooLarge {
            file: path.to_path_buf(),
            limit: LIMIT,
        });
    }
    Ok(bytes)
}

/// Unpacks the bytes of a file, by its magic bytes whatever the name; `path` is for errors.
pub(crate) fn unpack(path: &Path, mut bytes: Vec<u8>) -> Result<Source, ReadError> {
    let compressed = bytes.starts_with(&GZIP_MAGIC);
    let refuse = |foreign: Option<Foreign>| match foreign {
        Some(Foreign { what, remedy }) => Err(ReadError::Foreign {
            file: path.to_path_buf(),
            what,
            remedy,
        }),
        None => Ok(()),
    };
    refuse(archive(&bytes))?;
    if compressed {
        // Of an archive the first block is enough.
        let mut head = Vec::new();
        let first = GzDecoder::new(bytes.as_slice())
            .take(BLOCK)
            .read_to_end(&mut head);
        refuse(first.ok().and_then(|_| archive(&head)))?;
        let unpacked = gunzip(&bytes).map_err(|source| ReadError::Gzip {
            file: path.to_path_buf(),
            source,
        })?;
        bytes = within_limit(path, unpacked)?;
    }
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => String::from_utf8_lossy(error.as_bytes()).into_owned(),
    };
    Ok(Source { text, compressed })
}

/// Unpacks one gzip stream or several in a row (RFC 1952, section 2.2), up to a byte more than [`LIMIT`]. Zeros may
/// follow, as tapes and block devices leave them; gzip passes over them, too.
fn gunzip(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut unpacked = Vec::with_capacity(bytes.len().saturating_mul(4));
    let mut rest = bytes;
    while rest.iter().any(|&byte| byte != 0) {
        if !rest.starts_with(&GZIP_MAGIC) {
            let what = format!("{} bytes follow that are no gzip stream", rest.len());
            return Err(std::io::Error::new(ErrorKind::InvalidData, what));
        }
        let mut decoder = GzDecoder::new(rest);
        let room = (LIMIT + 1).saturating_sub(unpacked.len() as u64);
        decoder.by_ref().take(room).read_to_end(&mut unpacked)?;
        if unpacked.len() as u64 > LIMIT {
            break;
        }
        rest = decoder.into_inner();
    }
    Ok(unpacked)
}

/// The format by content, or by the file's name where the content leaves it open.
///
/// The content decides first because names lie more often: `.pdb` files that hold mmCIF are common in pipelines.
pub(crate) fn format_of(path: &Path, text: &str) -> Option<Format> {
    by_content(text).or_else(|| by_name(path))
}

fn by_content(text: &str) -> Option<Format> {
    for (_, line) in lines(text) {
        if is_atom(line) || matches!(displaced(line), Some(Displaced::Moved(_))) {
            return Some(Format::Pdb);
        }
        let starts = |word: &str| {
            line.get(..word.len())
                .is_some_and(|head| head.eq_ignore_ascii_case(word))
        };
        if starts("data_") || starts("_atom_site.") {
            return Some(Format::Mmcif);
        }
    }
    None
}

fn by_name(path: &Path) -> Option<Format> {
    let name = path.file_name()?.to_str()?.to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    match name.rsplit_once('.')?.1 {
        "pdb" | "ent" => Some(Format::Pdb),
        "cif" | "mmcif" => Some(Format::Mmcif),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_lf_crlf_or_cr() {
        for text in ["a\nb", "a\r\nb", "a\rb", "\u{feff}a\nb"] {
            let found: Vec<_> = lines(text).collect();
            assert_eq!(found, [(1, "a"), (2, "b")], "{text:?}");
        }
    }

    /// gzip reads what a tape or a block device has filled up with zeros; this program said "invalid gzip header".
    #[test]
    fn several_streams_and_zeros_behind_them_are_read() {
        let packed = |text: &str| {
            let mut encoder =
                flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
            std::io::Write::write_all(&mut encoder, text.as_bytes()).unwrap();
            encoder.finish().unwrap()
        };
        let two = [packed("ATOM 1\n"), packed("ATOM 2\n")].concat();
        for zeros in [0, 1, 1000] {
            let padded = [two.clone(), vec![0; zeros]].concat();
            assert_eq!(gunzip(&padded).unwrap(), b"ATOM 1\nATOM 2\n");
        }
        let garbage = gunzip(&[two.as_slice(), b"\0\0more"].concat()).unwrap_err();
        assert!(garbage.to_string().contains("6 bytes follow"), "{garbage}");
        assert!(gunzip(&two[..two.len() - 3]).is_err());
    }

    #[test]
    fn content_decides_the_format_before_the_name() {
        let format = |name: &str, text: &str| format_of(Path::new(name), text);
        assert_eq!(format("x.pdb", "data_1ABC\nloop_\n"), Some(Format::Mmcif));
        assert_eq!(format("x.cif", "REMARK\nATOM      1\n"), Some(Format::Pdb));
        assert_eq!(format("x", "HETATM    1\n"), Some(Format::Pdb));
        assert_eq!(format("x", "ATOM 100000\n"), Some(Format::Pdb));
        assert_eq!(format("pdb1abc.ENT.gz", "HEADER\n"), Some(Format::Pdb));
        assert_eq!(format("x.mmcif", ""), Some(Format::Mmcif));
        assert_eq!(format("x.txt", "hello\n"), None);
    }
}
