//! Meshes that hold their whole surface more than once: both sides of every triangle, as programs for pictures write
//! them, or all of it again.
//!
//! A surface and its reverse bound nothing, and one that is there twice has twice its volume, though it is plain what
//! was meant.

use std::collections::HashMap;

/// Keeps the first of the triangles on the same three vertices, if there are as many on all such sets, all one way
/// round or half of them each way. Returns how often each was there; 1 where nothing is changed.
///
/// Where some triangles alone are repeated, bodies touch or surfaces overlap, and they stay: winding numbers know what
/// to make of them.
pub(in crate::mesh) fn keep_first(triangles: &mut Vec<[u32; 3]>) -> usize {
    let mut sides: HashMap<[u32; 3], [usize; 2]> = HashMap::with_capacity(triangles.len());
    for &triangle in triangles.iter() {
        let (corners, side) = sorted(triangle);
        sides.entry(corners).or_default()[side] += 1;
    }
    let times = triangles.len() / sides.len().max(1);
    let whole = |&[one, other]: &[usize; 2]| {
        one + other == times && (one == other || one == 0 || other == 0)
    };
    let both = |&[one, other]: &[usize; 2]| one > 0 && other > 0;
    let alike = sides.values().all(both) || !sides.values().any(both);
    if times < 2 || !alike || !sides.values().all(whole) {
        return 1;
    }
    triangles.retain(|&triangle| {
        let (corners, _) = sorted(triangle);
        // Each set of corners goes with its first triangle.
        sides.remove(&corners).is_some()
    });
    times
}

/// A triangle's corners by number, and which way round it runs through them.
pub(in crate::mesh) fn sorted(triangle: [u32; 3]) -> ([u32; 3], usize) {
    let mut corners = triangle;
    corners.sort_unstable();
    let next = corners
        .iter()
        .position(|corner| *corner == triangle[0])
        .map_or(0, |first| (first + 1) % 3);
    (corners, usize::from(corners[next] == triangle[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn kept(triangles: &[[u32; 3]]) -> (usize, Vec<[u32; 3]>) {
        let mut triangles = triangles.to_vec();
        let times = keep_first(&mut triangles);
        (times, triangles)
    }

    fn reversed([a, b, c]: [u32; 3]) -> [u32; 3] {
        [b, a, c]
    }

    #[test]
    fn a_surface_there_several_times_is_kept_once() {
        let again = TETRAHEDRON.map(|[a, b, c]| [c, a, b]);
        let back = TETRAHEDRON.map(reversed);
        for (times, copies) in [
            (2, vec![again]),
            (2, vec![back]),
            (3, vec![again, TETRAHEDRON]),
            (4, vec![back, again, back]),
        ] {
            let mut triangles = TETRAHEDRON.to_vec();
            triangles.extend(copies.concat());
            assert_eq!(kept(&triangles), (times, TETRAHEDRON.to_vec()));
        }
        // Side by side in the file.
        let pairs = TETRAHEDRON.map(|triangle| [triangle, reversed(triangle)]);
        assert_eq!(kept(&pairs.concat()), (2, TETRAHEDRON.to_vec()));
    }

    #[test]
    fn what_is_repeated_in_part_stays() {
        let back = TETRAHEDRON.map(reversed);
        let stays = |triangles: Vec<[u32; 3]>| assert_eq!(kept(&triangles), (1, triangles.clone()));
        stays(TETRAHEDRON.to_vec());
        stays([&TETRAHEDRON[..], &TETRAHEDRON[..1]].concat());
        stays([&TETRAHEDRON[..], &back[..3]].concat());
        // Three there twice, and one both ways: two bodies that share it, say.
        stays([&TETRAHEDRON[..], &TETRAHEDRON[..3], &back[3..]].concat());
        // Once and back twice.
        stays([TETRAHEDRON, back, back].concat());
        stays(Vec::new());
    }
}
