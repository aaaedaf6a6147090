//! Triangle meshes.

use crate::vector::{add, bounds, cross, distance, dot, extent, norm, scale, subtract};

/// A triangle mesh with distinct vertices, oriented outward as far as it can be.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Vertices, in the file's unit.
    pub(crate) positions: Vec<[f64; 3]>,
    /// Corners of each triangle, three different indices into `positions`.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Whether every edge is run through as often one way as the other.
    pub(crate) closed: bool,
}

/// Height over longest edge below which a triangle counts as having no area.
const SLIVER: f64 = 1e-12;

impl Mesh {
    /// The vertices, in the file's unit.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The corners of each triangle, as indices into [`positions`](Self::positions).
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Whether every edge is run through as often one way as the other, so that a point is plainly in or out.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    pub(crate) fn corners(&self, triangle: [u32; 3]) -> [[f64; 3]; 3] {
        triangle.map(|corner| self.positions[corner as usize])
    }

    /// Corner points of those of these triangles that have an area.
    pub(crate) fn with_area(
        &self,
        triangles: impl Iterator<Item = [u32; 3]>,
    ) -> impl Iterator<Item = [[f64; 3]; 3]> {
        let with_area = triangles.filter(|&triangle| !self.is_sliver(triangle));
        with_area.map(|triangle| self.corners(triangle))
    }

    /// Smallest and largest coordinate on each axis, in the file's unit.
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        bounds(self.positions.iter().copied())
    }

    /// Longest edge of the bounding box, in the file's unit.
    pub fn extent(&self) -> f64 {
        extent(self.bounds())
    }

    /// Corner points of all triangles relative to the middle of the bounding box, which comes first.
    fn centered(&self) -> ([f64; 3], impl Iterator<Item = [[f64; 3]; 3]>) {
        let (low, high) = self.bounds();
        let middle = scale(add(low, high), 0.5);
        let triangles = self.triangles.iter();
        let relative = move |&triangle| self.corners(triangle).map(|at| subtract(at, middle));
        (middle, triangles.map(relative))
    }

    /// Volume inside, in the file's unit cubed, by the divergence theorem; parts that overlap count twice, and that of
    /// an open mesh depends on the middle of its bounding box.
    pub fn volume(&self) -> f64 {
        let (_, triangles) = self.centered();
        triangles.map(|[a, b, c]| dot(a, cross(b, c)) / 6.0).sum()
    }

    /// Centre of mass of a closed mesh, in the file's unit, by the divergence theorem; parts that overlap count twice.
    /// The middle of the bounding box if the volume is zero.
    pub fn centroid(&self) -> [f64; 3] {
        let (middle, triangles) = self.centered();
        let (mut volume, mut moment) = (0.0, [0.0; 3]);
        for [a, b, c] in triangles {
            let part = dot(a, cross(b, c));
            volume += part;
            moment = add(moment, scale(add(a, add(b, c)), 0.25 * part));
        }
        if volume == 0.0 {
            middle
        } else {
            add(middle, scale(moment, 1.0 / volume))
        }
    }

    /// Area of the surface, in the file's unit squared.
    pub fn area(&self) -> f64 {
        self.triangles.iter().map(|&t| self.area_of(t)).sum()
    }

    pub(crate) fn area_of(&self, triangle: [u32; 3]) -> f64 {
        norm(doubled_normal(self.corners(triangle))) / 2.0
    }

    /// Whether a triangle has no area to speak of.
    pub(crate) fn is_sliver(&self, triangle: [u32; 3]) -> bool {
        let [a, b, c] = self.corners(triangle);
        let longest = longest_side(&[a, b, c]);
        norm(doubled_normal([a, b, c])) <= SLIVER * longest * longest
    }

    /// Whether all vertices are in one plane, to within rounding.
    pub(crate) fn is_flat(&self) -> bool {
        let normal_of = |triangle: &[u32; 3]| doubled_normal(self.corners(*triangle));
        let normals = self
            .triangles
            .iter()
            .map(|triangle| (triangle, normal_of(triangle)));
        let largest = normals.max_by(|(_, a), (_, b)| norm(*a).total_cmp(&norm(*b)));
        let Some((triangle, normal)) = largest else {
            return true;
        };
        let origin = self.positions[triangle[0] as usize];
        let normal = scale(normal, 1.0 / norm(normal));
        let off = |position: &[f64; 3]| dot(subtract(*position, origin), normal).abs();
        self.positions.iter().map(off).fold(0.0, f64::max) <= 1e-13 * self.extent()
    }
}

pub(crate) fn longest_side(&[a, b, c]: &[[f64; 3]; 3]) -> f64 {
    distance(a, b).max(distance(b, c)).max(distance(c, a))
}

pub(crate) fn centroid([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    scale(add(a, add(b, c)), 1.0 / 3.0)
}

/// The normal of a triangle, outward by its orientation, as long as twice its area.
pub(crate) fn doubled_normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    cross(subtract(b, a), subtract(c, a))
}
