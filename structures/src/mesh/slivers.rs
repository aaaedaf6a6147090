//! Long thin triangles cut into shorter pieces, so that trees over them have compact clusters.
//!
//! A tree can only divide the sides of a cylinder lengthwise, so that each cluster reaches from end to end and no search
//! leaves any out. The surface stays the same; only its pieces change.

use crate::mesh::triangle_mesh::{Mesh, doubled_normal, longest_side};
use crate::vector::{along, distance, norm, subtract};

/// A triangle is a sliver if its longest side is more than this times its height.
const ASPECT: f64 = 16.0;

/// Fewer slivers than this are no trouble.
const MIN_COUNT: usize = 512;

/// Lengths into which a sliver is cut, on average, and all together at most.
const LENGTHS: usize = 24;
const MAX_LENGTHS: usize = 400_000;

/// No sliver is cut into lengths shorter than this share of the bounding box's longest edge.
const MIN_LENGTH: f64 = 1.0 / 64.0;

/// The triangles that have an area, slivers cut up; none where there are few slivers.
pub(super) fn cut(mesh: &Mesh) -> Option<Vec<[[f64; 3]; 3]>> {
    let triangles: Vec<_> = mesh.with_area(mesh.triangles.iter().copied()).collect();
    let slivers = triangles.iter().filter(|corners| is_thin(corners));
    let (count, length) = slivers.fold((0, 0.0), |(count, length), corners| {
        (count + 1, length + longest_side(corners))
    });
    if count < MIN_COUNT {
        return None;
    }
    let limit =
        (length / (LENGTHS * count).min(MAX_LENGTHS) as f64).max(MIN_LENGTH * mesh.extent());
    let mut pieces = Vec::new();
    for corners in triangles {
        if is_thin(&corners) {
            let count = (longest_side(&corners) / limit).ceil() as usize;
            cut_across(corners, count, &mut pieces);
        } else {
            pieces.push(corners);
        }
    }
    Some(pieces)
}

/// Cuts a triangle across its two longer sides into `count` strips, all as wide, of two triangles each but for the
/// one at the tip.
fn cut_across(corners: [[f64; 3]; 3], count: usize, pieces: &mut Vec<[[f64; 3]; 3]>) {
    let [a, b, c] = corners;
    let shortest = [distance(a, b), distance(b, c), distance(c, a)];
    // The tip is opposite to the shortest side.
    let [tip, left, right] = if shortest[1] <= shortest[0] && shortest[1] <= shortest[2] {
        [a, b, c]
    } else if shortest[2] <= shortest[0] {
        [b, c, a]
    } else {
        [c, a, b]
    };
    let at = |end: [f64; 3], step: usize| match step == count {
        true => end,
        false => along(tip, step as f64 / count as f64, subtract(end, tip)),
    };
    pieces.push([tip, at(left, 1), at(right, 1)]);
    for step in 1..count {
        let [p, q] = [at(left, step), at(left, step + 1)];
        let [r, s] = [at(right, step), at(right, step + 1)];
        pieces.extend([[p, q, s], [p, s, r]]);
    }
}

fn is_thin(corners: &[[f64; 3]; 3]) -> bool {
    let longest = longest_side(corners);
    longest * longest > ASPECT * norm(doubled_normal(*corners))
}
