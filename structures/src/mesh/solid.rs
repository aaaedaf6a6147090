//! The solid that a mesh bounds: depth, inside and nearest surface point, in a frame where lengths are about one.

use std::path::Path;

use crate::error::Error;
use crate::mesh::repair::weld::degenerate;
use crate::mesh::triangle_mesh::{Mesh, centroid};
use crate::mesh::triangle_tree::TriangleTree;
use crate::mesh::{slivers, winding};
use crate::neighbours::box_tree::{BoxNode, box_tree};
use crate::vector::{
    along, bounds, cross, distance, dot, scale, squared_distance, squared_distance_to_box, subtract,
};

/// A solid's coordinates y in those of its file: x = origin + unit y.
///
/// The origin is the middle of the bounding box, so that an offset costs no digits. The unit is a power of two, so that
/// doubling every length of a file changes no bit of the results.
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

/// A solid for queries at points. All coordinates and lengths are those of its [`Frame`].
#[derive(Clone, Debug)]
pub struct Solid {
    frame: Frame,
    mesh: Mesh,
    tree: TriangleTree,
    half_sides: [f64; 3],
    /// Corners of the triangles that have an area, with their number among these, in the order of `boxes`.
    triangles: Vec<(usize, [[f64; 3]; 3])>,
    /// A tree of bounding boxes, for distances.
    boxes: Vec<BoxNode<([f64; 3], [f64; 3])>>,
}

impl Mesh {
    /// Reads a mesh (`.stl`, `.obj`, `.ply` or `.off`); [`read`](super::read()) gives the report on it as well.
    ///
    /// # Errors
    /// [`Error`] for a file that cannot be read or holds no mesh.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(super::read(path.as_ref())?.0)
    }

    /// The solid that the mesh bounds.
    ///
    /// # Errors
    /// As [`Solid::new`].
    pub fn solid(&self) -> Result<Solid, Error> {
        Solid::new(self)
    }
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
        // Triangles without area are within the edges of their neighbours, and projecting to one divides zero by zero.
        let with_area = mesh.with_area(mesh.triangles.iter().copied());
        let mut triangles: Vec<_> = with_area.enumerate().collect();
        if triangles.is_empty() {
            return Err(degenerate(mesh.triangles.len()));
        }
        let boxes = box_tree(
            &mut triangles,
            LEAF,
            |&(number, corners)| (centroid(corners), number),
            |triangles| bounds(triangles.iter().flat_map(|(_, corners)| *corners)),
        );
        let (low, high) = mesh.bounds();
        let tree = match slivers::cut(&mesh) {
            Some(pieces) => TriangleTree::of(pieces),
            None => TriangleTree::new(&mesh),
        };
        Ok(Self {
            frame,
            tree,
            half_sides: [0, 1, 2].map(|axis| high[axis].max(-low[axis])),
            triangles,
            boxes,
            mesh,
        })
    }

    /// The solid's coordinates in those of the file.
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

    /// The triangles that have an area with their numbers, in the order of [`Self::boxes`].
    pub(super) fn triangles(&self) -> &[(usize, [[f64; 3]; 3])] {
        &self.triangles
    }

    /// A tree of the bounding boxes of [`Self::triangles`].
    pub(super) fn boxes(&self) -> &[BoxNode<([f64; 3], [f64; 3])>] {
        &self.boxes
    }

    /// Corners of the triangles that have an area, as indices of the mesh's positions.
    pub(super) fn corners(&self) -> Vec<[u32; 3]> {
        let all = self.mesh.triangles.iter().copied();
        all.filter(|&triangle| !self.mesh.is_sliver(triangle))
            .collect()
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
        distance(self.nearest(point), point)
    }

    /// As [`distance`](Self::distance), given that it is no larger than `bound`; much faster if the bound is close.
    pub fn distance_within(&self, point: [f64; 3], bound: f64) -> f64 {
        // The search takes what is nearer than the bound, which may be rounded.
        let bound = bound * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        let mut best = (bound * bound, [f64::NAN; 3]);
        self.search_nearest(0, point, &mut best);
        if best.1[0].is_nan() {
            return self.distance(point);
        }
        distance(best.1, point)
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

    /// Bounds of the signed distance to the boundary of the solid, above zero inside. They are those of a closed mesh;
    /// one of them is infinite if the nearest triangle is a wall within the solid or a sheet outside of it.
    ///
    /// No triangle is nearer than the nearest, so the boundary is at least as far. A point just beyond that triangle on
    /// the other side of the boundary shows that it is no farther.
    pub fn depth_bounds(&self, point: [f64; 3]) -> [f64; 2] {
        let near = self.nearest(point);
        let (least, is_inside) = (distance(near, point), self.is_inside(point));
        let beyond = along(near, BEYOND / least, subtract(near, point));
        let is_boundary = least > BEYOND && self.is_inside(beyond) != is_inside;
        let most = if is_boundary {
            least + BEYOND
        } else {
            f64::INFINITY
        };
        match is_inside {
            true => [least, most],
            false => [-most, -least],
        }
    }

    /// The nearest point of the surface.
    pub fn nearest(&self, point: [f64; 3]) -> [f64; 3] {
        let mut best = (f64::INFINITY, [f64::NAN; 3]);
        self.search_nearest(0, point, &mut best);
        best.1
    }
}

const LEAF: usize = 4;

/// Length beyond the nearest triangle of the point that shows it to be boundary.
const BEYOND: f64 = 1e-7;

impl Solid {
    /// Finds the nearest point below a node, if its squared distance is less than that in `best`.
    fn search_nearest(&self, at: usize, point: [f64; 3], best: &mut (f64, [f64; 3])) {
        let node = &self.boxes[at];
        if node.second == 0 {
            for &(_, corners) in &self.triangles[node.first..node.first + node.count] {
                let near = nearest_on(corners, point);
                let squared = squared_distance(near, point);
                if squared < best.0 {
                    *best = (squared, near);
                }
            }
            return;
        }
        let bound = |half: usize| {
            let (low, high) = &self.boxes[half].known;
            // Rounding must not hide a triangle that is as near as its box.
            squared_distance_to_box(low, high, point) * (1.0 - 1e-14)
        };
        let (first, second) = ((bound(at + 1), at + 1), (bound(node.second), node.second));
        let halves = if second.0 < first.0 {
            [second, first]
        } else {
            [first, second]
        };
        for (bound, half) in halves {
            if bound < best.0 {
                self.search_nearest(half, point, best);
            }
        }
    }
}

/// The point of a triangle that is nearest to another point: a corner, a point of a side or one within. The region that
/// the other point is in decides (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
pub(super) fn nearest_on([a, b, c]: [[f64; 3]; 3], point: [f64; 3]) -> [f64; 3] {
    let [ab, ac, bc] = [subtract(b, a), subtract(c, a), subtract(c, b)];
    let [from_a, from_b, from_c] = [subtract(point, a), subtract(point, b), subtract(point, c)];
    let (ab_a, ac_a) = (dot(ab, from_a), dot(ac, from_a));
    if ab_a <= 0.0 && ac_a <= 0.0 {
        return a;
    }
    let (ab_b, ac_b) = (dot(ab, from_b), dot(ac, from_b));
    if ab_b >= 0.0 && ac_b <= ab_b {
        return b;
    }
    let (ab_c, ac_c) = (dot(ab, from_c), dot(ac, from_c));
    if ac_c >= 0.0 && ab_c <= ac_c {
        return c;
    }
    // Areas of the triangles that the point makes with the sides, as shares of one number.
    let normal = cross(ab, ac);
    let at_c = dot(normal, cross(ab, from_a));
    if at_c < 0.0 && ab_a >= 0.0 && ab_b <= 0.0 {
        return along(a, ab_a / dot(ab, ab), ab);
    }
    let at_b = -dot(normal, cross(ac, from_c));
    if at_b < 0.0 && ac_a >= 0.0 && ac_c <= 0.0 {
        return along(a, ac_a / dot(ac, ac), ac);
    }
    let at_a = dot(normal, cross(bc, from_b));
    if at_a < 0.0 && ac_b - ab_b >= 0.0 && ab_c - ac_c >= 0.0 {
        return along(b, dot(bc, from_b) / dot(bc, bc), bc);
    }
    let all = at_a + at_b + at_c;
    along(along(a, at_b / all, ab), at_c / all, ac)
}
