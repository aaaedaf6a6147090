//! Elements of a PLY file that make a mesh.

use ply_rs_bw::ply::ElementDef;

use crate::mesh::error::MeshErrorKind;
use crate::mesh::read::soup::{At, Soup};

/// Names that the list of a face's vertices goes by.
pub const LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// What an element of the file is to a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    Vertex,
    Face,
    /// Triangles that each take over two vertices of the one before; a negative number ends a strip.
    Strip,
    Other,
}

impl Role {
    /// The role of an element, refused where it lacks a property that it needs.
    pub fn of(name: &str, element: &ElementDef) -> Result<Self, MeshErrorKind> {
        let role = match name {
            "vertex" => Self::Vertex,
            "face" => Self::Face,
            "tristrips" => Self::Strip,
            _ => return Ok(Self::Other),
        };
        let has = |property: &&str| element.properties.contains_key(*property);
        match role {
            Self::Vertex if !["x", "y", "z"].iter().all(has) => {
                Err(fault("the vertices lack one of the properties x, y and z"))
            }
            Self::Face | Self::Strip if !LISTS.iter().any(has) => {
                Err(fault("the faces lack the list vertex_indices"))
            }
            _ => Ok(role),
        }
    }
}

/// Faces as a file lists them, which may be before the vertices that they name.
#[derive(Debug, Default)]
pub struct FaceLists {
    pub soup: Soup,
    /// Role, place and numbers of vertices.
    pub lists: Vec<(Role, At, Vec<i64>)>,
}

impl FaceLists {
    /// Faces checked and cut out of strips.
    pub fn into_soup(self) -> Result<Soup, MeshErrorKind> {
        let Self { mut soup, lists } = self;
        let vertices = soup.positions.len();
        let mut corners = Vec::new();
        for (role, at, indices) in lists {
            let corner = |&index: &i64| {
                let place = u32::try_from(index).ok();
                let place = place.filter(|&place| (place as usize) < vertices);
                place.ok_or(MeshErrorKind::Index {
                    line: match at {
                        At::Line(line) => Some(line),
                        _ => None,
                    },
                    index,
                    vertices,
                })
            };
            let runs = indices.split(|&index| role == Role::Strip && index < 0);
            for run in runs {
                corners.clear();
                for index in run {
                    corners.push(corner(index)?);
                }
                if role != Role::Strip {
                    soup.push_face(&corners, at);
                    continue;
                }
                for (number, window) in corners.windows(3).enumerate() {
                    if let &[a, b, c] = window
                        && a != b
                        && b != c
                        && c != a
                    {
                        // Every other triangle of a strip runs the other way.
                        let face = if number % 2 == 0 {
                            [a, b, c]
                        } else {
                            [b, a, c]
                        };
                        soup.push_face(&face, at);
                    }
                }
            }
        }
        Ok(soup)
    }
}

/// A whole number that may be written as another one is; one that is none names no vertex.
pub fn whole(value: f64) -> i64 {
    if value.fract() == 0.0 {
        value as i64
    } else {
        i64::MIN
    }
}

pub fn fault(what: &str) -> MeshErrorKind {
    MeshErrorKind::Syntax {
        line: None,
        what: what.to_owned(),
    }
}
