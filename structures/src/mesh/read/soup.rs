//! Vertices and faces of a file, and what was left out.

use crate::LARGEST_LENGTH;
use crate::mesh::error::MeshErrorKind;
use crate::mesh::repair::faces::Faces;
use crate::mesh::repair::rounding::Digits;

/// Vertices and faces in the file's order and unit.
#[derive(Debug, Default)]
pub struct Soup {
    pub positions: Vec<[f64; 3]>,
    /// Faces, each corner below the number of `positions`.
    pub faces: Faces,
    /// How the coordinates are written, in a text format.
    pub digits: Digits,
    /// What was left out, or read otherwise than the file says.
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

impl std::fmt::Display for At {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Line(number) => write!(f, "on line {number}"),
            Self::Record(number) => write!(f, "in record {number}"),
            Self::Face(number) => write!(f, "as face {number}"),
            Self::Vertex(number) => write!(f, "as vertex {number}"),
        }
    }
}

/// What is left out of a file that is read all the same.
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
            let (one, several, rest) = match what {
                LeftOut::ShortFace => (
                    "a face of fewer than three vertices was",
                    "faces of fewer than three vertices were",
                    "",
                ),
                LeftOut::FacetWithoutPlace => (
                    "a facet with a coordinate that is not finite was",
                    "facets with a coordinate that is not finite were",
                    "",
                ),
                LeftOut::VertexWithoutPlace => (
                    "a vertex with a coordinate that is not finite or beyond 1e30 was",
                    "vertices with a coordinate that is not finite or beyond 1e30 were",
                    "; no face uses it",
                ),
            };
            self.sentences.push(match count {
                1 => format!("{one} left out, {first}{rest}"),
                _ => format!("{count} {several} left out, the first {first}{rest}"),
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
    pub fn push_vertex(
        &mut self,
        position: [f64; 3],
        line: Option<usize>,
    ) -> Result<u32, MeshErrorKind> {
        let index = self.positions.len();
        let Ok(vertex) = u32::try_from(index) else {
            return Err(MeshErrorKind::TooLarge(format!(
                "more than {} vertices",
                u32::MAX
            )));
        };
        let bad = |value: &f64| value.is_nan() || value.abs() > LARGEST_LENGTH;
        if let Some(value) = position.into_iter().find(bad) {
            self.unplaced.push(Unplaced {
                vertex,
                line,
                value,
            });
        }
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

    /// Refuses faces that use a vertex without a place; where no face does, takes note of it.
    pub fn settle(&mut self) -> Result<(), MeshErrorKind> {
        if self.unplaced.is_empty() {
            return Ok(());
        }
        // In the order of vertices, as they were added.
        let find = |corner: &u32| {
            let place = self.unplaced.binary_search_by_key(corner, |bad| bad.vertex);
            place.ok()
        };
        if let Some(first) = self.faces.corners().iter().filter_map(find).min() {
            let Unplaced {
                vertex,
                line,
                value,
            } = self.unplaced[first];
            return Err(MeshErrorKind::Coordinate {
                line,
                what: format!("vertex {}", u64::from(vertex) + 1),
                value,
            });
        }
        for bad in std::mem::take(&mut self.unplaced) {
            let at = bad
                .line
                .map_or(At::Vertex(bad.vertex as usize + 1), At::Line);
            self.notes.left_out(LeftOut::VertexWithoutPlace, at);
        }
        Ok(())
    }
}
