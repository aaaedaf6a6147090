//! The overlap of two balls' bumps as a function of their radii and distance.

use super::pair_table::{PairTable, Place};
use super::quadrature::Quadrature;
use crate::kernel::product::lens_volume;
use crate::vectorized::with_simd;
use knotdock_structures::numeric::Bump;
use knotdock_structures::numeric::bump::AlphaError;
use pulp::Simd;
use std::f64::consts::PI;

/// <psi_r, psi_s>(d) of any two radii, with its slope, for one exponent alpha.
///
/// - alpha = 2: a table, built in some 100 ms; tens of nanoseconds per value. Errors are below 1e-8 of the value at d = 0,
///   and those of the slope below 1e-5 of that over the larger radius.
/// - alpha from 2 to 4: the same table if it reaches 5e-7 ([`Self::error`]), built in some 300 ms.
/// - alpha = infinity: the volume of the lens, in closed form.
/// - Other exponents: quadrature, some microseconds per value.
///
/// The overlap is exactly 0 from d = r + s on, and underflows just before. So [`meet`] decides contact, never this value.
#[derive(Clone, Debug)]
pub struct PairOverlap {
    bump: Bump,
    method: Method,
}

#[derive(Clone, Debug)]
enum Method {
    Sharp,
    Table(PairTable),
    Quadrature(Quadrature),
}

/// Whether two balls meet, d < r + s: the test of contact.
#[inline(always)]
pub fn meet(r: f64, s: f64, square: f64) -> bool {
    square < (r + s) * (r + s)
}

impl PairOverlap {
    /// The overlap of bumps of an exponent, infinity among them.
    ///
    /// # Errors
    /// [`AlphaError`] unless alpha > 0.
    pub fn new(alpha: f64) -> Result<Self, AlphaError> {
        let bump = Bump::new(alpha)?;
        let method = if alpha.is_infinite() {
            Method::Sharp
        } else {
            let quadrature = Quadrature::new(bump);
            match PairTable::new(bump, &quadrature) {
                Some(table) => Method::Table(table),
                None => Method::Quadrature(quadrature),
            }
        };
        Ok(Self { bump, method })
    }

    /// The bump.
    pub fn bump(&self) -> Bump {
        self.bump
    }

    /// Error of a value as a share of that at d = 0: what the table's fit was measured to miss, else that of the
    /// quadrature.
    pub fn error(&self) -> f64 {
        match &self.method {
            Method::Sharp => 1e-15,
            Method::Table(table) => table.error(),
            Method::Quadrature(_) if self.bump.alpha() < 1.0 => 1e-5,
            Method::Quadrature(_) if self.bump.alpha() < 2.0 => 1e-6,
            Method::Quadrature(_) => 1e-9,
        }
    }

    /// Overlap and its slope by the distance, for radii r and s (above 0) at a distance of their centres.
    pub fn value_and_slope(&self, r: f64, s: f64, distance: f64) -> (f64, f64) {
        let (kernel, radii, square) = (self, [r.min(s), r.max(s)], distance * distance);
        let [value, by_square] = with_simd!(
            <'a>(kernel: &'a PairOverlap, radii: [f64; 2], square: f64) -> [f64; 2],
            |simd| kernel.placed(simd, radii, square, &Place::new(radii[0], radii[1], square))
        );
        (value, 2.0 * distance * by_square)
    }

    /// Overlap and its slope by the squared distance, of a pair whose place in the table is known.
    #[inline(always)]
    pub(super) fn placed<S: Simd>(
        &self,
        simd: S,
        [small, large]: [f64; 2],
        square: f64,
        place: &Place,
    ) -> [f64; 2] {
        match &self.method {
            Method::Table(table) => {
                let [value, slope] = table.value(simd, place);
                let cube = small * small * small;
                [cube * value, cube * slope / (small * small + large * large)]
            }
            Method::Sharp => lens_and_slope(small, large, square),
            Method::Quadrature(quadrature) => {
                let (cube, unit) = (small * small * small, 1.0 / large);
                let distance = square.sqrt() * unit;
                let [value, slope] = quadrature.value_and_slope(place.ratio, distance);
                [cube * value, cube * slope * unit * unit]
            }
        }
    }
}

/// Lens volume of balls of radii r and s, and its slope by the squared distance of their centres.
///
/// The slope by the distance is -pi rho^2, rho the radius of the circle in which the spheres cross: 0 if one ball is in
/// the other or both coincide.
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
