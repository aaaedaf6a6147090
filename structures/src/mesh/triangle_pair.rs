//! Two triangles: whether they cross, along which segment, and their closest points. Three steps, the cheap ones first:
//!
//! 1. A plane separates them: one triangle is on one side of the other's plane.
//! 2. They cross: the ends of a side are on either side of the other's plane, and the side passes within its sides.
//! 3. Their closest points give an axis along which they are apart.
//!
//! Let delta bound the error of a coordinate. A sign counts if the number is farther from zero than delta and the
//! arithmetic can make it. So triangles are apart or cross for certain, or the answer is open.

use crate::mesh::solid::nearest_on;
use crate::vector::{along, cross, dot, norm, squared_distance, subtract};

/// Triangles with an area, by their corners.
pub(super) type Triangle = [[f64; 3]; 3];

/// Operations that make up an error: the products and sums of a determinant of differences stay below this many times
/// delta times the square of a length.
pub(super) const OPERATIONS: f64 = 32.0;

/// How two solids, or two of their triangles, are to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshContact {
    /// They share points, or come closer than the margin.
    Met,
    /// They are farther from each other than the margin.
    Apart,
    /// Rounding leaves it open.
    Open,
}

/// How two triangles are to each other, with coordinates that may be off by `delta`.
pub(super) fn contact(a: &Triangle, b: &Triangle, margin: f64, delta: f64) -> MeshContact {
    let sides = [[a, b], [b, a]].map(|[plane, other]| Sides::new(plane, other, margin, delta));
    if sides.iter().any(|sides| sides.apart) {
        return MeshContact::Apart;
    }
    if sides[0].crossed(a, b, delta) || sides[1].crossed(b, a, delta) {
        return MeshContact::Met;
    }
    let [p, q] = closest_points(a, b);
    let axis = subtract(q, p);
    let distance = norm(axis);
    if distance < margin - 4.0 * delta {
        return MeshContact::Met;
    }
    // The closest points may be off; the axis through them is tried, and shows what it shows.
    let along_axis = |triangle: &Triangle| triangle.map(|corner| dot(axis, subtract(corner, p)));
    let from = along_axis(a).into_iter().fold(f64::NEG_INFINITY, f64::max);
    let to = along_axis(b).into_iter().fold(f64::INFINITY, f64::min);
    if to - from > (margin + OPERATIONS * delta) * distance {
        MeshContact::Apart
    } else {
        MeshContact::Open
    }
}

/// Sum of the coordinates of the corner that is farthest by it.
fn corners_reach(triangle: &Triangle, from: [f64; 3]) -> f64 {
    let reach = |corner: &[f64; 3]| {
        let way = subtract(*corner, from);
        way.iter().map(|part| part.abs()).sum::<f64>()
    };
    triangle.iter().map(reach).fold(0.0, f64::max)
}

/// On which side of a triangle's plane the corners of another are.
struct Sides {
    /// Heights above the plane, times the length of the normal.
    heights: [f64; 3],
    /// 1 in front for certain, -1 behind for certain, else 0.
    signs: [i8; 3],
    /// All on one side, farther away than the margin.
    apart: bool,
}

impl Sides {
    fn new(plane: &Triangle, other: &Triangle, margin: f64, delta: f64) -> Self {
        let [a, b, c] = *plane;
        let normal = cross(subtract(b, a), subtract(c, a));
        let reach = corners_reach(plane, a);
        let error = OPERATIONS * delta * reach * (reach + corners_reach(other, a));
        let heights = other.map(|corner| dot(normal, subtract(corner, a)));
        let beyond = error + margin * norm(normal) * (1.0 + 1e-12);
        let signs = heights.map(|height| match height {
            _ if height > error => 1,
            _ if height < -error => -1,
            _ => 0,
        });
        Self {
            heights,
            signs,
            apart: heights.iter().all(|&height| height > beyond)
                || heights.iter().all(|&height| height < -beyond),
        }
    }

    /// Whether an edge of `other` crosses the triangle for certain.
    fn crossed(&self, triangle: &Triangle, other: &Triangle, delta: f64) -> bool {
        [[0, 1], [1, 2], [2, 0]].iter().any(|&[from, to]| {
            self.signs[from] * self.signs[to] == -1
                && passes(triangle, [other[from], other[to]], delta) == Some(true)
        })
    }
}

/// Whether the line through an edge passes within the sides of a triangle; `None` if rounding can change that.
fn passes([a, b, c]: &Triangle, [from, to]: [[f64; 3]; 2], delta: f64) -> Option<bool> {
    let way = subtract(to, from);
    let [a, b, c] = [a, b, c].map(|corner| subtract(*corner, from));
    let reach = [a, b, c, way].map(|v| v.iter().map(|part| part.abs()).sum::<f64>());
    let reach = reach.into_iter().fold(0.0, f64::max);
    let error = OPERATIONS * delta * reach * reach;
    let around = [cross(a, b), cross(b, c), cross(c, a)].map(|normal| dot(way, normal));
    let counts = [1.0, -1.0].map(|sign| around.iter().filter(|&side| sign * side > error).count());
    match counts {
        [3, _] | [_, 3] => Some(true),
        [0, _] | [_, 0] => None,
        _ => Some(false),
    }
}

/// How two triangles are to each other.
pub(super) enum Relation {
    Apart,
    /// They cross along a segment.
    Cross([End; 2]),
    /// Rounding leaves it open.
    Open,
}

/// An end of the segment along which two triangles cross: a side of one passes through the other.
#[derive(Clone, Copy)]
pub(super) struct End {
    pub point: [f64; 3],
    /// Whether it is a side of the second triangle.
    pub of_second: bool,
    /// Number of the side: it begins at the corner of this number.
    pub side: usize,
    /// Share of the side before the point.
    pub share: f64,
    /// Whether the side leaves the solid behind the other triangle there.
    pub leaves: bool,
}

/// How two triangles are to each other, by signs that rounding cannot change.
pub(super) fn relation(a: &Triangle, b: &Triangle, delta: f64) -> Relation {
    let sides = [[b, a], [a, b]].map(|[plane, other]| Sides::new(plane, other, 0.0, delta));
    if sides.iter().any(|sides| sides.apart) {
        return Relation::Apart;
    }
    let mut ends = [None; 2];
    let mut found = 0;
    let mut certain = true;
    for (second, (sides, [other, plane])) in sides.iter().zip([[a, b], [b, a]]).enumerate() {
        for side in 0..3 {
            let next = (side + 1) % 3;
            let signs = [sides.signs[side], sides.signs[next]];
            certain &= signs[0] != 0;
            if signs[0] * signs[1] != -1 {
                continue;
            }
            match passes(plane, [other[side], other[next]], delta) {
                Some(false) => {}
                None => certain = false,
                Some(true) => {
                    let [from, to] = [sides.heights[side], sides.heights[next]];
                    let way = subtract(other[next], other[side]);
                    let share = from / (from - to);
                    if let Some(end) = ends.get_mut(found) {
                        *end = Some(End {
                            point: along(other[side], share, way),
                            share,
                            of_second: second == 1,
                            side,
                            leaves: signs[1] > 0,
                        });
                    }
                    found += 1;
                }
            }
        }
    }
    match (certain, found, ends) {
        (true, 0, _) => Relation::Apart,
        (true, 2, [Some(from), Some(to)]) => Relation::Cross([from, to]),
        // A corner in the other's plane, beside the other.
        _ if contact(a, b, 0.0, delta) == MeshContact::Apart => Relation::Apart,
        _ => Relation::Open,
    }
}

/// Whether triangles that share one corner cross beside it for certain.
pub(super) fn crosses_beside(a: &Triangle, b: &Triangle, delta: f64) -> bool {
    [[a, b], [b, a]].into_iter().any(|[plane, other]| {
        let sides = Sides::new(plane, other, 0.0, delta);
        sides.crossed(plane, other, delta)
    })
}

/// Closest points of two triangles that do not cross: of a corner and a triangle, or of two edges.
pub(super) fn closest_points(a: &Triangle, b: &Triangle) -> [[f64; 3]; 2] {
    let mut best = (f64::INFINITY, [a[0], b[0]]);
    let mut offer = |points: [[f64; 3]; 2]| {
        let squared = squared_distance(points[0], points[1]);
        if squared < best.0 {
            best = (squared, points);
        }
    };
    for &corner in a {
        offer([corner, nearest_on(*b, corner)]);
    }
    for &corner in b {
        offer([nearest_on(*a, corner), corner]);
    }
    for (i, &from) in a.iter().enumerate() {
        for (j, &other) in b.iter().enumerate() {
            let points = between_lines([from, a[(i + 1) % 3]], [other, b[(j + 1) % 3]]);
            points.into_iter().for_each(&mut offer);
        }
    }
    best.1
}

/// Closest points of the lines through two edges, if both are on the edges.
fn between_lines([a, b]: [[f64; 3]; 2], [c, d]: [[f64; 3]; 2]) -> Option<[[f64; 3]; 2]> {
    let (first, second, way) = (subtract(b, a), subtract(d, c), subtract(c, a));
    let normal = cross(first, second);
    let square = dot(normal, normal);
    let s = dot(cross(way, second), normal) / square;
    let t = dot(cross(way, first), normal) / square;
    let on = |share: f64| (0.0..=1.0).contains(&share);
    (on(s) && on(t)).then(|| [along(a, s, first), along(c, t, second)])
}
