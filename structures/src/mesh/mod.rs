//! Meshes: the surface of a solid as triangles, with volume, area, distance and winding number.
//!
//! # Conventions
//!
//! - Lengths are in the file's own unit.
//! - Triangles list their corners anticlockwise seen from outside, so normals point outward and volumes are
//!   positive.
//! - Lines are counted from 1.
//! - The **solid** S of a mesh is the set of points with a generalised winding number above one half. It is the
//!   inside of a closed mesh, the union of overlapping parts, and a smooth guess at the solid that an open mesh was
//!   meant to bound.
//!
//! # From file to solid
//!
//! path -> `read` (bytes to polygons) -> `repair` -> [`Mesh`] with its [`MeshReport`] -> [`Solid`]: `distance` to the
//! surface, `winding` number, and the sign by it.
//!
//! `repair` welds vertices (`weld`, with `rounding`), cuts polygons into triangles, drops a whole surface that is there
//! twice and finds open and non-manifold edges and parts (`edges`, `topology`). `facing` turns surfaces outward by their
//! volume and nesting. [`SurfacePairs`] compares the surfaces of two solids at a pose.

mod contact;
mod exact_solid;
mod read;
mod repair;
mod report;
mod shared_region;
mod slivers;
mod solid;
mod surface;
mod triangle_mesh;
mod triangle_pair;
mod triangle_tree;
pub(crate) mod winding;

pub use self::contact::{ClosestPoints, SurfacePairs};
pub use self::exact_solid::{ExactSolid, Indefinite};
pub use self::read::{MeshFormat, file_bytes, from_triangles, parse, read, read_bytes};
pub use self::report::{Figure, MeshReport};
pub use self::shared_region::{SharedRegion, SharedRegions};
pub use self::solid::{Frame, Solid};
pub use self::surface::SurfaceSample;
pub(crate) use self::surface::{Probe, is_beside, surface_pieces};
pub use self::triangle_mesh::Mesh;
pub use self::triangle_pair::MeshContact;
