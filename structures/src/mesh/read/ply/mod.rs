//! PLY, text and binary: elements `vertex` (x, y, z of any number type), `face` and `tristrips` (`vertex_indices` or
//! `vertex_index`, a list of any number type).
//!
//! The crate `ply-rs-bw` reads headers and binary data. Text is read here: the crate refuses numbers that real files
//! have in properties that no mesh needs, such as `nan`, and blank lines.

mod binary;
mod elements;
mod header;
mod text;

use ply_rs_bw::ply::Encoding;

use crate::mesh::error::MeshErrorKind;
use crate::mesh::read::ply::elements::{FaceLists, fault};
use crate::mesh::read::soup::Soup;

pub use crate::mesh::read::ply::header::begins;

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Soup, MeshErrorKind> {
    let (header, payload, lines) = header::read(bytes)?;
    if !header.elements.iter().any(|(name, _)| name == "vertex") {
        return Err(fault("the header has no element vertex"));
    }
    let faces = match header.encoding {
        Encoding::Ascii => text::read(&header, payload, lines),
        _ => binary::read(&header, payload),
    };
    faces.and_then(FaceLists::into_soup)
}
