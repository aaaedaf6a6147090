//! Long thin triangles cut into shorter pieces, so that trees over them have compact clusters.
//!
//! A cylinder of thousands of sides is as long at every side, whatever the number of sides; a tree can only part its triangles lengthwise, so that
//! each cluster reaches from end to end and no search leaves any out. The surface stays the same; only its pieces change.

use super::Mesh;
use super::surface::halved;
use super::vector::distance;

/// A triangle is a sliver if its longest side is more than this times its height.
const ASPECT: f64 = 16.0;

/// Fewer slivers than this are no trouble.
const FEWEST: usize = 512;

/// Pieces for each sliver, on average, and for all together at most.
const PIECES: usize = 8;
const MOST_PIECES: usize = 1_000_000;

/// No piece is cut that is shorter than this share of the bounding box's longest edge.
const SHORTEST: f64 = 1.0 / 64.0;

/// The triangles that have an area, slivers cut up; none where there are few slivers.
pub(super) fn cut(mesh: &Mesh) -> Option<Vec<[[f64; 3]; 3]>> {
    let triangles = mesh.triangles.iter().copied();
    let triangles: Vec<[[f64; 3]; 3]> = triangles
        .filter(|&triangle| !mesh.is_sliver(triangle))
        .map(|triangle| mesh.corners(triangle))
        .collect();
    let slivers = triangles.iter().filter(|corners| is_thin(corners));
    let (count, length) = slivers.fold((0, 0.0), |(count, length), corners| {
        (count + 1, length + longest(corners))
    });
    if count < FEWEST {
        return None;
    }
    let limit = (length / (PIECES * count).min(MOST_PIECES) as f64).max(SHORTEST * mesh.extent());
    let mut pieces = Vec::with_capacity(triangles.len() + 2 * PIECES * count);
    let mut stack = Vec::new();
    for corners in triangles {
        stack.push(corners);
        while let Some(corners) = stack.pop() {
            if longest(&corners) <= limit || !is_thin(&corners) {
                pieces.push(corners);
            } else {
                stack.extend(halved(corners));
            }
        }
    }
    Some(pieces)
}

fn longest(&[a, b, c]: &[[f64; 3]; 3]) -> f64 {
    distance(a, b).max(distance(b, c)).max(distance(c, a))
}

fn is_thin(corners: &[[f64; 3]; 3]) -> bool {
    let longest = longest(corners);
    longest * longest > ASPECT * super::vector::norm(super::doubled_normal(*corners))
}
