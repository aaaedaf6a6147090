//! PLY, text and binary, by the crate `ply-rs-bw`: elements `vertex` (x, y, z of any number type) and `face`
//! (`vertex_indices` or `vertex_index`, a list of any whole-number type). Triangle strips are not read.

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, Encoding, Property, PropertyAccess, PropertyAccessResult};

use super::super::error::MeshErrorKind;
use super::Soup;

/// A vertex; a coordinate that the file does not have stays NaN and is refused as missing.
struct Vertex([f64; 3]);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([f64::NAN; 3])
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        if let (Some(place), Some(value)) = (self.0.get_mut(axis), number(&property)) {
            *place = value;
        }
        PropertyAccessResult::Set
    }
}

/// A face: the indices of its vertices.
struct Face(Vec<i64>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !LISTS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match property {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

/// Names that the list of a face's vertices goes by.
const LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

fn number(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(value) => f64::from(value),
        Property::UChar(value) => f64::from(value),
        Property::Short(value) => f64::from(value),
        Property::UShort(value) => f64::from(value),
        Property::Int(value) => f64::from(value),
        Property::UInt(value) => f64::from(value),
        Property::Float(value) => f64::from(value),
        Property::Double(value) => value,
        _ => return None,
    })
}

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Soup, MeshErrorKind> {
    let fault = |what: &str| MeshErrorKind::Syntax {
        line: None,
        what: what.to_owned(),
    };
    let mut reader = Reader::new(bytes);
    let header = Parser::<DefaultElement>::new()
        .read_header(&mut reader)
        .map_err(broken)?;
    let is_text = header.encoding == Encoding::Ascii;
    let mut soup = Soup::default();
    let mut has_vertices = false;
    let mut faces = Vec::new();
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => {
                if ["x", "y", "z"]
                    .iter()
                    .any(|axis| !element.properties.contains_key(*axis))
                {
                    return Err(fault("the vertices lack one of the properties x, y and z"));
                }
                has_vertices = true;
                let first_line = reader.line();
                let vertices = Parser::<Vertex>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(broken)?;
                for (index, Vertex(position)) in vertices.into_iter().enumerate() {
                    soup.push_vertex(position, is_text.then_some(first_line + index))?;
                }
            }
            "face" => {
                if LISTS
                    .iter()
                    .all(|list| !element.properties.contains_key(*list))
                {
                    return Err(fault("the faces lack the list vertex_indices"));
                }
                let first_line = reader.line();
                let read = Parser::<Face>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(broken)?;
                // Faces may stand before the vertices that they name.
                let numbered = read.into_iter().enumerate();
                faces.extend(
                    numbered.map(|(index, face)| (is_text.then_some(first_line + index), face)),
                );
            }
            _ => {
                Parser::<DefaultElement>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(broken)?;
            }
        }
    }
    if !has_vertices {
        return Err(fault("the header has no element vertex"));
    }
    let vertices = soup.positions.len();
    for (line, Face(indices)) in faces {
        let corners: Result<Vec<u32>, MeshErrorKind> = indices
            .into_iter()
            .map(|index| {
                let place = u32::try_from(index)
                    .ok()
                    .filter(|&place| (place as usize) < vertices);
                place.ok_or(MeshErrorKind::Index {
                    line,
                    index,
                    vertices,
                })
            })
            .collect();
        let corners = corners?;
        if corners.len() >= 3 {
            soup.push_face(&corners);
        }
    }
    Ok(soup)
}

/// What the parser said, on one line; it puts the line's number in front and the line's text after.
fn broken(error: ParseError) -> MeshErrorKind {
    let said = error.to_string();
    let first = said.lines().next().unwrap_or_default();
    let what = match (error.line(), first.split_once(": ")) {
        (Some(_), Some((_, what))) => what,
        _ => first,
    };
    MeshErrorKind::Syntax {
        line: error.line(),
        what: format!("the PLY data are broken: {}", what.trim_end_matches(':')),
    }
}
