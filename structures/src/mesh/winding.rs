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

/// A complex number, real part first, whose argument is half the signed solid angle of a triangle seen from `point`: above
/// zero from behind, that is from inside (van Oosterom and Strackee, IEEE Transactions on Biomedical Engineering 30:2, 1983).
#[inline]
fn half_angle([a, b, c]: [[f64; 3]; 3], point: [f64; 3]) -> [f64; 2] {
    let (a, b, c) = (subtract(a, point), subtract(b, point), subtract(c, point));
    let (la, lb, lc) = (norm(a), norm(b), norm(c));
    let below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    [below, dot(a, cross(b, c))]
}

/// Signed solid angle of a triangle seen from `point`, in steradians.
fn solid_angle(corners: [[f64; 3]; 3], point: [f64; 3]) -> f64 {
    let [below, volume] = half_angle(corners, point);
    2.0 * volume.atan2(below)
}

/// Nearer to a triangle's plane than this share of its distances, a point counts as on the triangle.
const ON_TRIANGLE: f64 = 1e-10;

/// Whether a point is on a triangle, to within rounding.
fn is_on(corners: [[f64; 3]; 3], point: [f64; 3]) -> bool {
    let [a, b, c] = corners.map(|corner| subtract(corner, point));
    let rounding = ON_TRIANGLE * norm(a) * norm(b) * norm(c);
    let [below, volume] = half_angle(corners, point);
    volume.abs() <= rounding && below <= rounding
}

/// Rounds of the inside test: a cluster counts as a dipole beyond this many times its radius, and the sum decides when
/// it is farther than this from one half. A dipole's error falls with the square of the first number.
const ROUNDS: [(f64, f64); 2] = [(3.0, 0.1), (10.0, 0.01)];

/// The winding number at `point`, every triangle summed.
pub(crate) fn exact(tree: &TriangleTree, point: [f64; 3]) -> f64 {
    let angles = tree.triangles().iter();
    let angles = angles.map(|&corners| solid_angle(corners, point));
    angles.sum::<f64>() / (4.0 * PI)
}

/// Sizes of a product of complex numbers whose digits are all there.
const IN_RANGE: std::ops::Range<f64> = 1e-200..1e200;

/// The sum of the solid angles of triangles. Arguments add where complex numbers are multiplied, so one arctangent serves
/// many of them.
fn solid_angles(triangles: &[[[f64; 3]; 3]], point: [f64; 3]) -> f64 {
    let (mut sum, mut turns) = (0.0, 0.0);
    let [mut re, mut im] = [1.0f64, 0.0f64];
    for &corners in triangles {
        let [c, d] = half_angle(corners, point);
        // Zero of a triangle that has a corner at the point: it has no argument.
        if !IN_RANGE.contains(&((re.abs() + im.abs()) * (c.abs() + d.abs()))) {
            sum += im.atan2(re) + d.atan2(c);
            [re, im] = [1.0, 0.0];
            continue;
        }
        let product = re * d + im * c;
        // Beyond half a turn the argument of the product is a whole one off. Zeros have signs, as in an arctangent: those
        // of a triangle that the point is on say from which side it is seen.
        let (one, other) = (im.is_sign_negative(), d.is_sign_negative());
        if one == other && one != product.is_sign_negative() {
            turns += if one { -1.0 } else { 1.0 };
        }
        [re, im] = [re * c - im * d, product];
    }
    2.0 * (sum + im.atan2(re)) + 4.0 * PI * turns
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
        let (square, reach) = (dot(away, away), far * node.radius);
        if square > reach * reach {
            sum += dot(away, node.area_vector) / (square * square.sqrt());
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::array::uniform3;
    use proptest::collection::vec;
    use proptest::prelude::*;

    /// Whole numbers put points on planes, sides and corners of triangles.
    fn point() -> impl Strategy<Value = [f64; 3]> {
        uniform3(prop_oneof![(-2i8..=2).prop_map(f64::from), -2.0..2.0f64])
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn one_arctangent_says_what_many_do(
            triangles in vec(uniform3(point()), 1..40),
            from in point(),
            flat in 0..6usize,
            size in prop::sample::select(vec![1e-90, 1e-20, 1.0, 1e40]),
        ) {
            // In half of the cases everything is in one plane: all volumes are zero, of either sign.
            let place = |point: [f64; 3]| [0, 1, 2].map(|axis| if axis == flat { 0.0 } else { size * point[axis] });
            let triangles: Vec<_> = triangles.iter().map(|corners| corners.map(place)).collect();
            let from = place(from);
            let found = solid_angles(&triangles, from);
            let expected: f64 = triangles.iter().map(|&corners| solid_angle(corners, from)).sum();
            prop_assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
}
