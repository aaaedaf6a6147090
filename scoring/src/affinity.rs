//! The complex double-skin affinity function (B&I eq. 51) as lifted knots.
//!
//! F_S = i (f_{S+B0} - lambda f_S): the solid grown by r0, less lambda times the solid itself, times i. On lifted knots
//! growth is a shift along the radius axis. So F_S is again a set of lifted knots, twice as many, with complex weights:
//! (x, r + r0) with i c and (x, r) with -i lambda c.
//!
//! The product of two such functions is the score G = -lambda^2 g(0) + 2 lambda g(r0) - g(2 r0). No factor is
//! conjugated: B&I's eq. 52-53 conjugate one and so lose the sign i * i = -1 that their text needs.

use knotdock_structures::Knots;
use num_complex::Complex64;
use std::f64::consts::PI;

/// The affinity function of a solid: weight lambda of its inside against its skin, and skin offset r0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleSkin {
    /// Weight of the solid against its grown self (dimensionless).
    pub lambda: f64,
    /// Skin offset r0, in Å.
    pub offset: f64,
}

/// Lifted knots (x, r) with complex weights.
///
/// The arrays have the same length: the skin's knots first, in the solid's order, then the core's.
#[derive(Clone, Debug, PartialEq)]
pub struct AffinityKnots {
    centers: Vec<[f64; 3]>,
    radii: Vec<f64>,
    weights: Vec<Complex64>,
}

impl AffinityKnots {
    /// Centres x, in Å.
    pub fn centers(&self) -> &[[f64; 3]] {
        &self.centers
    }

    /// Places r on the radius axis, in Å.
    pub fn radii(&self) -> &[f64] {
        &self.radii
    }

    /// Weights (dimensionless).
    pub fn weights(&self) -> &[Complex64] {
        &self.weights
    }
}

impl DoubleSkin {
    /// The affinity function of a solid as one array of lifted knots.
    pub fn knots(&self, solid: &Knots) -> AffinityKnots {
        let skin = Complex64::new(0.0, 1.0);
        let core = Complex64::new(0.0, -self.lambda);
        AffinityKnots {
            centers: [&solid.centers[..], &solid.centers[..]].concat(),
            radii: solid
                .radii
                .iter()
                .map(|r| r + self.offset)
                .chain(solid.radii.iter().copied())
                .collect(),
            weights: solid
                .weights
                .iter()
                .map(|c| c * skin)
                .chain(solid.weights.iter().map(|c| c * core))
                .collect(),
        }
    }

    /// The factor by which one affinity function multiplies a lifted mode eta: i (exp(-2 pi i eta r0) - lambda).
    ///
    /// Its square is the weight of the three slices, -lambda^2 + 2 lambda exp(-2 pi i eta r0) - exp(-4 pi i eta r0).
    pub fn multiplier(&self, eta: f64) -> Complex64 {
        Complex64::i() * (Complex64::cis(-2.0 * PI * eta * self.offset) - self.lambda)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squared_multiplier_is_the_weight_of_the_three_slices() {
        let skin = DoubleSkin {
            lambda: 10.0,
            offset: 2.0,
        };
        for eta in [0.0, 0.1, -0.37] {
            let shift = Complex64::cis(-2.0 * PI * eta * 2.0);
            let slices = -100.0 + 20.0 * shift - shift * shift;
            assert!((skin.multiplier(eta).powi(2) - slices).norm() < 1e-12);
        }
    }
}
