//! The bump function psi_alpha of B&I eq. (10): a smooth stand-in for the indicator of the unit ball.
//!
//! psi_alpha(x) = exp(1 / (1 - |x|^-alpha)) for |x| < 1, else 0; psi_alpha(0) = 1; alpha -> infinity is the indicator.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

/// The bump function of one exponent alpha > 0 (dimensionless); infinity gives the indicator of the ball.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bump {
    alpha: f64,
}

/// The exponent is not above zero.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("alpha is {0}; the bump function needs an exponent above zero (infinity is allowed)")]
pub struct AlphaError(pub f64);

impl Default for Bump {
    /// B&I's choice, alpha = 2.
    fn default() -> Self {
        Self { alpha: 2.0 }
    }
}

impl Bump {
    /// The bump function psi_alpha.
    ///
    /// # Errors
    /// [`AlphaError`] unless alpha > 0.
    pub fn new(alpha: f64) -> Result<Self, AlphaError> {
        if alpha > 0.0 {
            Ok(Self { alpha })
        } else {
            Err(AlphaError(alpha))
        }
    }

    /// The exponent alpha.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// psi_alpha(x), between 0 and 1.
    ///
    /// Written as exp(-u / (1 - u)) with u = |x|^alpha and 1 - u from `expm1`, so that nothing is lost as x -> 1 or
    /// alpha -> 0.
    pub fn value(&self, x: f64) -> f64 {
        let x = x.abs();
        if x >= 1.0 {
            return 0.0;
        }
        if self.alpha == 2.0 {
            // The default exponent needs no logarithm; 1 - x^2 from its factors keeps the digits near x = 1.
            return (-x * x / ((1.0 - x) * (1.0 + x))).exp();
        }
        if x == 0.0 || self.alpha.is_infinite() {
            return 1.0;
        }
        let log_u = self.alpha * x.ln();
        (log_u.exp() / log_u.exp_m1()).exp()
    }

    /// Integral of the bump over its unit ball, 4 pi times that of x^2 psi_alpha(x) from 0 to 1.
    ///
    /// Midpoints suffice: the integrand vanishes with all its derivatives at 1 and is flat at 0.
    pub fn volume(&self) -> f64 {
        let steps = 20_000;
        let width = 1.0 / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|i| (f64::from(i) + 0.5) * width)
            .map(|x| self.value(x) * x * x)
            .sum();
        4.0 * PI * sum * width
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::double_exponential;

    #[test]
    fn closed_values() {
        let bump = Bump::new(2.0).unwrap();
        assert_eq!(bump.value(0.0), 1.0);
        assert_eq!(bump.value(1.0), 0.0);
        // u = 1/2 at x = 1/sqrt 2, so psi = exp(-1).
        assert!((bump.value(0.5f64.sqrt()) - (-1f64).exp()).abs() < 1e-15);
        assert!((bump.value(-0.5f64.sqrt()) - (-1f64).exp()).abs() < 1e-15);
        assert!(Bump::new(0.0).is_err() && Bump::new(f64::NAN).is_err());
    }

    #[test]
    fn volume_is_the_integral_and_tends_to_that_of_the_ball() {
        for alpha in [0.5, 2.0, 7.0] {
            let bump = Bump::new(alpha).unwrap();
            let step = 1.0 / 64.0;
            let sum: f64 = double_exponential::nodes(step, 256)
                .map(|node| (node.x(), node.slope))
                .map(|(x, slope)| x * x * bump.value(x) * slope * step)
                .sum();
            assert!((bump.volume() - 4.0 * PI * sum).abs() < 1e-9);
        }
        let ball = 4.0 / 3.0 * PI;
        assert!((Bump::new(f64::INFINITY).unwrap().volume() - ball).abs() < 1e-8);
        assert!((Bump::new(1e6).unwrap().volume() - ball).abs() < 1e-4);
    }

    /// Hard case: x -> 1 and extreme alpha, where 1 - |x|^-alpha cancels or overflows as printed in the paper.
    #[test]
    fn stays_finite_and_falls_for_extreme_arguments() {
        for alpha in [1e-6, 1e-2, 0.5, 2.0, 50.0, 1e6, f64::INFINITY] {
            let bump = Bump::new(alpha).unwrap();
            let mut last = 1.0;
            for x in [
                0.0,
                1e-300,
                1e-9,
                0.3,
                0.9,
                1.0 - 1e-9,
                1.0 - f64::EPSILON,
                1.0,
                2.0,
            ] {
                let value = bump.value(x);
                assert!(
                    (0.0..=last).contains(&value),
                    "alpha {alpha}, x {x}: {value}"
                );
                last = value;
            }
        }
        // alpha -> 0: u -> 1 everywhere off the centre, so the bump shrinks to its centre value alone.
        assert!(Bump::new(1e-6).unwrap().value(0.5) < 1e-300);
        // alpha -> infinity: the indicator.
        assert!((Bump::new(1e6).unwrap().value(0.99) - 1.0).abs() < 1e-12);
    }
}
