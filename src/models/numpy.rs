//! Arrays as NumPy writes them: `.npy`, and `.npz`, which is a zip of them.
//!
//! Format: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>. Numbers are floats of 4 or 8
//! bytes, little-endian, in C order. No more is unpacked than the header of an array claims, and no more is claimed than
//! [`MAX_VALUES`].

use std::io::Read;

use flate2::bufread::DeflateDecoder;
use knotdock_structures::Error;
use rawzip::{CompressionMethod, ZipArchive};

/// Most values of an array: the PAE of 10,000 tokens.
pub const MAX_VALUES: usize = 100_000_000;

/// First bytes of a `.npy` file.
pub const NPY: &[u8] = b"\x93NUMPY";
/// First bytes of a `.npz` file.
pub const NPZ: &[u8] = b"PK";

/// Most bytes that one byte packed by DEFLATE can become (RFC 1951: 258 bytes by two bits).
const MAX_RATIO: usize = 1032;
/// Most bytes of a header.
const MAX_HEADER: usize = 1 << 16;

/// An array of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Length along each axis.
    pub shape: Vec<usize>,
    /// The values, row-major.
    pub values: Vec<f32>,
}

/// Reads a `.npy` file.
///
/// # Errors
/// [`Error`] for another format, other numbers, too many of them, or too few in the file.
pub fn read_npy(bytes: &[u8]) -> Result<Array, Error> {
    read_array(bytes, bytes.len())
}

/// Reads those arrays of a `.npz` file that have one of some names.
///
/// # Errors
/// [`Error`] for a damaged archive, another method of packing than DEFLATE, and as [`read_npy`] for each array.
pub fn read_npz(bytes: &[u8], wanted: &[&str]) -> Result<Vec<(String, Array)>, Error> {
    let archive = ZipArchive::from_slice(bytes).map_err(damaged)?;
    let mut entries = archive.entries();
    let mut arrays: Vec<(String, Array)> = Vec::new();
    while let Some(entry) = entries.next_entry().map_err(damaged)? {
        let name = String::from_utf8_lossy(entry.file_path().as_bytes()).into_owned();
        let Some(name) = name.strip_suffix(".npy") else {
            continue;
        };
        if !wanted.contains(&name) {
            continue;
        }
        if arrays.iter().any(|(other, _)| other == name) {
            return Err(damaged(format!("it holds `{name}` twice")));
        }
        let local = archive.get_entry(entry.wayfinder()).map_err(damaged)?;
        let packed = local.data();
        let array = match entry.compression_method() {
            CompressionMethod::STORE => read_array(local.verifying_reader(packed), packed.len()),
            CompressionMethod::DEFLATE => read_array(
                local.verifying_reader(DeflateDecoder::new(packed)),
                packed.len().saturating_mul(MAX_RATIO),
            ),
            _ => Err(damaged("it is packed by another method than DEFLATE")),
        };
        arrays.push((name.to_owned(), array.map_err(|error| error.within(name))?));
    }
    Ok(arrays)
}

fn damaged(fault: impl std::fmt::Display) -> Error {
    Error::input(format!("the arrays cannot be read: {fault}"))
        .help("give the .npz or .npy file as the program wrote it, or write it again by numpy.savez_compressed")
}

/// Reads an array from a stream of at most `bytes` bytes.
fn read_array(mut stream: impl Read, bytes: usize) -> Result<Array, Error> {
    let mut start = [0; 8];
    stream.read_exact(&mut start).map_err(damaged)?;
    if !start.starts_with(NPY) {
        return Err(damaged("it does not begin as a .npy file"));
    }
    let length = match start[6] {
        1 => {
            let mut length = [0; 2];
            stream.read_exact(&mut length).map_err(damaged)?;
            usize::from(u16::from_le_bytes(length))
        }
        2 | 3 => {
            let mut length = [0; 4];
            stream.read_exact(&mut length).map_err(damaged)?;
            u32::from_le_bytes(length) as usize
        }
        version => return Err(damaged(format!("version {version} of .npy is unknown"))),
    };
    if length > MAX_HEADER {
        return Err(damaged("its header is too long"));
    }
    let mut header = vec![0; length];
    stream.read_exact(&mut header).map_err(damaged)?;
    let header = String::from_utf8_lossy(&header);
    let width = match entry_of(&header, "descr") {
        Some("'<f4'") => 4,
        Some("'<f8'") => 8,
        kind => {
            let kind = kind.unwrap_or("nothing");
            return Err(damaged(format!(
                "its numbers are {kind}, not '<f4' or '<f8'"
            )));
        }
    };
    if entry_of(&header, "fortran_order") != Some("False") {
        return Err(damaged("it is not in C order"));
    }
    let shape = entry_of(&header, "shape").and_then(shape_of);
    let shape = shape.ok_or_else(|| damaged("its shape is unknown"))?;
    let count = shape
        .iter()
        .try_fold(1_usize, |all, &one| all.checked_mul(one));
    let count = count.filter(|&count| count <= MAX_VALUES);
    let count = count.ok_or_else(|| damaged(format!("it has more than {MAX_VALUES} values")))?;
    if count * width > bytes {
        return Err(damaged(format!(
            "its header claims {count} values, which the file is too short for"
        )));
    }
    let mut values = Vec::with_capacity(count);
    let mut buffer = [0; 1 << 15];
    while values.len() < count {
        let part = (count - values.len())
            .saturating_mul(width)
            .min(buffer.len());
        let part = &mut buffer[..part];
        stream.read_exact(part).map_err(damaged)?;
        match width {
            4 => values.extend(
                part.as_chunks::<4>()
                    .0
                    .iter()
                    .copied()
                    .map(f32::from_le_bytes),
            ),
            _ => {
                let wide = part
                    .as_chunks::<8>()
                    .0
                    .iter()
                    .copied()
                    .map(f64::from_le_bytes);
                values.extend(wide.map(|value| value as f32));
            }
        }
    }
    // The end, where the checksum is verified.
    match stream.read(&mut buffer[..1]).map_err(damaged)? {
        0 => Ok(Array { shape, values }),
        _ => Err(damaged("it has more values than its header claims")),
    }
}

/// The value of a key in the header, a Python dictionary such as
/// `{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }`.
fn entry_of<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = header.split_once(&format!("'{key}':"))?;
    let rest = rest.trim_start();
    let end = match rest.strip_prefix('(') {
        Some(inner) => inner.find(')')? + 2,
        None => rest.find([',', '}'])?,
    };
    rest.get(..end).map(str::trim)
}

/// The numbers of a tuple such as `(2, 3)`, `(2,)` or `()`.
fn shape_of(tuple: &str) -> Option<Vec<usize>> {
    let inner = tuple.strip_prefix('(')?.strip_suffix(')')?;
    let numbers = inner
        .split(',')
        .map(str::trim)
        .filter(|one| !one.is_empty());
    numbers.map(|one| one.parse().ok()).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use std::io::Write;

    use super::*;

    /// A `.npy` file.
    pub(crate) fn npy(shape: &str, values: &[f32]) -> Vec<u8> {
        let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut bytes = [NPY, &[1, 0], &(header.len() as u16).to_le_bytes()].concat();
        bytes.extend(header.bytes());
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        bytes
    }

    /// A `.npz` file, as `numpy.savez_compressed` writes it.
    pub(crate) fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut archive = rawzip::ZipArchiveWriter::new(&mut bytes);
        for (name, array) in arrays {
            let name = format!("{name}.npy");
            let method = CompressionMethod::DEFLATE;
            let (mut entry, config) = archive
                .new_file(&name)
                .compression_method(method)
                .start()
                .unwrap();
            let packer =
                flate2::write::DeflateEncoder::new(&mut entry, flate2::Compression::default());
            let mut writer = config.wrap(packer);
            writer.write_all(array).unwrap();
            let (packer, descriptor) = writer.finish().unwrap();
            packer.finish().unwrap();
            entry.finish(descriptor).unwrap();
        }
        archive.finish().unwrap();
        bytes
    }

    #[test]
    fn arrays_come_back() {
        let array = Array {
            shape: vec![2, 3],
            values: vec![0.0, 1.5, -2.0, 3.0, 4.25, 1e30],
        };
        let file = npy("(2, 3)", &array.values);
        assert_eq!(read_npy(&file).unwrap(), array);
        let archive = npz(&[("pae", file.clone()), ("other", b"no array".to_vec())]);
        let found = read_npz(&archive, &["pae"]).unwrap();
        assert_eq!(found, [("pae".to_owned(), array.clone())]);
        let scalar = read_npy(&npy("()", &[0.5])).unwrap();
        assert_eq!((scalar.shape.len(), scalar.values), (0, vec![0.5]));
        let wide = String::from_utf8_lossy(&file).contains("<f4");
        assert!(wide);
        let mut wide = npy("(2,)", &[]);
        let at = wide.windows(3).position(|part| part == b"<f4").unwrap();
        wide[at + 2] = b'8';
        wide.extend([2.5_f64, -1.0].iter().flat_map(|value| value.to_le_bytes()));
        assert_eq!(read_npy(&wide).unwrap().values, [2.5, -1.0]);
    }

    /// Claims that the file cannot keep, and bytes beyond them, are refused before they cost memory.
    #[test]
    fn bombs_and_torn_files_are_refused() {
        let file = npy("(2, 3)", &[0.0; 6]);
        let torn = &file[..file.len() - 1];
        let longer = [file.as_slice(), &[0]].concat();
        let huge = npy("(10000, 10001)", &[0.0; 6]);
        let claim = npy("(9999, 9999)", &[0.0; 6]);
        let overflow = npy("(4294967296, 4294967296)", &[]);
        for (bytes, part) in [
            (torn, "too short"),
            (&longer, "more values than"),
            (&huge, "more than 100000000"),
            (&claim, "too short"),
            (&overflow, "more than"),
            (b"\x93NUMPY\x01\0\x02\0{}".as_slice(), "not '<f4'"),
            (b"PK", "begin as a .npy"),
        ] {
            let error = read_npy(bytes).unwrap_err();
            let bytes = format!("{:?}", &bytes[..bytes.len().min(80)]);
            let is_short = error.message().contains("failed to fill");
            assert!(
                error.message().contains(part) || is_short,
                "{error}: {bytes}"
            );
            assert!(error.remedy().is_some());
        }
        // A megabyte of zeros in a kilobyte, of which the header claims six.
        let bomb = npz(&[("pae", [file.as_slice(), &vec![0; 1 << 20]].concat())]);
        let error = read_npz(&bomb, &["pae"]).unwrap_err();
        assert!(error.message().contains("more values than"), "{error}");
        let claim = npz(&[("pae", claim)]);
        let error = read_npz(&claim, &["pae"]).unwrap_err();
        assert!(error.message().contains("too short"), "{error}");
        let mut damaged = npz(&[("pae", file)]);
        damaged[50] ^= 0x55;
        assert!(read_npz(&damaged, &["pae"]).is_err());
    }
}
