//! Vertices and faces of a file, and notes on the parts that were left out.

use std::fmt;

use crate::LARGEST_LENGTH;
use crate::error::Error;
use crate::mesh::repair::rounding::Digits;

/// A breach of the format's rules, at a 1-based line of a text.
pub fn broken(line: impl Into<Option<usize>>, what: impl fmt::Display) -> Error {
    at_line(line, what).help("export the mesh again: the file may be cut short or written by hand")
}

/// The vertex at `place`, from 0, of the file's `vertices`; `index` is its number as it is written.
pub fn vertex(
    line: impl Into<Option<usize>>,
    index: i64,
    place: i64,
    vertices: usize,
) -> Result<u32, Error> {
    let place = u32::try_from(place).ok();
    let place = place.filter(|&place| (place as usize) < vertices);
    place.ok_or_else(|| {
        let fault = format!("a face names vertex {index}, but there are {vertices}");
        at_line(line, fault).help("export the mesh again: faces and vertices do not fit together")
    })
}

fn at_line(line: impl Into<Option<usize>>, what: impl fmt::Display) -> Error {
    Error::input(what).on_line(line.into().map(|line| line as u64))
}

/// The refusal of a file or a mesh that is too large; `what` says by what.
pub fn too_large(what: impl fmt::Display) -> Error {
    Error::input(format!("the mesh is too large: {what}"))
        .help("decimate the mesh, or cut it into parts")
}

/// Vertices and faces in the file's order and unit.
#[derive(Debug, Default)]
pub struct Soup {
    pub positions: Vec<[f64; 3]>,
    /// Faces, each corner below the number of `positions`.
    pub faces: Faces,
    /// How the coordinates are written, in a text format.
    pub digits: Digits,
    pub notes: Notes,
    /// Vertices with a coordinate that no distance can be computed from.
    unplaced: Vec<Unplaced>,
}

#[derive(Clone, Copy, Debug)]
struct Unplaced {
    vertex: u32,
    line: Option<usize>,
    value: f64,
}

/// A place in a file.
#[derive(Clone, Copy, Debug)]
pub enum At {
    /// 1-based line of a text.
    Line(usize),
    /// 1-based record of a binary STL.
    Record(usize),
    /// 1-based face of a binary PLY.
    Face(usize),
    /// 1-based vertex of a binary PLY.
    Vertex(usize),
}

impl At {
    /// The line, in a text.
    pub fn line(self) -> Option<usize> {
        match self {
            Self::Line(line) => Some(line),
            _ => None,
        }
    }
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(number) => write!(f, "on line {number}"),
            Self::Record(number) => write!(f, "in record {number}"),
            Self::Face(number) => write!(f, "as face {number}"),
            Self::Vertex(number) => write!(f, "as vertex {number}"),
        }
    }
}

/// Parts of a file that are left out while the rest is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOut {
    /// A face of fewer than three vertices.
    ShortFace,
    /// A facet of STL with a coordinate that is no number.
    FacetWithoutPlace,
    /// A vertex with a coordinate that is no number or too large, which no face uses.
    VertexWithoutPlace,
}

/// What was left out, or read otherwise than the file says: a sentence each.
#[derive(Debug, Default)]
pub struct Notes {
    sentences: Vec<String>,
    left_out: Vec<(LeftOut, usize, At)>,
}

impl Notes {
    /// Adds a sentence.
    pub fn say(&mut self, sentence: String) {
        self.sentences.push(sentence);
    }

    /// Counts something that was left out.
    pub fn left_out(&mut self, what: LeftOut, at: At) {
        match self.left_out.iter_mut().find(|(kind, ..)| *kind == what) {
            Some((_, count, _)) => *count += 1,
            None => self.left_out.push((what, 1, at)),
        }
    }

    /// All sentences.
    pub fn into_sentences(mut self) -> Vec<String> {
        for (what, count, first) in self.left_out {
            let (one, several, kind, rest) = match what {
                LeftOut::ShortFace => ("a face", "faces", "of fewer than three vertices", ""),
                LeftOut::FacetWithoutPlace => {
                    let kind = "with a coordinate that is not finite";
                    ("a facet", "facets", kind, "")
                }
                LeftOut::VertexWithoutPlace => {
                    let kind = "with a coordinate that is not finite or beyond 1e30";
                    ("a vertex", "vertices", kind, "; no face uses it")
                }
            };
            self.sentences.push(match count {
                1 => format!("{one} {kind} was left out, {first}{rest}"),
                _ => format!("{count} {several} {kind} were left out, the first {first}{rest}"),
            });
        }
        self.sentences
    }
}

/// Whether distances can be computed from a position.
pub fn is_finite(position: [f64; 3]) -> bool {
    position.iter().all(|value| value.is_finite())
}

impl Soup {
    /// Adds a vertex. One that no distance can be computed from must not be used by a face; see
    /// [`settle`](Self::settle).
    pub fn push_vertex(&mut self, position: [f64; 3], line: Option<usize>) -> Result<u32, Error> {
        let index = self.positions.len();
        let Ok(vertex) = u32::try_from(index) else {
            return Err(too_large(format!("more than {} vertices", u32::MAX)));
        };
        let bad = |value: &f64| value.is_nan() || value.abs() > LARGEST_LENGTH;
        let bad = position.into_iter().find(bad);
        self.unplaced.extend(bad.map(|value| Unplaced {
            vertex,
            line,
            value,
        }));
        self.positions.push(position);
        Ok(vertex)
    }

    /// Adds a face, or takes note of one that bounds nothing.
    pub fn push_face(&mut self, corners: &[u32], at: At) {
        if corners.len() < 3 {
            self.notes.left_out(LeftOut::ShortFace, at);
        } else {
            self.faces.push(corners);
        }
    }

    /// Refuses faces that use a vertex without a place; notes such vertices that no face uses.
    pub fn settle(&mut self) -> Result<(), Error> {
        if self.unplaced.is_empty() {
            return Ok(());
        }
        // In the order of vertices, as they were added.
        let find = |corner| {
            self.unplaced
                .binary_search_by_key(corner, |bad| bad.vertex)
                .ok()
        };
        if let Some(first) = self.faces.corners.iter().filter_map(find).min() {
            let bad = self.unplaced[first];
            let what = format!(
                "vertex {} has coordinate {:e}; coordinates must be finite and at most 1e30 in magnitude",
                u64::from(bad.vertex) + 1,
                bad.value
            );
            return Err(at_line(bad.line, what).help(
                "export the mesh again from a program that reports what is broken, or remove the vertex",
            ));
        }
        for bad in std::mem::take(&mut self.unplaced) {
            let vertex = At::Vertex(bad.vertex as usize + 1);
            let at = bad.line.map_or(vertex, At::Line);
            self.notes.left_out(LeftOut::VertexWithoutPlace, at);
        }
        Ok(())
    }
}

/// Polygons of three or more corners.
#[derive(Clone, Debug, Default)]
pub struct Faces {
    /// Corners of all faces, in their order.
    pub corners: Vec<u32>,
    /// Number of corners of each face.
    sizes: Vec<u32>,
}

impl Faces {
    /// Adds a face of three or more corners; fewer bound nothing.
    pub fn push(&mut self, corners: &[u32]) {
        if let (3.., Ok(size)) = (corners.len(), u32::try_from(corners.len())) {
            self.corners.extend_from_slice(corners);
            self.sizes.push(size);
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.sizes.is_empty()
    }

    /// The corners of each face.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let mut left = self.corners.as_slice();
        self.sizes.iter().map(move |&size| {
            let (face, rest) = left.split_at(size as usize);
            left = rest;
            face
        })
    }

    /// Number of triangles that the faces are cut into.
    pub fn triangle_count(&self) -> usize {
        self.corners.len() - 2 * self.sizes.len()
    }
}
