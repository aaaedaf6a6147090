//! Why a mesh could not be read or used: the file, the line where there is one, and what to do.

use std::path::{Path, PathBuf};

/// Why reading a mesh failed.
///
/// `Display` gives the message alone; [`file`](Self::file), [`line`](Self::line) and [`remedy`](Self::remedy) give the
/// rest, so that a caller can lay the four out as it likes.
#[derive(Debug, thiserror::Error)]
#[error("{kind}")]
pub struct MeshError {
    /// The path as given; none for a mesh made in memory.
    pub file: Option<PathBuf>,
    /// The fault, in words.
    pub kind: MeshErrorKind,
}

/// A fault of a mesh file or a mesh.
#[derive(Debug, thiserror::Error)]
pub enum MeshErrorKind {
    /// There is no such file.
    #[error("there is no such file")]
    Missing,
    /// The path leads to a directory.
    #[error("this is a directory, not a mesh file")]
    Directory,
    /// The operating system refused to read the file.
    #[error("the file cannot be read: {0}")]
    Unreadable(std::io::Error),
    /// The file or the mesh is larger than the reader's indices reach.
    #[error("the mesh is too large: {0}")]
    TooLarge(String),
    /// Neither the name's ending nor the first bytes tell the format.
    #[error("the format is not known: neither STL, OBJ, PLY nor OFF")]
    UnknownFormat,
    /// The file is of another kind.
    #[error("this is {kind}, not a mesh that can be read")]
    Foreign {
        /// What it is.
        kind: &'static str,
        /// What to give in its place.
        remedy: &'static str,
    },
    /// The text or the bytes break the rules of the format.
    #[error("{what}")]
    Syntax {
        /// 1-based line, in text formats.
        line: Option<usize>,
        /// The fault, in words.
        what: String,
    },
    /// A coordinate is NaN, infinite, or so large that its square overflows.
    #[error(
        "{what} has coordinate {value:e}; coordinates must be finite and at most 1e30 in magnitude"
    )]
    Coordinate {
        /// 1-based line, in text formats.
        line: Option<usize>,
        /// Which vertex.
        what: String,
        /// The number.
        value: f64,
    },
    /// A face names a vertex that the file does not have.
    #[error("a face names vertex {index}, but there are {vertices}")]
    Index {
        /// 1-based line, in text formats.
        line: Option<usize>,
        /// The index as it stands in the file.
        index: i64,
        /// Number of vertices to choose from.
        vertices: usize,
    },
    /// No face at all.
    #[error("the mesh has no triangles")]
    Empty,
    /// Every triangle has lost its area.
    #[error("all {triangles} triangles are degenerate: none has an area")]
    Degenerate {
        /// Number of triangles in the file.
        triangles: usize,
    },
    /// All vertices lie in one plane.
    #[error("the mesh is flat: all its vertices lie in one plane, so it bounds no solid")]
    Flat,
    /// Too many closed surfaces lie within one another.
    #[error(
        "too many of its {surfaces} closed surfaces lie within one another to find which of them bound the solid"
    )]
    Nested {
        /// Number of surfaces.
        surfaces: usize,
    },
    /// The mesh is smaller than numbers can distinguish.
    #[error("the mesh is {extent:e} across; lengths below 1e-60 are not distinguished from zero")]
    Tiny {
        /// Longest edge of the bounding box, in the file's unit.
        extent: f64,
    },
}

impl MeshError {
    /// An error about a file.
    pub(super) fn at(file: &Path, kind: MeshErrorKind) -> Self {
        Self {
            file: Some(file.to_owned()),
            kind,
        }
    }

    /// The offending file, where there is one.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The offending line (1-based), in text formats where one is to blame.
    pub fn line(&self) -> Option<usize> {
        match &self.kind {
            MeshErrorKind::Syntax { line, .. }
            | MeshErrorKind::Coordinate { line, .. }
            | MeshErrorKind::Index { line, .. } => *line,
            _ => None,
        }
    }

    /// Remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match &self.kind {
            MeshErrorKind::Missing => "check the path",
            MeshErrorKind::Directory => "name one .stl, .obj, .ply or .off file",
            MeshErrorKind::Unreadable(_) => {
                "check the permissions of the file and that it is on a readable disk"
            }
            MeshErrorKind::TooLarge(_) => "decimate the mesh, or cut it into parts",
            MeshErrorKind::UnknownFormat => {
                "give an STL, OBJ, PLY or OFF file, with the ending .stl, .obj, .ply or .off, not compressed"
            }
            MeshErrorKind::Foreign { remedy, .. } => remedy,
            MeshErrorKind::Syntax { .. } => {
                "export the mesh again: the file may be cut short or written by hand"
            }
            MeshErrorKind::Coordinate { .. } => {
                "export the mesh again from a program that reports what is broken, or remove the vertex"
            }
            MeshErrorKind::Index { .. } => {
                "export the mesh again: faces and vertices do not fit together"
            }
            MeshErrorKind::Empty => {
                "give a surface mesh with faces; point clouds and curves bound no solid"
            }
            MeshErrorKind::Degenerate { .. } => {
                "check the unit of the export: too few digits may have merged the vertices"
            }
            MeshErrorKind::Flat => "give the surface of a solid, with a thickness",
            MeshErrorKind::Nested { .. } => {
                "leave out the inner surfaces, or sample the parts one by one"
            }
            MeshErrorKind::Tiny { .. } => "export the mesh in a smaller unit of length",
        }
    }
}

impl From<MeshError> for crate::Error {
    fn from(error: MeshError) -> Self {
        let line = error.line().and_then(|line| u64::try_from(line).ok());
        let refused = Self::input(&error).on_line(line).help(error.remedy());
        match error.file() {
            Some(file) => refused.at(file),
            None => refused,
        }
    }
}
