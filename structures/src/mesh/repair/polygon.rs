//! Polygons cut into triangles by ear clipping (Meisters, American Mathematical Monthly 82, 1975).
//!
//! A fan from the first corner, which most readers use, lays triangles outside a face that is not convex: the distance
//! to them is not the distance to the solid.

use crate::mesh::vector::{cross, dot, subtract};

/// Appends the triangles of a polygon with three or more corners, in its own orientation.
///
/// A corner may stand there several times, as where a bridge leads from the rim to a hole and back. Vertices are
/// distinguished by their numbers, so those in one place must be one.
///
/// A polygon that crosses itself, is far from plane or has no area gives a fan for what cannot be clipped.
pub fn triangulate(positions: &[[f64; 3]], corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    if let &[a, b, c] = corners {
        triangles.push([a, b, c]);
        return;
    }
    let at = |corner: u32| positions.get(corner as usize).copied().unwrap_or_default();
    let normal = newell(corners.iter().map(|&corner| at(corner)));
    let mut left = corners.to_vec();
    // A corner that stands there twice in a row is one; as two it would be a tip without a turn.
    left.dedup();
    while left.len() > 1 && left.first() == left.last() {
        left.pop();
    }
    while left.len() > 3 {
        let count = left.len();
        let ear = (0..count).find(|&tip| {
            let [a, b, c] = [
                left[(tip + count - 1) % count],
                left[tip],
                left[(tip + 1) % count],
            ];
            let [pa, pb, pc] = [at(a), at(b), at(c)];
            let turn = |p, q, r| dot(cross(subtract(q, p), subtract(r, p)), normal);
            if turn(pa, pb, pc) <= 0.0 {
                return false;
            }
            left.iter()
                .filter(|other| ![a, b, c].contains(other))
                .all(|&other| {
                    let p = at(other);
                    turn(pa, pb, p) < 0.0 || turn(pb, pc, p) < 0.0 || turn(pc, pa, p) < 0.0
                })
        });
        let tip = ear.unwrap_or(1);
        triangles.push([
            left[(tip + count - 1) % count],
            left[tip],
            left[(tip + 1) % count],
        ]);
        left.remove(tip);
    }
    if let &[a, b, c] = left.as_slice() {
        triangles.push([a, b, c]);
    }
}

/// Normal of a polygon, as long as twice its area (Newell's method), about its first corner for the sake of digits.
fn newell(mut points: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    let mut normal = [0.0; 3];
    let Some(first) = points.next() else {
        return normal;
    };
    let mut last = [0.0; 3];
    for point in points {
        let point = subtract(point, first);
        let part = cross(last, point);
        for axis in 0..3 {
            normal[axis] += part[axis];
        }
        last = point;
    }
    normal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vector::norm;

    fn area(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
        triangles
            .iter()
            .map(|t| newell(t.iter().map(|&i| positions[i as usize])))
            .map(|normal| norm(normal) / 2.0)
            .sum()
    }

    /// An L of area 3, from each of its corners: a fan from most of them would cover more than the face.
    #[test]
    fn a_face_that_is_not_convex_is_covered_once() {
        let ring = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        for turn in 0..6 {
            for tilt in [0.0, 0.5] {
                let positions: Vec<[f64; 3]> = (0..6)
                    .map(|i| ring[(i + turn) % 6])
                    .map(|[x, y]| [x, y, 5.0 + tilt * x])
                    .collect();
                let mut triangles = Vec::new();
                triangulate(&positions, &[0, 1, 2, 3, 4, 5], &mut triangles);
                assert_eq!(triangles.len(), 4);
                let expected = 3.0 * (1.0f64 + tilt * tilt).sqrt();
                assert!((area(&positions, &triangles) - expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_face_without_area_or_with_repeated_corners_ends() {
        let positions = [[1.0; 3]; 5];
        let mut triangles = Vec::new();
        triangulate(&positions, &[0, 1, 2, 3, 4], &mut triangles);
        assert_eq!(triangles.len(), 3);
        triangulate(&positions, &[0, 0, 0, 0], &mut triangles);
        assert_eq!(triangles.len(), 3, "nothing is left of it");
    }
}
