//! The generalised winding number (Jacobson, Kavan and Sorkine-Hornung, ACM Transactions on Graphics 32:4, 2013,
//! article 33).
//!
//! w(x) = (1 / 4 pi) sum of the signed solid angles of all triangles seen from x: a whole number for a closed mesh,
//! harmonic off the surface for any other. Far clusters of triangles count as dipoles (Barill, Dickson, Schmidt, Levin
//! and Jacobson, ACM Transactions on Graphics 37:4, 2018, article 43, first order); where that leaves the sign in
//! doubt, the exact sum decides.

use std::f64::consts::PI;

use crate::mesh::triangle_tree::TriangleTree;
use crate::vector::{cross, dot, norm, subtract};

/// Signed solid angle of a triangle seen from `point`, in steradians: above zero from behind, that is from inside (van
/// Oosterom and Strackee, IEEE Transactions on Biomedical Engineering 30:2, 1983).
fn solid_angle(corners: [[f64; 3]; 3], point: [f64; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| subtract(corner, point));
    let (la, lb, lc) = (norm(a), norm(b), norm(c));
    let volume = dot(a, cross(b, c));
    let below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    2.0 * volume.atan2(below)
}

/// Nearer to a triangle's plane than this share of its distances, a point counts as on the triangle.
const ON_TRIANGLE: f64 = 1e-10;

/// Whether a point is on a triangle, to within rounding.
fn is_on(corners: [[f64; 3]; 3], point: [f64; 3]) -> bool {
    let [a, b, c] = corners.map(|corner| subtract(corner, point));
    let (la, lb, lc) = (norm(a), norm(b), norm(c));
    let rounding = ON_TRIANGLE * la * lb * lc;
    let below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    dot(a, cross(b, c)).abs() <= rounding && below <= rounding
}

/// Rounds of the inside test: a cluster counts as a dipole beyond this many times its radius, and the sum decides when
/// it is farther than this from one half. A dipole's error falls with the square of the first number.
const ROUNDS: [(f64, f64); 2] = [(3.0, 0.1), (10.0, 0.01)];

/// The winding number at `point`, every triangle summed.
pub(crate) fn exact(tree: &TriangleTree, point: [f64; 3]) -> f64 {
    solid_angles(tree.triangles(), point) / (4.0 * PI)
}

fn solid_angles(triangles: &[[[f64; 3]; 3]], point: [f64; 3]) -> f64 {
    triangles
        .iter()
        .map(|&corners| solid_angle(corners, point))
        .sum()
}

/// The winding number at `point`, clusters farther than `far` times their radius as dipoles; `near` sees the
/// triangles that are no part of these.
fn fast(
    tree: &TriangleTree,
    point: [f64; 3],
    far: f64,
    mut near: impl FnMut(&[[[f64; 3]; 3]]),
) -> f64 {
    let mut sum = 0.0;
    tree.visit(0, |node| {
        let away = subtract(node.center, point);
        let distance = norm(away);
        if distance > far * node.radius {
            sum += dot(away, node.area_vector) / (distance * distance * distance);
            return false;
        }
        if let Some(triangles) = tree.leaf(node) {
            near(triangles);
            sum += solid_angles(triangles, point);
            return false;
        }
        true
    });
    sum / (4.0 * PI)
}

/// Whether `point` is inside: its winding number is above one half.
pub(crate) fn is_inside(tree: &TriangleTree, point: [f64; 3]) -> bool {
    for (far, doubt) in ROUNDS {
        let winding = fast(tree, point, far, |_| ());
        if (winding - 0.5).abs() > doubt {
            return winding > 0.5;
        }
    }
    exact(tree, point) > 0.5
}

/// Whether the surface winds about `point`, either way round; none if the point is on it.
pub(crate) fn encloses(tree: &TriangleTree, point: [f64; 3]) -> Option<bool> {
    let mut on = false;
    for (far, doubt) in ROUNDS {
        let winding = fast(tree, point, far, |triangles| {
            on |= triangles.iter().any(|&corners| is_on(corners, point));
        });
        if on {
            return None;
        }
        if (winding.abs() - 0.5).abs() > doubt {
            return Some(winding.abs() > 0.5);
        }
    }
    Some(exact(tree, point).abs() > 0.5)
}
