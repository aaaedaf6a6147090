//! Overlap of two sharp balls (alpha = infinity): volume of their lens and its slope.

use crate::kernel::product::lens_volume;
use std::f64::consts::PI;

/// Lens volume of balls of radii r and s, and its slope by the squared distance of their centres.
///
/// The slope by the distance is -pi rho^2, rho the radius of the circle in which the spheres cross: 0 while one ball
/// lies in the other. Equal balls at one place have a kink there, with slope 0 by symmetry.
#[inline(always)]
pub(super) fn lens_and_slope(r: f64, s: f64, square: f64) -> [f64; 2] {
    let distance = square.sqrt();
    let (sum, difference) = (r + s, (r - s).abs());
    if distance >= sum {
        return [0.0; 2];
    }
    let value = lens_volume(r, s, distance);
    if distance <= difference || distance == 0.0 {
        return [value, 0.0];
    }
    let far = (sum - distance) * (sum + distance);
    let near = (distance - difference) * (distance + difference);
    [value, -PI * far * near / (8.0 * distance * square)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_difference_quotients() {
        for (r, s) in [(1.0, 1.0), (1.0, 3.0), (2e-3, 5.0)] {
            for share in [0.1, 0.4, 0.7, 0.95] {
                let distance = (s - r) + share * 2.0 * r;
                let h = 1e-5 * r;
                let at = |d: f64| lens_and_slope(r, s, d * d)[0];
                let quotient = (at(distance + h) - at(distance - h)) / (2.0 * h);
                let slope = 2.0 * distance * lens_and_slope(s, r, distance * distance)[1];
                assert!((slope - quotient).abs() < 1e-5 * PI * r * r);
            }
            assert_eq!(lens_and_slope(r, s, (s - r) * (s - r))[1], 0.0);
        }
        // Two unit balls at a distance of 1: rho^2 = 3/4.
        assert!((2.0 * lens_and_slope(1.0, 1.0, 1.0)[1] + 0.75 * PI).abs() < 1e-15);
    }
}
