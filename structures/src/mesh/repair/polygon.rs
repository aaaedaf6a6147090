//! Polygons cut into triangles by ear clipping (Meisters, American Mathematical Monthly 82, 1975).
//!
//! A fan from the first corner, which most readers use, lays triangles outside a face that is not convex: the distance
//! to them is not the distance to the solid.

use crate::mesh::repair::ring::{Ear, Ring};
use crate::mesh::vector::{cross, subtract};

/// Corners up to which every other corner is gone through for each; of more, a tree finds those that are in the way.
const FEW: usize = 64;

/// Appends the triangles of a polygon with three or more corners, in its own orientation.
///
/// A corner may stand there several times, as where a bridge leads from the rim to a hole and back. Vertices are
/// distinguished by their numbers, so those in one place must be one.
///
/// A polygon that crosses itself, is far from plane or has no area gives a fan for what cannot be clipped. O(n log n)
/// for n corners as a rule.
pub fn triangulate(positions: &[[f64; 3]], corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    if let &[a, b, c] = corners {
        triangles.push([a, b, c]);
        return;
    }
    let at = |corner: u32| positions.get(corner as usize).copied().unwrap_or_default();
    let mut left = corners.to_vec();
    // A corner that stands there twice in a row is one; as two it would be a tip without a turn.
    left.dedup();
    while left.len() > 1 && left.first() == left.last() {
        left.pop();
    }
    let normal = newell(corners.iter().map(|&corner| at(corner)));
    if left.len() > FEW {
        Ring::new(&left, at, normal).clip(triangles);
    } else {
        clip_few(left, at, normal, triangles);
    }
}

/// Clips the first of all ears, time after time, in O(n^2) for n corners as a rule.
fn clip_few(
    mut left: Vec<u32>,
    at: impl Fn(u32) -> [f64; 3],
    normal: [f64; 3],
    triangles: &mut Vec<[u32; 3]>,
) {
    while left.len() > 3 {
        let count = left.len();
        let ear = (0..count).find(|&tip| {
            let corners = [
                left[(tip + count - 1) % count],
                left[tip],
                left[(tip + 1) % count],
            ];
            let ear = Ear::new(corners.map(&at), normal);
            ear.is_tip()
                && left
                    .iter()
                    .filter(|other| !corners.contains(other))
                    .all(|&other| !ear.holds(at(other)))
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
    use crate::mesh::vector::{dot, norm};
    use std::f64::consts::TAU;

    /// A polygon about the origin in a tilted plane: corner i at `radius(i)`.
    fn about_origin(count: usize, radius: impl Fn(usize) -> f64) -> Vec<[f64; 3]> {
        let place = |i: usize| {
            let angle = TAU * i as f64 / count as f64;
            let [x, y] = [angle.cos(), angle.sin()].map(|side| radius(i) * side);
            [x, y, 0.3 * x - 0.2 * y]
        };
        (0..count).map(place).collect()
    }

    /// A cap of a million corners took hours, for each ear went through all corners. Convex, a star, and a comb.
    #[test]
    fn polygons_of_many_corners_are_covered_once() {
        let count = 100_000;
        let radii: [fn(usize) -> f64; 3] = [
            |_| 1.0,
            |i| 1.0 + 0.5 * (i % 2) as f64,
            |i| 1.0 + 0.3 * (i as f64 * 1e-3).sin() + 0.1 * (i as f64).sin(),
        ];
        for radius in radii {
            let positions = about_origin(count, radius);
            let corners: Vec<u32> = (0..count as u32).collect();
            let mut triangles = Vec::new();
            triangulate(&positions, &corners, &mut triangles);
            assert_eq!(triangles.len(), count - 2);
            let exact = norm(newell(positions.iter().copied())) / 2.0;
            let found = area(&positions, &triangles);
            assert!((found - exact).abs() < 1e-9 * exact, "{found} {exact}");
        }
        // Without area.
        let line: Vec<[f64; 3]> = (0..count).map(|i| [i as f64, 0.0, 0.0]).collect();
        let corners: Vec<u32> = (0..count as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&line, &corners, &mut triangles);
        assert_eq!(triangles.len(), count - 2);
    }

    /// With a tree and without, a polygon is covered once: jagged, with a bridge to a hole, and crossing itself,
    /// whose triangles sum up to its area with their signs.
    #[test]
    fn few_corners_and_many_are_clipped_to_one_area() {
        let jagged = about_origin(61, |i| 1.0 + 0.9 * (7.3 * i as f64).sin());
        // A rim, a bridge, a hole, and back over the bridge.
        let ring = [
            [0., 0.],
            [9., 0.],
            [9., 9.],
            [0., 9.],
            [3., 3.],
            [3., 6.],
            [6., 6.],
            [6., 3.],
        ];
        let ring = ring.map(|[x, y]| [x, y, 1.0]).to_vec();
        let crossing = (0..40)
            .map(|i| [(i * i % 37) as f64, (i * 5 % 11) as f64, 0.0])
            .collect();
        let in_order = |count: u32| (0..count).collect::<Vec<u32>>();
        for (positions, corners, is_simple) in [
            (jagged, in_order(61), true),
            (ring, vec![0, 1, 2, 3, 0, 4, 5, 6, 7, 4], true),
            (crossing, in_order(40), false),
        ] {
            for turn in [0, 1, corners.len() / 2] {
                let mut corners = corners.clone();
                corners.rotate_left(turn);
                let at = |corner: u32| positions[corner as usize];
                let normal = newell(corners.iter().map(|&corner| at(corner)));
                let exact = norm(normal) / 2.0;
                let (mut few, mut many) = (Vec::new(), Vec::new());
                clip_few(corners.clone(), at, normal, &mut few);
                Ring::new(&corners, at, normal).clip(&mut many);
                for triangles in [few, many] {
                    assert_eq!(triangles.len(), corners.len() - 2);
                    let signed: f64 = triangles
                        .iter()
                        .map(|t| newell(t.iter().map(|&i| at(i))))
                        .map(|part| dot(part, normal) / norm(normal) / 2.0)
                        .sum();
                    assert!((signed - exact).abs() < 1e-12 * exact.max(1.0) * 100.0);
                    if is_simple {
                        let found = area(&positions, &triangles);
                        assert!((found - exact).abs() < 1e-12 * exact, "{found} {exact}");
                    }
                }
            }
        }
    }

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
