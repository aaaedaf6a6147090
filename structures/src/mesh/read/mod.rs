//! From a file to a mesh: STL (text and binary), OBJ, PLY (text and binary) and OFF.
//!
//! Binary PLY is read by the crate `ply-rs-bw`. The others are read here, by a page each, because their crates fall
//! short:
//!
//! - those for STL take a binary file whose header begins with `solid` for text, and keep only the first solid and 24
//!   bits of a number;
//! - neither they nor those for OBJ say on which line a file breaks.
//!
//! What a file begins with decides how it is read, then its name's ending. A file of another kind is refused by name.

pub(super) mod encoding;
pub(super) mod foreign;
pub(super) mod format;
pub(super) mod obj;
pub(super) mod off;
pub(super) mod ply;
pub(super) mod soup;
pub(super) mod stl;
pub(super) mod words;

use std::fs;
use std::io::Read;
use std::path::Path;

use crate::mesh::error::{MeshError, MeshErrorKind};
use crate::mesh::read::encoding::{text_of, unified};
use crate::mesh::read::format::MeshFormat;
use crate::mesh::read::soup::{At, Soup};
use crate::mesh::repair::{repeats, topology, weld};
use crate::mesh::report::{Altered, MeshReport};
use crate::mesh::triangle_mesh::Mesh;

/// Largest file that is read, in bytes: 40 million triangles of binary STL.
const LARGEST_FILE: u64 = 2 << 30;

/// Reads a mesh, welds its vertices, turns its triangles to face outward and reports what was found.
///
/// The format is detected from the first bytes, else from the name's ending. Numbers keep all the digits of the file.
///
/// # Errors
/// [`MeshError`] when the file cannot be read or understood, or when the mesh is empty, flat or degenerate, or has a
/// coordinate that is not finite.
pub fn read(path: &Path) -> Result<(Mesh, MeshReport), MeshError> {
    read_bytes(path, &file_bytes(path)?)
}

/// The bytes of a mesh's file. What is read once can be a pipe.
///
/// # Errors
/// [`MeshError`] when the file cannot be read or is too large.
pub fn file_bytes(path: &Path) -> Result<Vec<u8>, MeshError> {
    let at = |kind| MeshError::at(path, kind);
    let metadata = fs::metadata(path).map_err(|error| {
        at(match error.kind() {
            std::io::ErrorKind::NotFound => MeshErrorKind::Missing,
            _ => MeshErrorKind::Unreadable(error),
        })
    })?;
    if metadata.is_dir() {
        return Err(at(MeshErrorKind::Directory));
    }
    let too_large = |bytes: String| {
        at(MeshErrorKind::TooLarge(format!(
            "{bytes} bytes, where {LARGEST_FILE} are read"
        )))
    };
    if metadata.len() > LARGEST_FILE {
        return Err(too_large(metadata.len().to_string()));
    }
    // A pipe has no length beforehand.
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    fs::File::open(path)
        .and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes))
        .map_err(|error| at(MeshErrorKind::Unreadable(error)))?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(too_large(format!("more than {LARGEST_FILE}")));
    }
    Ok(bytes)
}

/// As [`read`], of a file's bytes; the path's ending decides the format where they leave it open.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(path: &Path, bytes: &[u8]) -> Result<(Mesh, MeshReport), MeshError> {
    let at = |kind| MeshError::at(path, kind);
    let bytes = unified(bytes);
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let named = || match ending.as_deref() {
        Some("stl") => Some(MeshFormat::Stl),
        Some("obj") => Some(MeshFormat::Obj),
        Some("ply") => Some(MeshFormat::Ply),
        Some("off") => Some(MeshFormat::Off),
        _ => None,
    };
    match sure_format(&bytes).or_else(named) {
        Some(format) => parse(&bytes, format).map_err(at),
        None => {
            foreign::refuse(&bytes).map_err(at)?;
            Err(at(MeshErrorKind::UnknownFormat))
        }
    }
}

/// The format, where what the file begins with leaves no doubt.
fn sure_format(bytes: &[u8]) -> Option<MeshFormat> {
    if ply::begins(bytes) {
        return Some(MeshFormat::Ply);
    }
    if stl::has_records(bytes) {
        return Some(MeshFormat::Stl);
    }
    let text = text_of(bytes)?;
    if stl::begins(&text) {
        Some(MeshFormat::Stl)
    } else if off::begins(&text) {
        Some(MeshFormat::Off)
    } else {
        obj::begins(&text).then_some(MeshFormat::Obj)
    }
}

/// Reads a mesh from the bytes of a file.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], format: MeshFormat) -> Result<(Mesh, MeshReport), MeshErrorKind> {
    let bytes = unified(bytes);
    if sure_format(&bytes) != Some(format) {
        foreign::refuse(&bytes)?;
    }
    let text = || {
        text_of(&bytes).ok_or_else(|| MeshErrorKind::Syntax {
            line: None,
            what: "these are binary data, where the format is a text".to_owned(),
        })
    };
    let mut soup = match format {
        MeshFormat::Stl => stl::parse(&bytes),
        MeshFormat::Obj => obj::parse(&text()?),
        MeshFormat::Ply => ply::parse(&bytes),
        MeshFormat::Off => off::parse(&text()?),
    }?;
    soup.settle()?;
    assemble(soup, Some(format))
}

/// A mesh from vertices (any unit) and triangles of their indices, treated as one read from a file.
///
/// # Errors
/// [`MeshErrorKind`] when an index is out of range or the mesh is unusable.
pub fn from_triangles(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
) -> Result<(Mesh, MeshReport), MeshErrorKind> {
    let mut soup = Soup::default();
    for &position in positions {
        soup.push_vertex(position, None)?;
    }
    for &index in triangles.iter().flatten() {
        if index as usize >= positions.len() {
            return Err(MeshErrorKind::Index {
                line: None,
                index: i64::from(index),
                vertices: positions.len(),
            });
        }
    }
    for triangle in triangles {
        soup.push_face(triangle, At::Face(0));
    }
    soup.settle()?;
    assemble(soup, None)
}

/// Welds, checks and orients.
fn assemble(soup: Soup, format: Option<MeshFormat>) -> Result<(Mesh, MeshReport), MeshErrorKind> {
    if soup.faces.is_empty() {
        return Err(MeshErrorKind::Empty);
    }
    let read_vertices = soup.positions.len();
    let read_triangles = soup.faces.triangle_count();
    let welded = weld::weld(soup.positions, soup.faces, &soup.digits)?;
    let altered = Altered {
        collapsed: read_triangles - welded.triangles.len(),
        times: 1,
        seam_vertices: welded.seam_vertices,
        weld_reach: welded.reach,
        notes: soup.notes.into_sentences(),
    };
    let mut triangles = welded.triangles;
    let times = repeats::keep_first(&mut triangles);
    let mut mesh = Mesh {
        positions: welded.positions,
        triangles,
        closed: false,
    };
    if mesh
        .triangles
        .iter()
        .all(|&triangle| mesh.is_sliver(triangle))
    {
        return Err(MeshErrorKind::Degenerate {
            triangles: read_triangles,
        });
    }
    if mesh.is_flat() {
        return Err(MeshErrorKind::Flat);
    }
    let topology = topology::orient(&mut mesh)?;
    mesh.closed = topology.unbalanced_edges == 0;
    let report = MeshReport::new(
        &mesh,
        format,
        read_vertices,
        read_triangles,
        Altered { times, ..altered },
        &topology,
    );
    Ok((mesh, report))
}
