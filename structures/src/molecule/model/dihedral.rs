//! Dihedral angles, and turns about a bond.

/// Dihedral angle in radians, -pi to pi, of four places: clockwise is positive when looking from the second to the
/// third (IUPAC-IUB, J. Mol. Biol. 52 (1970) 1-17). Zero where three of them lie in a line.
pub(crate) fn dihedral([a, b, c, d]: [[f64; 3]; 4]) -> f64 {
    let (first, axis, last) = (minus(b, a), minus(c, b), minus(d, c));
    let (left, right) = (cross(first, axis), cross(axis, last));
    (dot(axis, axis).sqrt() * dot(first, right)).atan2(dot(left, right))
}

/// The place of a point after a right-handed turn by `angle` (radians) about the axis from `from` to `to`; the point
/// itself where the two coincide. Source: Rodrigues' formula.
pub(crate) fn turned(point: [f64; 3], from: [f64; 3], to: [f64; 3], angle: f64) -> [f64; 3] {
    let axis = minus(to, from);
    let length = dot(axis, axis).sqrt();
    if length == 0.0 {
        return point;
    }
    let axis = axis.map(|x| x / length);
    let arm = minus(point, from);
    let (sin, cos) = angle.sin_cos();
    let across = cross(axis, arm);
    let along = dot(axis, arm) * (1.0 - cos);
    std::array::from_fn(|k| from[k] + arm[k] * cos + across[k] * sin + axis[k] * along)
}

/// Whether an amino acid is of the L form: seen from CA with the side chain up, CO-R-N read clockwise.
pub(crate) fn is_left_handed(n: [f64; 3], ca: [f64; 3], c: [f64; 3], cb: [f64; 3]) -> bool {
    dot(cross(minus(n, ca), minus(c, ca)), minus(cb, ca)) > 0.0
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_turn_adds_to_the_dihedral_angle() {
        let [a, b, c] = [[1.0, 0.3, -0.2], [0.0; 3], [0.1, -0.2, 1.5]];
        let d = [1.0, 0.1, 2.0];
        let before = dihedral([a, b, c, d]);
        for angle in [0.0, 0.4, -1.3, 2.0] {
            let after = turned(d, b, c, angle);
            let difference = dihedral([a, b, c, after]) - before - angle;
            let turns = (difference / std::f64::consts::TAU).round();
            assert!((difference - turns * std::f64::consts::TAU).abs() < 1e-12);
        }
    }

    /// Looking down +z from b to c, a at +x and d at +y is a quarter turn clockwise.
    #[test]
    fn clockwise_is_positive() {
        let places = [[1.0, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
        assert!((dihedral(places) - FRAC_PI_2).abs() < 1e-15);
    }
}
