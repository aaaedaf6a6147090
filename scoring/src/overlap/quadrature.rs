//! Overlap of two bumps by quadrature: the reference, what the table is built from, and the way for exponents that no
//! table holds.
//!
//! All lengths are in units of the larger radius, values in units of the smaller radius cubed.

use crate::kernel::product::tail_integral::TailIntegral;
use crate::kernel::table::Table;
use knotdock_structures::numeric::Bump;
use std::f64::consts::PI;

/// Nodes (positive half) and weights of the Gauss-Legendre rule with 8 nodes on [-1, 1].
/// Source: Abramowitz & Stegun, table 25.4.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Distance below which the slope by the squared distance counts as constant: its difference quotient loses digits.
const NEAR_CENTER: f64 = 1e-3;

/// Quadrature over shells of the smaller bump.
///
/// k is the ratio of the radii. M(u, d) is the mean of the larger bump over a sphere of radius u at distance d. The
/// overlap is 4 pi times the integral over 0..1 of t^2 psi(t) M(k t, d).
///
/// M is a difference of tail integrals, as in [`crate::kernel::ProductKernel::overlap`]. If that difference would
/// cancel it is a Gauss sum.
#[derive(Clone, Debug)]
pub(super) struct Quadrature {
    bump: Bump,
    tail: Table<1>,
    /// t and 4 pi t^2 psi(t) dt.
    shells: Vec<(f64, f64)>,
    /// Below this u or d the Gauss sum serves.
    near: f64,
}

impl Quadrature {
    /// Prepares nodes and tail integrals of a bump with a finite exponent.
    pub fn new(bump: Bump) -> Self {
        let alpha = bump.alpha();
        let integral = TailIntegral::new(bump);
        let panel = 1.0 / (64.0 + 2.0 * alpha.min(2e3));
        let count = (64.0 + 32.0 * alpha.min(1e3)) as usize * if alpha < 2.0 { 4 } else { 1 };
        let step = 1.0 / count as f64;
        let shells = (1..count)
            .map(|index| step * index as f64)
            .map(|t| (t, 4.0 * PI * t * t * bump.value(t) * step))
            .filter(|&(_, weight)| weight > 1e-18)
            .collect();
        Self {
            bump,
            tail: Table::fit(1.0, panel, |v| [integral.value(v)]),
            shells,
            near: (0.125 / alpha).min(1.0 / 128.0),
        }
    }

    /// Value at a ratio of radii, 0 (a point that weighs as much as the bump) to 1, and a distance.
    pub fn value(&self, ratio: f64, distance: f64) -> f64 {
        if distance >= 1.0 + ratio {
            return 0.0;
        }
        let mean = |&(t, weight): &(f64, f64)| weight * self.shell_mean(ratio * t, distance);
        self.shells.iter().map(mean).sum()
    }

    /// Value, and slope by the squared distance.
    pub fn value_and_slope(&self, ratio: f64, distance: f64) -> [f64; 2] {
        if distance >= 1.0 + ratio {
            return [0.0; 2];
        }
        let value = self.value(ratio, distance);
        let distance = distance.max(NEAR_CENTER);
        let slope: f64 = self
            .shells
            .iter()
            .map(|&(t, weight)| weight * self.shell_slope(ratio * t, distance))
            .sum();
        [value, slope.min(0.0)]
    }

    /// M(u, d).
    fn shell_mean(&self, u: f64, d: f64) -> f64 {
        let (low, high) = ((d - u).abs(), d + u);
        if low >= 1.0 {
            return 0.0;
        }
        if u.min(d) >= self.near {
            return (self.tail.value(low)[0] - self.tail.value(high)[0]) / (2.0 * u * d);
        }
        let at = |c: f64| self.bump.value((d * d + u * u + 2.0 * d * u * c).sqrt());
        GAUSS
            .iter()
            .map(|&(node, weight)| 0.5 * weight * (at(node) + at(-node)))
            .sum()
    }

    /// Slope of M(u, d) by d^2: with G(v) = v psi(v), (G at the ends of u -+ d in the mean, less its mean between them)
    /// over 2 u d^2.
    fn shell_slope(&self, u: f64, d: f64) -> f64 {
        if (d - u).abs() >= 1.0 {
            return 0.0;
        }
        let end = |v: f64| v * self.bump.value(v);
        let ends = (end(d + u) - end(d - u)) / (2.0 * u);
        (ends - self.shell_mean(u, d)) / (2.0 * d * d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Band, KernelOptions, ProductKernel};

    /// The product kernel's own quadrature is the other way to the same numbers.
    #[test]
    fn agrees_with_the_product_kernel() {
        for alpha in [0.5, 1.0, 2.0, 4.0, 30.0] {
            let options = KernelOptions {
                alpha,
                ..KernelOptions::default()
            };
            let kernel = ProductKernel::new(options, Band::Whole, 10.0, 1.0).unwrap();
            let ours = Quadrature::new(Bump::new(alpha).unwrap());
            for ratio in [1.0f64, 0.83, 0.31, 0.1] {
                let scale = ours.value(ratio, 0.0);
                for share in [0.0, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99] {
                    let d = share * (1.0 + ratio);
                    let exact = kernel.overlap(d, ratio, 1.0) / ratio.powi(3);
                    let error = (ours.value(ratio, d) - exact).abs() / scale;
                    let limit = if alpha < 2.0 { 1e-7 } else { 1e-10 };
                    assert!(error < limit, "{alpha} {ratio} {share}: {error:e}");
                }
            }
        }
    }

    /// A point-like ball reads the bump: V psi(d).
    #[test]
    fn tiny_balls_read_the_bump() {
        for alpha in [1.0, 2.0, 3.0, 8.0] {
            let bump = Bump::new(alpha).unwrap();
            let ours = Quadrature::new(bump);
            for d in [0.0, 1e-3, 0.2, 0.6, 0.9] {
                let value = ours.value(1e-7, d);
                let exact = bump.volume() * bump.value(d);
                let limit = if alpha < 2.0 { 1e-6 } else { 1e-9 };
                assert!((value - exact).abs() < limit * bump.volume(), "{alpha} {d}");
            }
        }
    }

    #[test]
    fn slopes_are_difference_quotients() {
        let ours = Quadrature::new(Bump::new(2.0).unwrap());
        for ratio in [1.0, 0.4, 1e-2, 1e-6] {
            for d in [0.05, 0.3, 0.7, 0.95] {
                let h = 1e-4;
                let quotient =
                    (ours.value(ratio, d + h) - ours.value(ratio, d - h)) / (4.0 * h * d);
                let slope = ours.value_and_slope(ratio, d)[1];
                assert!(
                    (slope - quotient).abs() < 1e-5,
                    "{ratio} {d}: {slope} {quotient}"
                );
            }
        }
    }
}
