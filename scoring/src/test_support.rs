//! Test data that unit tests of several modules share.

use knotdock_structures::Knots;
use num_complex::Complex64;

/// The complex double-skin affinity function of a solid (B&I eq. 51) as lifted knots (x, r) with complex weights.
///
/// F_S = i (f_{S+B0} - lambda f_S). On lifted knots growth is a shift along the radius axis, so F_S is (x, r + r0) with
/// the weights i c, then (x, r) with -i lambda c. The product of two such functions is the score. No factor is conjugated:
/// B&I's eq. 52-53 conjugate one and so lose the sign i * i = -1 that their text needs.
#[allow(dead_code, reason = "not every test program reads it")]
pub struct AffinityKnots {
    /// Centres x, Å.
    pub centers: Vec<[f64; 3]>,
    /// Places r on the radius axis, Å.
    pub radii: Vec<f64>,
    /// Weights (dimensionless).
    pub weights: Vec<Complex64>,
}

#[allow(dead_code, reason = "not every test program reads it")]
impl AffinityKnots {
    /// The function of a solid with the penalty lambda and the skin offset r0 (Å).
    pub fn of(solid: &Knots, lambda: f64, offset: f64) -> Self {
        let (skin, core) = (Complex64::new(0.0, 1.0), Complex64::new(0.0, -lambda));
        let grown = solid.radii.iter().map(|r| r + offset);
        let of_skin = solid.weights.iter().map(|c| c * skin);
        Self {
            centers: [&solid.centers[..], &solid.centers[..]].concat(),
            radii: grown.chain(solid.radii.iter().copied()).collect(),
            weights: of_skin
                .chain(solid.weights.iter().map(|c| c * core))
                .collect(),
        }
    }
}

/// Numbers in [0, 1) from a linear congruence: the same everywhere and for ever.
pub struct Numbers(pub u64);

impl Numbers {
    /// The next one.
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}
