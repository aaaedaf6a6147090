//! The data of a binary PLY, by the crate `ply-rs-bw`.

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    DefaultElement, ElementDef, Header, Property, PropertyAccess, PropertyAccessResult,
};

use crate::mesh::error::MeshErrorKind;
use crate::mesh::read::ply::elements::{FaceLists, LISTS, Role, whole};
use crate::mesh::read::soup::At;

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
            Property::ListFloat(list) => list.into_iter().map(|x| whole(f64::from(x))).collect(),
            Property::ListDouble(list) => list.into_iter().map(whole).collect(),
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

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

/// Reads what follows the header.
pub fn read(header: &Header, payload: &[u8]) -> Result<FaceLists, MeshErrorKind> {
    let found = elements(header, payload);
    let is_whole = matches!(&found, Ok((_, rest)) if rest.is_empty());
    let blanks = [&b"\r\n"[..], b"\n", b"\r"];
    let blank = blanks.into_iter().find_map(|end| payload.strip_prefix(end));
    // Some writers put a blank line before the data, which then fit the length better without it.
    if !is_whole
        && let Some(data) = blank
        && let Ok((faces, [])) = elements(header, data)
    {
        return Ok(faces);
    }
    found.map(|(faces, _)| faces)
}

/// All elements, and what follows them.
fn elements<'a>(
    header: &Header,
    payload: &'a [u8],
) -> Result<(FaceLists, &'a [u8]), MeshErrorKind> {
    let mut reader = Reader::new(payload);
    let mut faces = FaceLists::default();
    for (name, element) in &header.elements {
        match Role::of(name, element)? {
            Role::Vertex => {
                for Vertex(position) in all(&mut reader, element, header)? {
                    faces.soup.push_vertex(position, None)?;
                }
            }
            role @ (Role::Face | Role::Strip) => {
                let found: Vec<Face> = all(&mut reader, element, header)?;
                let numbered = found.into_iter().zip(1..);
                let lists = numbered.map(|(Face(list), number)| (role, At::Face(number), list));
                faces.lists.extend(lists);
            }
            Role::Other => {
                all::<DefaultElement>(&mut reader, element, header)?;
            }
        }
    }
    Ok((faces, reader.into_inner()))
}

fn all<E: PropertyAccess>(
    reader: &mut Reader<&[u8]>,
    element: &ElementDef,
    header: &Header,
) -> Result<Vec<E>, MeshErrorKind> {
    Parser::new()
        .read_payload_for_element(reader, element, header)
        .map_err(|error| {
            let MeshErrorKind::Syntax { what, .. } = broken(&error, 0) else {
                return broken(&error, 0);
            };
            // Binary data have no lines.
            MeshErrorKind::Syntax { line: None, what }
        })
}

/// What the parser said, on one line; it puts the line's number in front and the line's text after.
pub fn broken(error: &ParseError, lines_before: usize) -> MeshErrorKind {
    let said = error.to_string();
    let first = said.lines().next().unwrap_or_default();
    let what = match (error.line(), first.split_once(": ")) {
        (Some(_), Some((_, what))) => what,
        _ => first,
    };
    MeshErrorKind::Syntax {
        line: error.line().map(|line| line + lines_before),
        what: format!("the PLY data are broken: {}", what.trim_end_matches(':')),
    }
}
