//! One pair of radii of the product kernel: its reach, its table over distance, and its modes beyond a frequency.

use super::LAYERS;
use super::{Band, ProductKernel};
use crate::kernel::radial_transform::sinc;
use crate::kernel::table::{PanelFit, Table};
use crate::quantity::Quantity;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Waves a smallest radius at which a kernel without low-pass ends.
const WAVES: f64 = 4.0;
/// Most pairs of radii whose kernels are quadratures in space; of more they are sums over frequencies.
const MAX_QUADRATURES: usize = 16;
/// Width of a table's panels in waves of the highest frequency: polynomials of degree 7 follow a quarter to 3e-8.
const PANEL_IN_WAVES: f64 = 0.25;

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

    /// The kernel with all its frequencies, for some radii; `None` where it has them already.
    ///
    /// They end at four waves a smallest radius, beyond which a bump of exponent 2 to 8 has less than 1e-3 of itself.
    pub fn without_low_pass(&self, radii: &[&[f64]]) -> Option<Self> {
        if self.band == Band::Whole {
            return None;
        }
        let radii = radii.iter().copied().flatten();
        let (low, high) = radii.fold((f64::INFINITY, 0.0f64), |(low, high), &radius| {
            (low.min(radius), high.max(radius))
        });
        let whole = Self::new(self.options, Band::Whole, high, WAVES / low).ok()?;
        Some(Self {
            unit: self.unit,
            ..whole
        })
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

    /// One ball's bump and its grown bump over distance, each after the square root of the low-pass: the share of either
    /// body in a pair. In the unit of volumes; they count as zero `rings` resolutions beyond the grown ball.
    pub fn half_passed(&self, radius: f64, rings: f64) -> Table<2> {
        let end = radius + self.options.offset + rings * self.options.resolution;
        let step = 1.0 / (4.0 * end);
        let frequencies = (0..).map(|n| f64::from(n) * step);
        let waves: Vec<(f64, [f64; 2])> = frequencies
            .take_while(|&w| w < self.w_max)
            .map(|w| {
                let measure = 4.0 * PI * w * w * step * self.low_pass(w).sqrt();
                let spectrum = |body| measure * self.unit.powi(3) * self.spectrum(body, radius, w);
                (w, LAYERS.map(spectrum))
            })
            .collect();
        Table::fit(end, PANEL_IN_WAVES / self.w_max, |d| {
            let mut sums = [0.0; 2];
            for (w, parts) in &waves {
                let wave = sinc(2.0 * w * d);
                sums[0] += parts[0] * wave;
                sums[1] += parts[1] * wave;
            }
            sums
        })
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

    /// Tables over distance of all pairs of a radius of `receptor` and one of `ligand`: `[receptor][ligand]`.
    ///
    /// Lanes are both balls as they are, the receptor's grown, the ligand's grown, both grown; in the unit of volumes.
    pub fn layer_tables(&self, receptor: &[f64], ligand: &[f64]) -> Vec<Vec<Table<4>>> {
        match self.band {
            // Quadratures are exact and slow.
            Band::Whole if receptor.len() * ligand.len() <= MAX_QUADRATURES => {
                let table = |r: f64, s: f64| {
                    let panel = r.min(s) / (16.0 + self.bump.alpha().min(1e3));
                    Table::fit(self.reach(r, s), panel, |d| self.layer_overlaps(d, r, s))
                };
                let row = |&r: &f64| ligand.iter().map(|&s| table(r, s)).collect();
                receptor.iter().map(row).collect()
            }
            _ => self.layer_waves(receptor, ligand),
        }
    }

    /// [`Self::layer_tables`] by frequencies up to the kernel's end, over the reach of the widest pair.
    fn layer_waves(&self, receptor: &[f64], ligand: &[f64]) -> Vec<Vec<Table<4>>> {
        let widest = |radii: &[f64]| radii.iter().copied().fold(0.0, f64::max);
        let end = self.reach(widest(receptor), widest(ligand));
        let step = 1.0 / (4.0 * end);
        let frequencies: Vec<f64> = (0..)
            .map(|n| f64::from(n) * step)
            .take_while(|&w| w < self.w_max)
            .collect();
        let spectra = |radii: &[f64]| -> Vec<Vec<[f64; 2]>> {
            let of = |&r: &f64| {
                let at = |&w: &f64| LAYERS.map(|layer| self.spectrum(layer, r, w));
                frequencies.iter().map(at).collect()
            };
            radii.iter().map(of).collect()
        };
        let (a, b) = (spectra(receptor), spectra(ligand));
        let measures: Vec<f64> = frequencies
            .iter()
            .map(|&w| 4.0 * PI * w * w * step * self.unit.powi(3) * self.low_pass(w))
            .collect();
        let panels = (end * self.w_max / PANEL_IN_WAVES).ceil().max(1.0) as usize;
        let width = end / panels as f64;
        let fit = PanelFit::new();
        // [panel][pair], then [pair][panel].
        let by_panel: Vec<Vec<_>> = (0..panels)
            .into_par_iter()
            .map(|panel| {
                let middle = width * (panel as f64 + 0.5);
                let waves = fit.at_nodes(middle, 0.5 * width, |d| -> Vec<f64> {
                    let wave = |(&w, measure): (&f64, &f64)| measure * sinc(2.0 * w * d);
                    frequencies.iter().zip(&measures).map(wave).collect()
                });
                let of_pair = |(a, b): (&Vec<[f64; 2]>, &Vec<[f64; 2]>)| {
                    fit.through(&waves.each_ref().map(|waves| layer_sums(waves, a, b)))
                };
                let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
                pairs.map(of_pair).collect()
            })
            .collect();
        (0..receptor.len())
            .map(|i| {
                let pairs = i * ligand.len()..(i + 1) * ligand.len();
                let of_pair = |pair: usize| by_panel.iter().map(|panel| panel[pair]).collect();
                pairs.map(|pair| Table::of(end, of_pair(pair))).collect()
            })
            .collect()
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

/// Sums over frequencies of waves times two bodies' layers.
fn layer_sums(waves: &[f64], a: &[[f64; 2]], b: &[[f64; 2]]) -> [f64; 4] {
    let mut sums = [0.0; 4];
    for ((wave, [solid, grown]), [other, other_grown]) in waves.iter().zip(a).zip(b) {
        let (near, far) = (wave * solid, wave * grown);
        sums[0] += near * other;
        sums[1] += far * other;
        sums[2] += near * other_grown;
        sums[3] += far * other_grown;
    }
    sums
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
