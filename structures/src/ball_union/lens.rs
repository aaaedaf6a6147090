//! The volume that two balls share.

use std::f64::consts::PI;

/// Volume that two balls of radii a and b share at a distance of their centres, in the cube of their unit.
///
/// It is that of the smaller ball while d <= |a - b|. Else it is that of the two caps,
/// pi (a + b - d)^2 (d^2 + 2 d (a + b) - 3 (a - b)^2) / (12 d), written without differences of large numbers.
/// Source: Weisstein, "Sphere-Sphere Intersection", MathWorld.
pub fn lens_volume(a: f64, b: f64, distance: f64) -> f64 {
    let (a, b) = (a.max(b), a.min(b));
    // How far the smaller ball leaves the larger one, of the 2 b that it can.
    let out = (distance - a) + b;
    let left = (a - distance) + b;
    if left <= 0.0 {
        return 0.0;
    }
    if out <= 0.0 || distance <= 0.0 {
        return 4.0 / 3.0 * PI * b.powi(3);
    }
    let square = 4.0 * b * (a - b) + 4.0 * a * out + out * out;
    PI * left * left * (square / (12.0 * distance))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_inside_a_half_covered_one_and_none() {
        // Two unit balls at a distance of 1 share 5 pi / 12.
        assert!((lens_volume(1.0, 1.0, 1.0) - 5.0 * PI / 12.0).abs() < 1e-15);
        assert_eq!(lens_volume(2.0, 1.0, 1.0), 4.0 / 3.0 * PI);
        assert_eq!(lens_volume(2.0, 1.0, 3.0), 0.0);
        // Crossing spheres change places without a difference, and meet the contained ball without a step.
        assert_eq!(lens_volume(2.0, 1.0, 2.3), lens_volume(1.0, 2.0, 2.3));
        assert!((lens_volume(2.0, 1.0, 1.0 + 1e-9) / (4.0 / 3.0 * PI) - 1.0).abs() < 1e-8);
    }

    /// Radii of a million to one: the larger sphere is a plane, and the lens a cap of the smaller ball.
    #[test]
    fn a_small_ball_at_a_large_one_keeps_its_digits() {
        let (a, b) = (1024.0, 1.0 / 1024.0);
        for share in [-0.75, 0.0, 0.5] {
            let height = b * (1.0 - share);
            let cap = PI * height * height * (3.0 * b - height) / 3.0;
            let found = lens_volume(a, b, a + share * b);
            assert!((found / cap - 1.0).abs() < 4e-6, "{share}: {found} {cap}");
        }
        let ball = 4.0 / 3.0 * PI * 0.001f64.powi(3);
        assert!((lens_volume(1000.0, 0.001, 999.0) / ball - 1.0).abs() < 1e-14);
    }
}
