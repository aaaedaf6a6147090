//! From a path to text: opening, unpacking, and telling PDB from mmCIF and from files of other kinds.
//!
//! An archive may begin like a structure: a tar of PDB files has their records in it, and between them what no reader
//! should see.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use flate2::bufread::GzDecoder;

use crate::Error;
use crate::molecule::model::Format;
use crate::molecule::read::pdb_columns::atom_line;

/// The first two bytes of every gzip stream (RFC 1952, section 2.3.1).
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Larger texts are refused: the largest entry of the PDB is about 0.6 GB as mmCIF (3J3Q, 2.4 million atoms).
const LIMIT: u64 = 4 << 30;

/// Bytes that show what is packed in a gzip stream: a block of a tar.
const BLOCK: u64 = 512;

pub(crate) struct Source {
    /// The text; bytes that are not UTF-8 (Latin-1 in old remarks) are replaced.
    pub(crate) text: String,
    pub(crate) compressed: bool,
    pub(crate) format: Format,
}

/// The lines of a text with 1-based numbers, whatever ends them: LF, CR LF, or the lone CR of old systems.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let numbered = text.split(end).zip(1..);
    numbered.map(|(line, number)| (number, line.strip_suffix('\r').unwrap_or(line)))
}

/// The bytes of a structure's file as it stands, packed or not. What is read once can be a pipe.
///
/// # Errors
/// There is no such file, it is a directory, it cannot be read, or it is too large.
pub fn file_bytes(path: &Path) -> Result<Vec<u8>, Error> {
    let unreadable = |error: std::io::Error| {
        match error.kind() {
        ErrorKind::NotFound if path.to_string_lossy().contains(',') => {
            Error::input("there is no such file").help(
                "give one file for each side, and further conformations with --receptor-also or --ligand-also; chains \
                 are picked with FILE:H,L",
            )
        }
        ErrorKind::NotFound => Error::input("there is no such file").help(
            "check the path; chains are picked with FILE:H,L and residues with FILE:H:1-120",
        ),
        _ => Error::input(format!("the file cannot be read: {error}"))
            .help("check the permissions of the file and that it is on a readable disk"),
    }
    };
    let read = || {
        if std::fs::metadata(path).map_err(unreadable)?.is_dir() {
            return Err(Error::input("this is a directory, not a structure file")
                .help("name one .pdb, .ent, .cif or .mmcif file, plain or .gz"));
        }
        let mut bytes = Vec::new();
        let opened = File::open(path).map_err(unreadable)?;
        opened
            .take(LIMIT + 1)
            .read_to_end(&mut bytes)
            .map_err(unreadable)?;
        within_limit(bytes)
    };
    read().map_err(|error| error.at(path))
}

fn within_limit(bytes: Vec<u8>) -> Result<Vec<u8>, Error> {
    if bytes.len() as u64 > LIMIT {
        let message = format!("the file is larger than {LIMIT} bytes once unpacked");
        let remedy = "cut the file down to the chains and the model to be docked";
        return Err(Error::input(message).help(remedy));
    }
    Ok(bytes)
}

/// Unpacks the bytes of a file, by its magic bytes whatever the name, and detects the format. `path` is the file's name.
pub(crate) fn unpack(path: &Path, mut bytes: Vec<u8>) -> Result<Source, Error> {
    let compressed = bytes.starts_with(&GZIP_MAGIC);
    refuse_archive(&bytes)?;
    if compressed {
        // Of an archive the first block is enough.
        let mut head = Vec::new();
        let first = GzDecoder::new(bytes.as_slice())
            .take(BLOCK)
            .read_to_end(&mut head);
        first.map_or(Ok(()), |_| refuse_archive(&head))?;
        let unpacked = gunzip(&bytes).map_err(|error| {
            Error::input(format!("the gzip data cannot be unpacked: {error}"))
                .help("fetch the file again, or unpack it with gunzip to see where it breaks")
        })?;
        bytes = within_limit(unpacked)?;
    }
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => String::from_utf8_lossy(error.as_bytes()).into_owned(),
    };
    let format = format_of(path, &text).ok_or_else(|| not_a_structure(path))?;
    Ok(Source {
        text,
        compressed,
        format,
    })
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
fn format_of(path: &Path, text: &str) -> Option<Format> {
    let by_line = |(_, line): (usize, &str)| {
        let starts = |word: &str| {
            let head = line.get(..word.len());
            head.is_some_and(|head| head.eq_ignore_ascii_case(word))
        };
        if atom_line(line).is_some_and(|line| line.text().is_some()) {
            Some(Format::Pdb)
        } else {
            (starts("data_") || starts("_atom_site.")).then_some(Format::Mmcif)
        }
    };
    let by_name = || match ending(path)?.as_str() {
        "pdb" | "ent" => Some(Format::Pdb),
        "cif" | "mmcif" => Some(Format::Mmcif),
        _ => None,
    };
    lines(text).find_map(by_line).or_else(by_name)
}

/// The ending of a file's name in small letters, without that of gzip.
fn ending(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?.to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    Some(name.rsplit_once('.')?.1.to_owned())
}

fn foreign(what: &str, remedy: &str) -> Error {
    Error::input(format!("this is {what}, not a PDB or mmCIF file")).help(remedy)
}

/// The error of a file whose text shows no known format.
pub(crate) fn not_a_structure(path: &Path) -> Error {
    let ending = ending(path).unwrap_or_default();
    match ENDINGS.iter().find(|(known, ..)| *known == ending) {
        Some((_, what, remedy)) => foreign(what, remedy),
        None => Error::input("this is not a structure: no PDB record and no mmCIF data block was found").help(
            "give a PDB or mmCIF file, plain or gzip-compressed; BinaryCIF, XML and other compressions are not read",
        ),
    }
}

/// Refuses bytes, packed or unpacked, that are an archive's or of another compression than gzip.
fn refuse_archive(bytes: &[u8]) -> Result<(), Error> {
    if bytes.get(USTAR..USTAR + 5) == Some(b"ustar") {
        return Err(foreign("a tar archive", UNPACK));
    }
    let found = MAGIC.iter().find(|(magic, ..)| bytes.starts_with(magic));
    found.map_or(Ok(()), |(_, what, remedy)| Err(foreign(what, remedy)))
}

/// Offset of a tar's magic bytes (POSIX.1-1988, ustar).
const USTAR: usize = 257;

const UNPACK: &str =
    "unpack it and give one of its structure files, .pdb or .cif, plain or gzip-compressed";
const GUNZIP: &str = "unpack it, and give the structure file plain or gzip-compressed";
const CONVERT: &str =
    "give a PDB or mmCIF file: Open Babel converts it, as in `obabel FILE -O OUT.pdb`";
const TOPOLOGY: &str = "give a PDB or mmCIF file: GROMACS writes one by `gmx editconf -f IN.gro -o OUT.pdb`, other programs alike";
const TABLE: &str =
    "give a PDB or mmCIF file: the archive has every entry in mmCIF, and gemmi and PyMOL convert";

const MAGIC: [(&[u8], &str, &str); 7] = [
    (b"PK\x03\x04", "a zip archive", UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", UNPACK),
    (b"Rar!\x1a\x07", "a rar archive", UNPACK),
    (b"BZh", "compressed by bzip2", GUNZIP),
    (b"\xfd7zXZ\x00", "compressed by xz", GUNZIP),
    (b"\x28\xb5\x2f\xfd", "compressed by zstd", GUNZIP),
    (b"\x1f\x9d", "compressed by compress", GUNZIP),
];

const ENDINGS: [(&str, &str, &str); 18] = [
    ("sdf", "an SDF file of small molecules", CONVERT),
    ("sd", "an SDF file of small molecules", CONVERT),
    ("mol", "a MOL file of a small molecule", CONVERT),
    ("mol2", "a MOL2 file", CONVERT),
    ("xyz", "an XYZ file", CONVERT),
    ("smi", "a SMILES file", CONVERT),
    ("cml", "a CML file", CONVERT),
    ("mae", "a Maestro file", CONVERT),
    ("maegz", "a Maestro file", CONVERT),
    ("gro", "a GROMACS file", TOPOLOGY),
    ("crd", "a coordinate file of a force field", TOPOLOGY),
    ("psf", "a topology of a force field", TOPOLOGY),
    ("prmtop", "a topology of a force field", TOPOLOGY),
    ("xtc", "a trajectory", TOPOLOGY),
    ("dcd", "a trajectory", TOPOLOGY),
    ("bcif", "a BinaryCIF file", TABLE),
    ("mmtf", "an MMTF file", TABLE),
    ("pdbml", "a PDBML file", TABLE),
];

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

    #[test]
    fn archives_are_known_by_their_first_bytes() {
        let mut tar = vec![0; 512];
        tar[USTAR..USTAR + 5].copy_from_slice(b"ustar");
        let refusal = |bytes: &[u8]| refuse_archive(bytes).unwrap_err();
        assert!(refusal(&tar).message().contains("a tar archive"));
        assert!(
            refusal(b"PK\x03\x04...")
                .message()
                .contains("a zip archive")
        );
        assert_eq!(refusal(b"BZh91").remedy(), Some(GUNZIP));
        assert_eq!(refuse_archive(b"ATOM      1"), Ok(()));
        assert_eq!(refuse_archive(b""), Ok(()));
    }

    #[test]
    fn other_formats_are_known_by_their_names() {
        for name in ["x.sdf", "x.MOL2", "a.b.xyz.gz"] {
            let error = not_a_structure(Path::new(name));
            assert_eq!(error.remedy(), Some(CONVERT), "{name}");
        }
        for name in ["x.pdb", "x", "x.txt", "sdf"] {
            let error = not_a_structure(Path::new(name));
            assert!(error.message().contains("not a structure"), "{name}");
        }
    }
}
