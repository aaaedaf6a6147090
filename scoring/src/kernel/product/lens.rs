//! The volume that two balls share: the closed form that the product kernel tends to for alpha -> infinity.

use std::f64::consts::PI;

/// Volume in Å^3 that two balls of radii a and b share at distance d of their centres.
///
/// The smaller ball while d <= |a - b|; else the two caps,
/// pi (a + b - d)^2 (d^2 + 2 d (a + b) - 3 (a - b)^2) / (12 d).
/// Source: Weisstein, "Sphere-Sphere Intersection", MathWorld.
pub fn lens_volume(a: f64, b: f64, distance: f64) -> f64 {
    if distance >= a + b {
        return 0.0;
    }
    if distance <= (a - b).abs() {
        return 4.0 / 3.0 * PI * a.min(b).powi(3);
    }
    let square = distance * distance + 2.0 * distance * (a + b) - 3.0 * (a - b).powi(2);
    PI * (a + b - distance).powi(2) * square / (12.0 * distance)
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
}
