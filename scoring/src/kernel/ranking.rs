//! The ranking kernel: B&I's pair kernel, low-passed to a stated resolution and cut at a stated reach, in both domains.
//!
//! With lambda about 10 the pair kernel is stiff, and a grid's cut-off would be a hidden part of the score. Here it is
//! explicit. Each slice kappa(d, sigma) is multiplied in the Fourier domain by W(|w|): 1 up to the pass frequency,
//! C-infinity down to 0 at the stop frequency 1 / resolution. Then, in the real domain, it is multiplied by a window
//! V(d): 1 within the kernel, C-infinity down to 0 at the reach. Both steps are linear in kappa, so they apply to
//! slices and lifted modes alike.
//!
//! Both are the work of [`super::radial_filter`].

use super::cone::{Cone, Trim};
use super::options::{
    KernelError, KernelOptions, MAX_REACH, MAX_RING_LENGTH, MIN_RADII, TRIM_LENGTH,
};
use super::radial_filter::RadialFilter;
use super::radial_transform::RadialTransform;
use super::table::Table;
use std::f64::consts::PI;

/// The ranking kernel for all radius sums in [low, high - 2 r0] and its three slices.
#[derive(Clone, Debug)]
pub struct RankingKernel {
    options: KernelOptions,
    cone: Cone,
    transform: Table<1>,
    filter: RadialFilter,
}

impl RankingKernel {
    /// The kernel for pairs with radius sums r + s in [`sum_low`, `sum_high`], Å. `reach_factor` (1 or more)
    /// lengthens the window's fall, which sharpens the kernel's own cut in frequency: 1 serves a tolerance of 1e-2, 4
    /// one of 1e-6.
    ///
    /// # Errors
    /// [`KernelError`] on options that define no kernel.
    pub fn new(
        options: KernelOptions,
        sum_low: f64,
        sum_high: f64,
        reach_factor: f64,
    ) -> Result<Self, KernelError> {
        let bump = options.check()?;
        let cone = Cone {
            bump,
            trim: options.trim,
            low: sum_low,
            high: sum_high + 2.0 * options.offset,
        };
        // Written so that NaN is refused with the rest.
        if !(MIN_RADII * options.resolution..).contains(&cone.high) {
            return Err(KernelError::Length {
                name: "largest sum of radii and skins",
                value: cone.high,
                bound: "at least 1e-6 of the resolution, which leaves nothing of smaller balls",
            });
        }
        if let Trim::BehandishIlies { length } = options.trim
            && 2.0 * length <= cone.high
        {
            return Err(KernelError::Length {
                name: TRIM_LENGTH,
                value: length,
                bound: "above half of the largest sum of radii and skins, for it ends at twice its length",
            });
        }
        let stop = 1.0 / options.resolution;
        let pass = 1.0 / options.pass_length;
        let [_, reach] = RadialFilter::window_ends(pass, stop, cone.high, reach_factor);
        let ring = 1.0 / (1.0 - options.resolution / options.pass_length);
        // The flat top ends near the reach, while B&I's trim may end anywhere.
        let longest = match options.trim {
            Trim::FlatTop => reach,
            Trim::BehandishIlies { length } => reach.max(2.0 * length),
        };
        if !(0.0..=MAX_REACH).contains(&(longest / options.resolution))
            || !(0.0..=MAX_RING_LENGTH).contains(&ring)
        {
            return Err(KernelError::TooLong {
                reach: longest,
                resolution: options.resolution,
            });
        }
        let filter = RadialFilter::new(pass, stop, cone.high, reach_factor);
        let [_, last] = cone.ends();
        let q_max = stop * last;
        let quadrature = RadialTransform::new(bump, q_max);
        // Good to 1e-13, for the slices of a score may cancel.
        let transform = Table::fit(q_max * 1.001, 0.0625, |q| [quadrature.value(q)]);
        Ok(Self {
            options,
            cone,
            transform,
            filter,
        })
    }

    /// The options it was built from.
    pub fn options(&self) -> &KernelOptions {
        &self.options
    }

    /// The unfiltered lifted cone.
    pub fn cone(&self) -> &Cone {
        &self.cone
    }

    /// The low-pass and window, which the kernels of further effects share.
    pub fn filter(&self) -> &RadialFilter {
        &self.filter
    }

    /// Distance in Å from which the kernel is exactly 0.
    pub fn reach(&self) -> f64 {
        self.filter.reach()
    }

    /// Stop frequency 1 / resolution of the low-pass, in cycles per Å.
    pub fn stop(&self) -> f64 {
        self.filter.stop()
    }

    /// W kappa^ at the band's frequencies, times their quadrature weights, for one radius sum (trim included).
    fn band(&self, sigma: f64) -> Vec<f64> {
        let trim = self.cone.trim_value(sigma) * sigma.powi(3);
        self.filter
            .band(|w| trim * self.transform.value((w * sigma).abs())[0])
    }

    /// The kernel of one slice at distance d, sigma = r + s + rho, by its definition (slow; tables come from this).
    pub fn value(&self, distance: f64, sigma: f64) -> f64 {
        self.filter.low_passed(&self.band(sigma), distance) * self.filter.window(distance)
    }

    /// Overlap of two coincident balls of radius sum sigma (Å) after the low-pass; without it, 1.
    ///
    /// Near or above 1 for balls that the resolution shows, falling like sigma^3 for smaller ones. Trim and window are
    /// not in it.
    pub fn overlap_left(&self, sigma: f64) -> f64 {
        // Beyond this the transform is not tabulated, and the resolution shows all there is.
        if sigma > self.cone.high {
            return 1.0;
        }
        let untrimmed = |w: f64| sigma.powi(3) * self.transform.value(w * sigma)[0];
        self.filter.low_passed(&self.filter.band(untrimmed), 0.0)
    }

    /// The windowed kernel at the distance nodes, times their quadrature weights: the input of [`Self::spectrum_of`].
    pub fn profile(&self, sigma: f64) -> Vec<f64> {
        self.filter.profile(&self.band(sigma))
    }

    /// Transform at frequency w of a profile (or of any linear combination of profiles).
    pub fn spectrum_of(&self, profile: &[f64], w: f64) -> f64 {
        self.filter.spectrum_of(profile, w)
    }

    /// The slices at rho = 0, r0, 2 r0 of one pair of radii as functions of distance, by their definition; 0 from the
    /// reach on.
    pub(crate) fn slices_of(&self, radius_sum: f64) -> impl Fn(f64) -> [f64; 3] + '_ {
        let bands = self
            .options
            .slice_offsets()
            .map(|offset| self.band(radius_sum + offset));
        move |distance| {
            let window = self.filter.window(distance);
            bands
                .each_ref()
                .map(|band| self.filter.low_passed(band, distance) * window)
        }
    }

    /// Widest panel in Å on which a polynomial of degree 7 follows the kernel to about 1e-9 of its largest value.
    pub(crate) fn panel(&self) -> f64 {
        self.filter.panel()
    }

    /// Table over distance of one pair of radii: lanes are the slices at rho = 0, r0, 2 r0 and the score kernel itself.
    pub fn distance_table(&self, radius_sum: f64) -> Table<4> {
        let slices_at = self.slices_of(radius_sum);
        let weights = self.options.slice_weights();
        Table::fit(self.reach(), self.panel(), |d| {
            let slices = slices_at(d);
            let score = (0..3).map(|i| weights[i] * slices[i]).sum();
            [slices[0], slices[1], slices[2], score]
        })
    }

    /// Largest value of the score kernel over d, of a radius sum's [`Self::distance_table`]: what one touching pair can
    /// earn.
    pub fn peak_score(&self, table: &Table<4>) -> f64 {
        (0..1000)
            .map(|i| table.value(self.reach() * f64::from(i) / 1000.0)[3])
            .fold(0.0, f64::max)
    }

    /// Whether B&I's own kernel rewards a pair of balls at some distance. Without a reward (lambda = 0, no skin) the best
    /// score is ringing of the low-pass.
    pub(crate) fn rewards(&self) -> bool {
        let high = self.cone.high - 2.0 * self.options.offset;
        [self.cone.low, high].into_iter().any(|sum| {
            let extremes = self.options.extremes(sum);
            extremes.is_ok_and(|(reward, _)| reward > 0.0)
        })
    }

    /// Distance in Å beyond which the score kernel of such a table stays below `threshold` in magnitude.
    pub fn effective_reach(&self, table: &Table<4>, threshold: f64) -> f64 {
        (0..1000)
            .rev()
            .map(|i| self.reach() * f64::from(i) / 1000.0)
            .find(|&d| table.value(d)[3].abs() > threshold)
            .unwrap_or(0.0)
    }

    /// Least frequency, from the stop frequency on, beyond which the integral of 4 pi w^2 |transform of the score
    /// kernel| is at most `allowed`. No pair moves by more when all modes beyond it are dropped.
    pub fn band_end(&self, radius_sum: f64, allowed: f64) -> f64 {
        let weights = self.options.slice_weights();
        let mut profile = vec![0.0; self.filter.nodes()];
        for (offset, weight) in self.options.slice_offsets().into_iter().zip(weights) {
            for (sum, value) in profile.iter_mut().zip(self.profile(radius_sum + offset)) {
                *sum += weight * value;
            }
        }
        // The sum over distances repeats in w with a period of 8 stops and is even, so up to 4 it says all there is.
        let stop = self.stop();
        let step = 0.25 / self.reach();
        let count = (3.0 * stop / step).ceil() as usize;
        let mut beyond = 0.0;
        (0..count)
            .map(|i| stop + i as f64 * step)
            .rev()
            .find(|&w| {
                beyond += 4.0 * PI * w * w * self.spectrum_of(&profile, w).abs() * step;
                beyond > allowed
            })
            .map_or(stop, |w| w + step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::radial_transform::sinc;

    #[test]
    fn tables_and_definition_agree_in_both_domains() {
        let kernel = RankingKernel::new(KernelOptions::TEST, 3.0, 3.8, 2.0).unwrap();
        let table = kernel.distance_table(3.4);
        let mut worst: f64 = 0.0;
        for i in 0..300 {
            let d = f64::from(i) * 0.11;
            let exact = if d < kernel.reach() {
                kernel.value(d, 5.4)
            } else {
                0.0
            };
            worst = worst.max((table.value(d)[1] - exact).abs());
        }
        assert!(worst < 1e-8, "table error {worst}");
        // The transform of the windowed kernel, by brute force over a far finer grid, is the trapezoid's.
        let profile = kernel.profile(5.4);
        for w in [0.0, 0.03, 0.11, 0.2, 0.26] {
            let step = 0.01;
            let brute: f64 = (1..)
                .map(|i| f64::from(i) * step)
                .take_while(|&d| d < kernel.reach())
                .map(|d| 4.0 * PI * d * d * kernel.value(d, 5.4) * sinc(2.0 * w * d) * step)
                .sum();
            assert!((brute - kernel.spectrum_of(&profile, w)).abs() < 1e-5 * profile.len() as f64);
        }
    }

    /// With the pass frequency far beyond the kernel's own band nothing is removed: B&I's kernel comes back.
    #[test]
    fn a_wide_band_gives_back_the_unfiltered_kernel() {
        let wide = KernelOptions {
            resolution: 0.2,
            pass_length: 0.3,
            ..KernelOptions::TEST
        };
        let kernel = RankingKernel::new(wide, 3.0, 3.8, 2.0).unwrap();
        for d in [0.0, 1.0, 2.7, 4.0, 5.3, 6.5] {
            let plain = kernel.cone().value(d, 5.4);
            assert!((kernel.value(d, 5.4) - plain).abs() < 1e-6);
        }
    }

    /// A longer window leaks less past the stop frequency, and less is beyond a frequency the less is allowed there.
    #[test]
    fn the_band_ends_sooner_with_reach() {
        let short = RankingKernel::new(KernelOptions::TEST, 3.0, 3.8, 1.0).unwrap();
        let long = RankingKernel::new(KernelOptions::TEST, 3.0, 3.8, 4.0).unwrap();
        let stop = short.stop();
        assert_eq!(short.band_end(3.4, 1e9), stop);
        let ends = [1e-1, 1e-2, 1e-3].map(|allowed| {
            let [a, b] = [&short, &long].map(|kernel| kernel.band_end(3.4, allowed));
            assert!(b < a, "{allowed}: {b} and {a}");
            a
        });
        assert!(stop < ends[0] && ends.is_sorted() && ends[0] < ends[2] && ends[2] <= 4.0 * stop);
        // What lies beyond, summed far finer from the kernel's definition alone, is what was allowed but for what one
        // step holds.
        let offsets = short.options.slice_offsets().into_iter();
        let slices = offsets.zip(short.options.slice_weights());
        let profiles: Vec<(Vec<f64>, f64)> = slices
            .map(|(offset, weight)| (short.profile(3.4 + offset), weight))
            .collect();
        let beyond = |end: f64| {
            let step = 0.02 / short.reach();
            (0..)
                .map(|i| end + step * f64::from(i))
                .take_while(|&w| w < 4.0 * stop)
                .map(|w| {
                    let of = |(profile, weight): &(Vec<f64>, f64)| {
                        weight * short.spectrum_of(profile, w)
                    };
                    4.0 * PI * w * w * step * profiles.iter().map(of).sum::<f64>().abs()
                })
                .sum::<f64>()
        };
        for (end, allowed) in ends.into_iter().zip([1e-1, 1e-2, 1e-3]) {
            let left = beyond(end);
            println!("{allowed}: {left} beyond {end}");
            assert!(
                left < 1.1 * allowed && left > 0.5 * allowed,
                "{allowed}: {left}"
            );
        }
    }

    #[test]
    fn refuses_options_that_define_no_kernel() {
        for bad in [
            KernelOptions {
                alpha: 0.0,
                ..KernelOptions::TEST
            },
            KernelOptions {
                offset: -1.0,
                ..KernelOptions::TEST
            },
            KernelOptions {
                lambda: f64::NAN,
                ..KernelOptions::TEST
            },
            KernelOptions {
                resolution: 0.0,
                ..KernelOptions::TEST
            },
            KernelOptions {
                pass_length: 3.0,
                ..KernelOptions::TEST
            },
        ] {
            assert!(RankingKernel::new(bad, 3.0, 3.8, 1.0).is_err());
        }
    }
}
