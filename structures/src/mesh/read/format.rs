//! File formats of meshes.

use serde::Serialize;

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
