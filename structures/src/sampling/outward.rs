//! Largest distance of the balls outside of a solid, by a search on their spheres.
//!
//! The distance to the solid changes along a sphere by no more than one walks on it. Take a patch of the sphere whose
//! middle is a distance d from the solid, and whose points are within s of the middle. It holds no point farther than
//! d + s. Patches that can hold the farthest point are cut in four until they can exceed the known distance by no
//! more than a tolerance.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::ball::Ball;
use crate::mesh::Solid;
use crate::vector::{add, along, distance, norm, scale};

/// Points that are looked at for all balls together, at most.
const MAX_POINTS: usize = 200_000;

/// Points that are looked at for one ball, at most.
const MAX_OF_ONE: usize = 20_000;

/// A triangle on the unit sphere, and the distance that none of its points exceeds.
struct Patch {
    corners: [[f64; 3]; 3],
    bound: f64,
}

impl PartialEq for Patch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Patch {}

impl PartialOrd for Patch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Patch {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

/// The farthest that a point of the balls' spheres is from the solid, to within `tolerance` of the true value
/// unless there are very many balls alike; no less than `seen`. Each ball comes with a distance that no point of it
/// exceeds.
pub(super) fn farthest(
    solid: &Solid,
    mut balls: Vec<(f64, Ball)>,
    seen: f64,
    tolerance: f64,
) -> f64 {
    balls.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut seen = seen;
    let mut left = MAX_POINTS;
    for (bound, ball) in balls {
        if bound <= seen + tolerance || left == 0 {
            break;
        }
        let mut points = left.min(MAX_OF_ONE);
        left -= points;
        farthest_of(solid, &ball, &mut seen, tolerance, &mut points);
        left += points;
    }
    seen
}

/// Raises `seen` to the farthest that a point of one sphere is from the solid, by looking at no more than `points`
/// of it.
fn farthest_of(solid: &Solid, ball: &Ball, seen: &mut f64, tolerance: f64, points: &mut usize) {
    let mut patches = BinaryHeap::new();
    let look = |corners: [[f64; 3]; 3], seen: &mut f64| {
        let middle = unit(add(corners[0], add(corners[1], corners[2])));
        let reach = corners.map(|corner| distance(corner, middle));
        let reach = reach.into_iter().fold(0.0, f64::max) * ball.radius;
        let out = -solid.depth(along(ball.center, ball.radius, middle));
        *seen = seen.max(out);
        Patch {
            corners,
            bound: out + reach,
        }
    };
    for octant in 0..8 {
        let corners = [0, 1, 2].map(|axis| {
            let mut corner = [0.0; 3];
            corner[axis] = if octant >> axis & 1 == 0 { 1.0 } else { -1.0 };
            corner
        });
        patches.push(look(corners, seen));
    }
    while let Some(Patch { corners, bound }) = patches.pop() {
        if bound <= *seen + tolerance || *points < 4 {
            break;
        }
        *points -= 4;
        let [a, b, c] = corners;
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| unit(add(p, q)));
        for corners in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
            patches.push(look(corners, seen));
        }
    }
}

fn unit(direction: [f64; 3]) -> [f64; 3] {
    scale(direction, 1.0 / norm(direction))
}
