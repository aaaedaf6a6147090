//! Radial functions of terms after the filter of the ranking kernel, in both domains.

use super::RadialFunction;
use crate::kernel::radial_filter::RadialFilter;
use crate::kernel::radial_transform::sinc;
use crate::kernel::table::Table;
use std::f64::consts::PI;

/// Steps of the transform's quadrature over the function's support.
///
/// k is smooth and even and vanishes with all derivatives at the end of its support. So the trapezoidal rule
/// converges faster than any power (tested against four times as many steps).
const STEPS: usize = 400;

/// A filtered radial function.
#[derive(Clone, Debug)]
pub struct EffectKernel {
    filter: RadialFilter,
    band: Vec<f64>,
    profile: Vec<f64>,
}

impl EffectKernel {
    /// Filters a radial function.
    pub fn new(filter: &RadialFilter, radial: &RadialFunction) -> Self {
        let band = filter.band(|w| transform(radial, w, STEPS));
        Self {
            profile: filter.profile(&band),
            band,
            filter: filter.clone(),
        }
    }

    /// Value at a distance in Å; 0 from the filter's reach on.
    pub fn value(&self, distance: f64) -> f64 {
        self.filter.low_passed(&self.band, distance) * self.filter.window(distance)
    }

    /// Transform at |w|, in cycles per Å.
    pub fn spectrum(&self, w: f64) -> f64 {
        self.filter.spectrum_of(&self.profile, w)
    }

    /// The transform as a table over 0 <= |w| <= `w_max`.
    pub fn spectrum_table(&self, w_max: f64) -> Table<1> {
        let panel = 0.125 / self.filter.reach();
        Table::fit(w_max, panel.max(w_max / 2000.0), |w| [self.spectrum(w)])
    }

    /// Distance in Å beyond which the magnitude stays below `threshold`.
    pub fn effective_reach(&self, threshold: f64) -> f64 {
        let step = self.filter.reach() / 400.0;
        (0..400)
            .rev()
            .map(|i| step * f64::from(i))
            .find(|&d| self.value(d).abs() > threshold)
            .unwrap_or(0.0)
    }
}

/// 4 pi integral of d^2 k(d) sinc(2 w d).
fn transform(radial: &RadialFunction, w: f64, steps: usize) -> f64 {
    let step = radial.support / steps as f64;
    let sum: f64 = (1..steps)
        .map(|i| step * i as f64)
        .map(|d| d * d * (radial.value)(d) * sinc(2.0 * w * d))
        .sum();
    4.0 * PI * step * sum
}

#[cfg(test)]
mod tests {
    use super::super::{contact, electrostatics};
    use super::*;

    #[test]
    fn the_quadrature_has_converged() {
        for radial in [electrostatics::RADIAL, contact::RADIAL] {
            let scale = transform(&radial, 0.0, STEPS).abs();
            for w in [0.0, 0.05, 0.1, 0.2, 0.3, 0.5] {
                let (few, many) = (
                    transform(&radial, w, STEPS),
                    transform(&radial, w, 4 * STEPS),
                );
                assert!((few - many).abs() < 1e-11 * scale, "{w}: {few} {many}");
            }
        }
    }

    /// A filter that passes nearly everything gives the radial function back, in both domains.
    #[test]
    fn a_wide_band_gives_the_function_back() {
        let filter = RadialFilter::new(4.0, 6.0, 12.0, 2.0);
        for radial in [electrostatics::RADIAL, contact::RADIAL] {
            let kernel = EffectKernel::new(&filter, &radial);
            let scale = (radial.value)(0.0).abs();
            for d in [0.0, 1.3, 3.0, 5.7, 6.4, 9.0, 11.0] {
                let difference = kernel.value(d) - (radial.value)(d);
                assert!(difference.abs() < 1e-4 * scale, "{d}: {difference}");
            }
            let whole = transform(&radial, 0.0, STEPS);
            for w in [0.0, 0.1, 0.3] {
                let difference = kernel.spectrum(w) - transform(&radial, w, STEPS);
                assert!(difference.abs() < 1e-4 * whole.abs(), "{w}: {difference}");
            }
        }
    }
}
