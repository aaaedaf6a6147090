//! The distance to a mesh's surface, by parry's tree of bounding boxes.
//!
//! parry's own inside test (`TriMeshFlags::ORIENTED`, pseudo-normals of the nearest feature) is not used: it is wrong
//! on open meshes and also on closed ones that intersect themselves, which no cheap check finds. See
//! [`super::winding`].

use parry3d_f64::math::Vector;
use parry3d_f64::query::point::PointQuery;
use parry3d_f64::shape::TriMesh;

use crate::mesh::error::MeshErrorKind;
use crate::mesh::triangle_mesh::Mesh;

/// The triangles of a mesh, to measure distances to.
pub(crate) struct Surface {
    triangles: TriMesh,
}

impl Surface {
    /// Triangles without area are left out: they lie within the edges of their neighbours, and projecting to one
    /// divides zero by zero.
    pub fn new(mesh: &Mesh) -> Result<Self, MeshErrorKind> {
        let positions = mesh
            .positions
            .iter()
            .map(|&p| Vector::from_array(p))
            .collect();
        let triangles: Vec<[u32; 3]> = mesh
            .triangles
            .iter()
            .copied()
            .filter(|&triangle| !mesh.is_sliver(triangle))
            .collect();
        let count = triangles.len();
        // The builder refuses nothing but an empty list.
        let triangles = TriMesh::new(positions, triangles)
            .map_err(|_| MeshErrorKind::Degenerate { triangles: count })?;
        Ok(Self { triangles })
    }

    /// The nearest point of the surface.
    pub fn nearest(&self, point: [f64; 3]) -> [f64; 3] {
        self.triangles
            .project_local_point(Vector::from_array(point), false)
            .point
            .to_array()
    }

    /// The distance to the surface, given that it is no larger than `bound`, which spares most of the search.
    pub fn distance_within(&self, point: [f64; 3], bound: f64) -> f64 {
        let at = Vector::from_array(point);
        // The search takes what is nearer than the bound, and the bound may carry rounding of its own.
        let bound = bound * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        match self
            .triangles
            .project_local_point_with_max_dist(at, false, bound)
        {
            Some(projection) => (projection.point - at).length(),
            None => self.distance(point),
        }
    }

    /// The distance to the surface.
    pub fn distance(&self, point: [f64; 3]) -> f64 {
        crate::mesh::vector::distance(self.nearest(point), point)
    }
}
