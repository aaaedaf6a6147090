//! One pair of radii of the product kernel: its reach, its table over distance, and what its modes hold beyond a
//! frequency.

use super::{Band, ProductKernel};
use crate::kernel::radial_transform::sinc;
use crate::kernel::table::Table;
use crate::quantity::Quantity;
use std::f64::consts::PI;

/// Widths of the low-pass's ring after which the low-passed kernel counts as 0: about 1e-8 of its peak is left there.
const RINGS: f64 = 24.0;

impl ProductKernel {
    /// Distance in Å from which a pair's kernel counts as 0: exactly without a low-pass, to 1e-8 of its peak with one.
    pub fn reach(&self, r: f64, s: f64) -> f64 {
        let plain = r + s + 2.0 * self.options.offset;
        match self.band {
            Band::Whole => plain,
            Band::LowPass => plain + RINGS * self.ring(),
        }
    }

    /// Length over which the low-pass rings, Å.
    fn ring(&self) -> f64 {
        1.0 / (1.0 / self.options.resolution - 1.0 / self.options.pass_length)
    }

    /// Frequencies w and 4 pi w^2 W(w) dw times the three slices' transforms.
    pub(super) fn bands(&self, r: f64, s: f64) -> Vec<(f64, [f64; 3])> {
        let stop = 1.0 / self.options.resolution;
        // The sum over frequencies repeats in space with period 1 / step; it must not fall on itself.
        let step = 1.0 / (4.0 * self.reach(r, s));
        (0..)
            .map(|n| f64::from(n) * step)
            .take_while(|&w| w < stop)
            .map(|w| {
                let weight = 4.0 * PI * w * w * step;
                (
                    w,
                    [0, 1, 2].map(|slice| weight * self.coupling(Quantity::Slice(slice), r, s, w)),
                )
            })
            .collect()
    }

    pub(super) fn low_passed(&self, bands: &[(f64, [f64; 3])], distance: f64) -> [f64; 4] {
        let mut slices = [0.0; 3];
        for (w, band) in bands {
            let wave = sinc(2.0 * w * distance);
            for (slice, value) in slices.iter_mut().zip(band) {
                *slice += value * wave;
            }
        }
        self.with_score(slices)
    }

    /// Table over distance of one pair of radii: lanes are the slices 0, 1, 2 and the score kernel, in Å^3.
    pub fn pair_table(&self, r: f64, s: f64) -> Table<4> {
        let end = self.reach(r, s);
        match self.band {
            Band::Whole => {
                let panel = r.min(s) / (16.0 + self.bump.alpha().min(1e3));
                Table::fit(end, panel, |d| self.value(d, r, s))
            }
            Band::LowPass => {
                let bands = self.bands(r, s);
                let panel = 0.125 * self.options.resolution;
                Table::fit(end, panel, |d| self.low_passed(&bands, d))
            }
        }
    }

    /// Whether [`Self::pair_table`] follows the kernel: not that of sharp balls, which is cheap as it is.
    pub fn is_smooth(&self) -> bool {
        self.band == Band::LowPass || self.bump.alpha().is_finite()
    }

    /// Integral over |w| > f of 4 pi w^2 |transform of the score kernel| up to [`Self::w_max`]: the most that dropping
    /// those modes can move one pair.
    pub fn leak_beyond(&self, r: f64, s: f64, frequency: f64) -> f64 {
        let step = 0.125 / (r + s + 2.0 * self.options.offset);
        (0..)
            .map(|i| frequency + f64::from(i) * step)
            .take_while(|&w| w < self.w_max)
            .map(|w| 4.0 * PI * w * w * self.coupling(Quantity::Score, r, s, w).abs() * step)
            .sum()
    }
}

/// Largest value of the score kernel in a pair's table, and the distance beyond which it stays below `share` of that.
pub fn peak_score_and_reach(table: &Table<4>, share: f64) -> (f64, f64) {
    let samples = 2000;
    let distance = |i: usize| table.end() * i as f64 / samples as f64;
    let peak_score = (0..samples)
        .map(|i| table.value(distance(i))[3])
        .fold(f64::MIN_POSITIVE, f64::max);
    let reach = (0..samples)
        .rev()
        .find(|&i| table.value(distance(i))[3].abs() > share * peak_score)
        .map_or(0.0, |i| distance(i + 1));
    (peak_score, reach)
}
