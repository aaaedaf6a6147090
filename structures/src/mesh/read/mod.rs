//! From a file to a mesh: STL (text and binary), OBJ, PLY (text and binary) and OFF.
//!
//! The crates for these formats fall short. Those for STL take a binary file whose header begins with `solid` for text,
//! and keep only the first solid and 24 bits of a number. That for PLY refuses numbers and blank lines of real files. The
//! others report no line.
//!
//! The first bytes of a file decide how it is read, then its name's ending. A file of another kind is refused by name.

pub(super) mod encoding;
pub(super) mod foreign;
pub(super) mod obj;
pub(super) mod off;
pub(super) mod ply;
pub(super) mod soup;
pub(super) mod stl;
pub(super) mod words;

use std::fs;
use std::io::Read;
use std::path::Path;

use serde::Serialize;

use crate::error::Error;
use crate::mesh::read::encoding::{text_of, unified};
use crate::mesh::read::soup::{At, Soup, broken, too_large, vertex};
use crate::mesh::repair::{edges, topology, weld};
use crate::mesh::report::MeshReport;
use crate::mesh::triangle_mesh::Mesh;

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

/// Reads a mesh, welds its vertices, turns its triangles to face outward and reports what was found.
///
/// The format is detected from the first bytes, else from the name's ending. Numbers keep all the digits of the file.
///
/// # Errors
/// When the file cannot be read or understood, or when the mesh is empty, flat or degenerate, or has a
/// coordinate that is not finite.
pub fn read(path: &Path) -> Result<(Mesh, MeshReport), Error> {
    read_bytes(path, &file_bytes(path)?)
}

/// The bytes of a mesh's file. What is read once can be a pipe.
///
/// # Errors
/// When the file cannot be read or is too large.
pub fn file_bytes(path: &Path) -> Result<Vec<u8>, Error> {
    let unreadable = |error: std::io::Error| {
        match error.kind() {
            std::io::ErrorKind::NotFound => {
                Error::input("there is no such file").help("check the path")
            }
            _ => Error::input(format!("the file cannot be read: {error}"))
                .help("check the permissions of the file and that it is on a readable disk"),
        }
        .at(path)
    };
    let metadata = fs::metadata(path).map_err(unreadable)?;
    if metadata.is_dir() {
        return Err(Error::input("this is a directory, not a mesh file")
            .at(path)
            .help("name one .stl, .obj, .ply or .off file"));
    }
    let refuse = |bytes: String| {
        Err(too_large(format!("{bytes} bytes, where {LARGEST_FILE} are read")).at(path))
    };
    if metadata.len() > LARGEST_FILE {
        return refuse(metadata.len().to_string());
    }
    // A pipe has no length beforehand.
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    fs::File::open(path)
        .and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes))
        .map_err(unreadable)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return refuse(format!("more than {LARGEST_FILE}"));
    }
    Ok(bytes)
}

/// As [`read`], of a file's bytes; the path's ending decides the format where they leave it open.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(path: &Path, bytes: &[u8]) -> Result<(Mesh, MeshReport), Error> {
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
        Some(format) => parse(&bytes, format),
        None => foreign::refuse(&bytes).and_then(|()| {
            Err(Error::input("the format is not known: neither STL, OBJ, PLY nor OFF").help(
                "give an STL, OBJ, PLY or OFF file, with the ending .stl, .obj, .ply or .off, not compressed",
            ))
        }),
    }
    .map_err(|error| error.at(path))
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
pub fn parse(bytes: &[u8], format: MeshFormat) -> Result<(Mesh, MeshReport), Error> {
    let bytes = unified(bytes);
    if sure_format(&bytes) != Some(format) {
        foreign::refuse(&bytes)?;
    }
    let binary = || broken(None, "these are binary data, where the format is a text");
    let text = || text_of(&bytes).ok_or_else(binary);
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
/// When an index is out of range or the mesh is unusable.
pub fn from_triangles(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
) -> Result<(Mesh, MeshReport), Error> {
    let mut soup = Soup::default();
    for &position in positions {
        soup.push_vertex(position, None)?;
    }
    for &index in triangles.iter().flatten() {
        vertex(None, index.into(), index.into(), positions.len())?;
    }
    for triangle in triangles {
        soup.push_face(triangle, At::Face(0));
    }
    soup.settle()?;
    assemble(soup, None)
}

fn assemble(soup: Soup, format: Option<MeshFormat>) -> Result<(Mesh, MeshReport), Error> {
    if soup.faces.is_empty() {
        return Err(Error::input("the mesh has no triangles")
            .help("give a surface mesh with faces; point clouds and curves bound no solid"));
    }
    let mut report = MeshReport {
        format,
        file_vertices: soup.positions.len(),
        file_triangles: soup.faces.triangle_count(),
        reading_notes: soup.notes.into_sentences(),
        ..MeshReport::default()
    };
    let mut mesh = weld::weld(soup.positions, soup.faces, &soup.digits, &mut report)?;
    report.times = edges::keep_first(&mut mesh.triangles);
    if mesh.triangles.iter().all(|&t| mesh.is_sliver(t)) {
        return Err(weld::degenerate(report.file_triangles));
    }
    if mesh.is_flat() {
        let message = "the mesh is flat: all its vertices lie in one plane, so it bounds no solid";
        return Err(Error::input(message).help("give the surface of a solid, with a thickness"));
    }
    topology::orient(&mut mesh, &mut report)?;
    report.measure(&mesh);
    Ok((mesh, report))
}
