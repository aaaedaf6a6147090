//! From a file to a mesh: STL (text and binary), OBJ, PLY (text and binary) and OFF.
//!
//! PLY is read by the crate `ply-rs-bw`. The other three are read here, by a page each: the crates for STL take a binary
//! file whose header begins with `solid` for text, keep only the first solid and 24 bits of a number, and neither they nor
//! those for OBJ say on which line a file breaks.

mod obj;
mod off;
mod ply;
mod polygon;
mod stl;
mod words;

use std::fs;
use std::io::Read;
use std::path::Path;

use serde::Serialize;

use super::error::{MeshError, MeshErrorKind};
use super::report::{Dropped, MeshReport};
use super::{Mesh, repeats, topology, weld};

/// File format of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MeshFormat {
    /// Stereolithography, text or binary.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// Stanford polygon format, text or binary.
    Ply,
    /// Object file format of Geomview.
    Off,
}

/// Largest file that is read, in bytes: 40 million triangles of binary STL.
const LARGEST_FILE: u64 = 2 << 30;

/// Largest magnitude of a coordinate: squares and cubes of lengths stay finite.
const LARGEST_COORDINATE: f64 = 1e70;

/// Polygons as a file lists them, cut into triangles.
#[derive(Debug, Default)]
struct Soup {
    /// Vertices, in the file's order and unit.
    positions: Vec<[f64; 3]>,
    /// Triangles of vertex indices, each below the number of `positions`.
    triangles: Vec<[u32; 3]>,
}

impl Soup {
    /// Adds a vertex, refusing what no distance can be computed from.
    fn push_vertex(
        &mut self,
        position: [f64; 3],
        line: Option<usize>,
    ) -> Result<u32, MeshErrorKind> {
        let index = self.positions.len();
        for value in position {
            if value.is_nan() || value.abs() > LARGEST_COORDINATE {
                return Err(MeshErrorKind::Coordinate {
                    line,
                    what: format!("vertex {}", index + 1),
                    value,
                });
            }
        }
        let Ok(name) = u32::try_from(index) else {
            return Err(MeshErrorKind::TooLarge(format!(
                "more than {} vertices",
                u32::MAX
            )));
        };
        self.positions.push(position);
        Ok(name)
    }

    /// Adds a face of three or more vertices, cut into triangles.
    fn push_face(&mut self, corners: &[u32]) {
        polygon::triangulate(&self.positions, corners, &mut self.triangles);
    }
}

/// Reads a mesh, welds its vertices, turns its triangles to face outward and reports what was found.
///
/// The format is told by the first bytes, else by the name's ending. Numbers keep all the digits of the file.
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

/// As [`read`], of a file's bytes; the path's ending tells the format where they leave it open.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(path: &Path, bytes: &[u8]) -> Result<(Mesh, MeshReport), MeshError> {
    let at = |kind| MeshError::at(path, kind);
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let format =
        tell_format(bytes, ending.as_deref()).ok_or_else(|| at(MeshErrorKind::UnknownFormat))?;
    parse(bytes, format).map_err(at)
}

/// The format, by what the file begins with where that is sure, else by the ending.
fn tell_format(bytes: &[u8], ending: Option<&str>) -> Option<MeshFormat> {
    let start = bytes.trim_ascii_start();
    if start.starts_with(b"ply") && start.get(3).is_some_and(u8::is_ascii_whitespace) {
        return Some(MeshFormat::Ply);
    }
    if stl::is_binary(bytes) {
        return Some(MeshFormat::Stl);
    }
    match ending {
        Some("stl") => return Some(MeshFormat::Stl),
        Some("obj") => return Some(MeshFormat::Obj),
        Some("ply") => return Some(MeshFormat::Ply),
        Some("off") => return Some(MeshFormat::Off),
        _ => {}
    }
    if start.starts_with(b"OFF") || start.starts_with(b"NOFF") || start.starts_with(b"COFF") {
        return Some(MeshFormat::Off);
    }
    let is_solid = |word: &[u8]| word.eq_ignore_ascii_case(b"solid");
    start
        .get(..5)
        .is_some_and(is_solid)
        .then_some(MeshFormat::Stl)
}

/// Reads a mesh from the bytes of a file.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], format: MeshFormat) -> Result<(Mesh, MeshReport), MeshErrorKind> {
    let soup = match format {
        MeshFormat::Stl => stl::parse(bytes),
        MeshFormat::Obj => obj::parse(bytes),
        MeshFormat::Ply => ply::parse(bytes),
        MeshFormat::Off => off::parse(bytes),
    }?;
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
    soup.triangles = triangles.to_vec();
    assemble(soup, None)
}

/// Welds, checks and orients.
fn assemble(soup: Soup, format: Option<MeshFormat>) -> Result<(Mesh, MeshReport), MeshErrorKind> {
    if soup.triangles.is_empty() {
        return Err(MeshErrorKind::Empty);
    }
    let read_vertices = soup.positions.len();
    let read_triangles = soup.triangles.len();
    let welded = weld::weld(soup.positions, soup.triangles)?;
    let collapsed = read_triangles - welded.triangles.len();
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
    let topology = topology::orient(&mut mesh);
    mesh.closed = topology.unbalanced_edges == 0;
    let report = MeshReport::new(
        &mesh,
        format,
        read_vertices,
        read_triangles,
        Dropped { collapsed, times },
        &topology,
    );
    Ok((mesh, report))
}
