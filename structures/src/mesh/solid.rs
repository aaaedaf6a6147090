//! The solid that a mesh bounds: depth, inside and nearest surface point, in a frame where lengths are about one.

use parry3d_f64::math::Vector;
use parry3d_f64::query::point::PointQuery;
use parry3d_f64::shape::TriMesh;

use crate::error::Error;
use crate::mesh::repair::weld::degenerate;
use crate::mesh::triangle_mesh::Mesh;
use crate::mesh::triangle_tree::TriangleTree;
use crate::mesh::vector::{along, distance, scale, subtract};
use crate::mesh::{slivers, winding};

/// Where a solid's own coordinates y stand in the file's: x = origin + unit y.
///
/// The origin is the middle of the bounding box, so that an offset costs no digits. The unit is a power of two: it
/// costs none either, and doubling every length of a file changes no bit of what is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Middle of the bounding box, in the file's unit.
    pub origin: [f64; 3],
    /// Power of two, at least the longest edge of the bounding box and less than twice that, in the file's unit.
    pub unit: f64,
}

impl Frame {
    fn of(mesh: &Mesh) -> Self {
        let (low, high) = mesh.bounds();
        let origin = [0, 1, 2].map(|axis| 0.5 * low[axis] + 0.5 * high[axis]);
        let extent = mesh.extent();
        let mut unit = extent.log2().ceil().exp2();
        // A logarithm's last digit may be off.
        if unit < extent {
            unit *= 2.0;
        } else if unit >= 2.0 * extent {
            unit /= 2.0;
        }
        Self { origin, unit }
    }

    /// A point in the solid's coordinates.
    pub fn inward(&self, point: [f64; 3]) -> [f64; 3] {
        scale(subtract(point, self.origin), 1.0 / self.unit)
    }

    /// A point in the file's coordinates.
    pub fn outward(&self, point: [f64; 3]) -> [f64; 3] {
        along(self.origin, self.unit, point)
    }
}

/// A solid to ask about points. All coordinates and lengths are those of its [`Frame`].
pub struct Solid {
    frame: Frame,
    mesh: Mesh,
    surface: Surface,
    tree: TriangleTree,
    half_sides: [f64; 3],
}

impl Solid {
    /// The solid of a mesh.
    ///
    /// # Errors
    /// When no triangle has an area, which [`super::read`] has refused already.
    pub fn new(mesh: &Mesh) -> Result<Self, Error> {
        let frame = Frame::of(mesh);
        let mesh = Mesh {
            positions: mesh.positions.iter().map(|&p| frame.inward(p)).collect(),
            triangles: mesh.triangles.clone(),
            closed: mesh.closed,
        };
        let (low, high) = mesh.bounds();
        let tree = match slivers::cut(&mesh) {
            Some(pieces) => TriangleTree::of(pieces),
            None => TriangleTree::new(&mesh),
        };
        Ok(Self {
            frame,
            surface: Surface::new(&mesh)?,
            tree,
            half_sides: [0, 1, 2].map(|axis| high[axis].max(-low[axis])),
            mesh,
        })
    }

    /// Where the solid's coordinates stand in the file's.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// The mesh, in the solid's coordinates.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Half the edges of the bounding box, which is centred at zero.
    pub fn half_sides(&self) -> [f64; 3] {
        self.half_sides
    }

    /// The triangles as clusters, for sums over the surface.
    pub(crate) fn tree(&self) -> &TriangleTree {
        &self.tree
    }

    /// Whether a point is inside: its generalised winding number is above one half.
    pub fn is_inside(&self, point: [f64; 3]) -> bool {
        // No point beyond the bounding box is inside a closed mesh, nor was meant to be inside an open one.
        let in_box = (0..3).all(|axis| point[axis].abs() <= self.half_sides[axis]);
        in_box && winding::is_inside(&self.tree, point)
    }

    /// The generalised winding number at a point, summed over every triangle: the slow reference of
    /// [`is_inside`](Self::is_inside).
    pub fn winding_number(&self, point: [f64; 3]) -> f64 {
        winding::exact(&self.tree, point)
    }

    /// Distance to the surface, zero or above.
    pub fn distance(&self, point: [f64; 3]) -> f64 {
        self.surface.distance(point)
    }

    /// As [`distance`](Self::distance), given that it is no larger than `bound`; much faster where the bound is close.
    pub fn distance_within(&self, point: [f64; 3], bound: f64) -> f64 {
        self.surface.distance_within(point, bound)
    }

    /// Signed distance: to the surface, above zero inside and below outside.
    pub fn depth(&self, point: [f64; 3]) -> f64 {
        let distance = self.distance(point);
        if self.is_inside(point) {
            distance
        } else {
            -distance
        }
    }

    /// The nearest point of the surface.
    pub fn nearest(&self, point: [f64; 3]) -> [f64; 3] {
        self.surface.nearest(point)
    }
}

/// The triangles of a mesh in parry's tree of bounding boxes, to measure distances to.
///
/// parry's own inside test (`TriMeshFlags::ORIENTED`, pseudo-normals of the nearest feature) is not used: it is wrong
/// on open meshes and also on closed ones that intersect themselves, which no cheap check finds. See
/// [`super::winding`].
struct Surface {
    triangles: TriMesh,
}

impl Surface {
    /// Triangles without area are left out: they lie within the edges of their neighbours, and projecting to one
    /// divides zero by zero.
    fn new(mesh: &Mesh) -> Result<Self, Error> {
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
        let triangles = TriMesh::new(positions, triangles).map_err(|_| degenerate(count))?;
        Ok(Self { triangles })
    }

    /// The nearest point of the surface.
    fn nearest(&self, point: [f64; 3]) -> [f64; 3] {
        self.triangles
            .project_local_point(Vector::from_array(point), false)
            .point
            .to_array()
    }

    /// The distance to the surface, given that it is no larger than `bound`, which spares most of the search.
    fn distance_within(&self, point: [f64; 3], bound: f64) -> f64 {
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
    fn distance(&self, point: [f64; 3]) -> f64 {
        distance(self.nearest(point), point)
    }
}
