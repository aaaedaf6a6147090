//! The filter of the ranking kernel, for any radial function: a low-pass in the Fourier domain, then a window in the
//! real one.
//!
//! The low-pass W(|w|) is 1 up to the pass frequency and falls C-infinity to 0 at the stop frequency; the window V(d)
//! is 1 where kernels live and falls C-infinity to 0 at the reach. Both are linear, so they apply to slices, lifted
//! modes and the kernels of further effects alike, and all of them end at one reach and one frequency.
//!
//! Both integrals are trapezoidal sums of smooth even functions that vanish with all derivatives at their ends, for
//! which that rule converges faster than any power. The remainder of the sums is part of the definition: every engine and
//! the exact sum use them.

use super::radial_transform::sinc;
use std::f64::consts::PI;

/// Low-pass and window. Lengths in the unit of the knots (Å for molecules), frequencies in cycles per that unit.
#[derive(Clone, Debug)]
pub struct RadialFilter {
    stop: f64,
    /// Frequencies w_n = n dw below the stop and 4 pi w_n^2 W(w_n) dw.
    frequencies: Vec<f64>,
    band_weights: Vec<f64>,
    /// Distances d_m = m dd below the reach and 4 pi d_m^2 V(d_m) dd.
    distances: Vec<f64>,
    window_weights: Vec<f64>,
    window_start: f64,
    reach: f64,
}

impl RadialFilter {
    /// A filter that passes all below `pass`, nothing from `stop` on, for kernels that live within `support`. The
    /// low-pass rings over lengths of 1 / (stop - pass); the window falls over `reach_factor` of them, beginning soon
    /// after the support.
    pub(crate) fn new(pass: f64, stop: f64, support: f64, reach_factor: f64) -> Self {
        let [window_start, reach] = Self::window_ends(pass, stop, support, reach_factor);
        let frequency_step = 1.0 / (8.0 * reach);
        let frequencies: Vec<f64> = (0..)
            .map(|n| f64::from(n) * frequency_step)
            .take_while(|&w| w < stop)
            .collect();
        let band_weights = frequencies
            .iter()
            .map(|&w| 4.0 * PI * w * w * smooth_step_down(w, pass, stop) * frequency_step)
            .collect();
        let distance_step = 1.0 / (8.0 * stop);
        let distances: Vec<f64> = (0..)
            .map(|m| f64::from(m) * distance_step)
            .take_while(|&d| d < reach)
            .collect();
        let window_weights = distances
            .iter()
            .map(|&d| 4.0 * PI * d * d * smooth_step_down(d, window_start, reach) * distance_step)
            .collect();
        Self {
            stop,
            frequencies,
            band_weights,
            distances,
            window_weights,
            window_start,
            reach,
        }
    }

    /// Start and end of the fall of such a filter's window.
    pub(super) fn window_ends(pass: f64, stop: f64, support: f64, reach_factor: f64) -> [f64; 2] {
        let ring = 1.0 / (stop - pass);
        let start = support + 0.15 * ring;
        [start, start + reach_factor * ring]
    }

    /// Distance from which every filtered kernel is exactly 0.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Stop frequency.
    pub fn stop(&self) -> f64 {
        self.stop
    }

    /// Number of distances at which profiles are held.
    pub(crate) fn nodes(&self) -> usize {
        self.distances.len()
    }

    /// Widest panel on which a polynomial of degree 7 follows a filtered kernel to about 1e-9 of its largest value.
    pub(crate) fn panel(&self) -> f64 {
        0.125 / self.stop
    }

    /// W times a transform at the band's frequencies, times their quadrature weights.
    pub(crate) fn band(&self, transform: impl Fn(f64) -> f64) -> Vec<f64> {
        self.frequencies
            .iter()
            .zip(&self.band_weights)
            .map(|(&w, weight)| weight * transform(w))
            .collect()
    }

    /// Low-passed, not yet windowed kernel at a distance, from its band.
    pub(crate) fn low_passed(&self, band: &[f64], distance: f64) -> f64 {
        self.frequencies
            .iter()
            .zip(band)
            .map(|(&w, value)| value * sinc(2.0 * w * distance))
            .sum()
    }

    /// V(d).
    pub(crate) fn window(&self, distance: f64) -> f64 {
        smooth_step_down(distance, self.window_start, self.reach)
    }

    /// The filtered kernel of a band at the distance nodes, times their quadrature weights: the input of
    /// [`Self::spectrum_of`].
    pub(crate) fn profile(&self, band: &[f64]) -> Vec<f64> {
        self.distances
            .iter()
            .zip(&self.window_weights)
            .map(|(&d, weight)| weight * self.low_passed(band, d))
            .collect()
    }

    /// Transform at frequency w of a profile (or of any linear combination of profiles).
    pub(crate) fn spectrum_of(&self, profile: &[f64], w: f64) -> f64 {
        self.distances
            .iter()
            .zip(profile)
            .map(|(&d, value)| value * sinc(2.0 * w * d))
            .sum()
    }
}

/// C-infinity step from 1 (x <= start) down to 0 (x >= stop); `start` < `stop`.
///
/// f(1 - u) / (f(1 - u) + f(u)) with f(t) = exp(-1 / t) and u the way from start to stop: all derivatives vanish at
/// both ends.
pub fn smooth_step_down(x: f64, start: f64, stop: f64) -> f64 {
    let u = (x - start) / (stop - start);
    if u <= 0.0 {
        1.0
    } else if u >= 1.0 {
        0.0
    } else {
        // f(u) / f(1 - u) = exp(1 / (1 - u) - 1 / u); written with one exponential so that neither underflows first.
        1.0 / (1.0 + (1.0 / (1.0 - u) - 1.0 / u).exp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_from_one_to_zero_and_is_symmetric() {
        assert_eq!(smooth_step_down(0.1, 0.1, 0.3), 1.0);
        assert_eq!(smooth_step_down(0.3, 0.1, 0.3), 0.0);
        assert!((smooth_step_down(0.2, 0.1, 0.3) - 0.5).abs() < 1e-15);
        let mut last = 1.0;
        for i in 0..=100 {
            let x = 0.1 + 0.002 * f64::from(i);
            let value = smooth_step_down(x, 0.1, 0.3);
            assert!(value <= last);
            assert!((value + smooth_step_down(0.4 - x, 0.1, 0.3) - 1.0).abs() < 1e-12);
            last = value;
        }
    }
}
