//! The product kernel: what a rasterised bump function correlates with another one.
//!
//! Grid engines (Kavraki's, Lysenko's, ZDock's way, and B&I's own comparison in their Fig. 8) write every ball as a bump psi_r(x - x_i)
//! onto a grid and correlate the two grids. Two balls a distance d apart then score their bumps' overlap
//!
//! (psi_a * psi_b)(d) = integral of psi(|x| / a) psi(|x - d| / b) dx, in Å^3, with the transform a^3 b^3 psi^(a w) psi^(b w),
//!
//! and not the lifted cone psi(d / (a + b)): two functions of the same two balls, which must not be compared with each other.
//! Only the product kernel has the volume of two spheres' lens as its limit for alpha -> infinity.
//!
//! # The double skin
//!
//! B&I's affinity function (eq. 51) is F_S = i (f_{S+B0} - lambda f_S) on each body, with f_S = sum_i c_i psi_{r_i}(x - x_i) and the grown
//! solid the same with radii r_i + r0. Its product with the other body's, i * i = -1 kept as their text needs it (see
//! [`crate::affinity`]), is for each pair of knots
//!
//! -lambda^2 (psi_r * psi_s) + lambda [(psi_{r+r0} * psi_s) + (psi_r * psi_{s+r0})] - (psi_{r+r0} * psi_{s+r0}).
//!
//! The slices are therefore: 0, both solids as they are; 1, the *mean* of growing either one; 2, both grown. With them the score is
//! -lambda^2 g_0 + 2 lambda g_1 - g_2, the same weights as those of the lifted kernel, for which growing either body is the same.
//!
//! # Two bands
//!
//! [`Band::Whole`] is the kernel as it stands, exactly 0 beyond r + s + 2 r0. [`Band::LowPass`] multiplies its transform by the ranking
//! kernel's low-pass W(|w|); it is then exactly band-limited, and rings in space (nothing is windowed here, since a window over pairs
//! is no product of two bodies' transforms and so not open to a rasteriser). The trim along the lifted axis has no meaning here.

use super::bump::Bump;
use super::low_pass::smooth_step_down;
use super::radial_transform::{RadialTransform, sinc};
use super::ranking::{KernelError, KernelOptions};
use super::table::Table;
use crate::lifted_axis::Fold;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Which frequencies of the product kernel count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Band {
    /// All of them.
    #[default]
    Whole,
    /// Those that the ranking kernel's smooth low-pass leaves: `KernelOptions::pass_length` and `KernelOptions::resolution`.
    LowPass,
}

/// The function of one solid that a factor of the product is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// psi_r.
    Solid,
    /// psi_{r + r0}.
    Grown,
    /// psi_{r + r0} - lambda psi_r: the affinity function without its factor i.
    DoubleSkin,
}

/// What a fold of the slices is as a sum of products: receptor's function, ligand's function, factor. Derivatives by the offset have
/// none: they are taken along the lifted axis, which the product kernel lacks.
pub fn factors(fold: Fold) -> &'static [(Body, Body, f64)] {
    use Body::{DoubleSkin, Grown, Solid};
    match fold {
        Fold::Score => &[(DoubleSkin, DoubleSkin, -1.0)],
        Fold::Slice(0) => &[(Solid, Solid, 1.0)],
        Fold::Slice(1) => &[(Grown, Solid, 0.5), (Solid, Grown, 0.5)],
        Fold::Slice(_) => &[(Grown, Grown, 1.0)],
        Fold::ScoreByOffset | Fold::SliceByOffset(_) => &[],
    }
}

/// The product kernel of all pairs of radii up to a largest one.
#[derive(Clone, Debug)]
pub struct ProductKernel {
    options: KernelOptions,
    band: Band,
    bump: Bump,
    exact_transform: RadialTransform,
    /// psi^(q) of the unit ball, not used where alpha is infinite and the closed form serves.
    transform: Table<1>,
    /// Integral from v to 1 of u psi(u) du.
    tail: Table<1>,
    w_max: f64,
}

/// Widths of the low-pass's ring after which the low-passed kernel counts as 0: about 1e-8 of its rim is left there.
const RINGS: f64 = 24.0;

impl ProductKernel {
    /// The kernel for balls of radius up to `largest` (Å, not yet grown) and frequencies up to `w_max` (1/Å); beyond it the transform
    /// counts as 0.
    ///
    /// # Errors
    /// [`KernelError`] on options that define no kernel.
    pub fn new(
        options: KernelOptions,
        band: Band,
        largest: f64,
        w_max: f64,
    ) -> Result<Self, KernelError> {
        let bump = options.check()?;
        for (name, value) in [("largest radius", largest), ("largest frequency", w_max)] {
            if !(value.is_finite() && value > 0.0) {
                let bound = "above 0";
                return Err(KernelError::Length { name, value, bound });
            }
        }
        let w_max = match band {
            Band::Whole => w_max,
            Band::LowPass => w_max.min(1.0 / options.resolution),
        };
        let alpha = bump.alpha();
        // A bump's transform falls like exp(-sqrt(q)) once q is beyond alpha: nothing is left at the end of this range.
        let q_max = (1.001 * w_max * (largest + options.offset)).min(64.0 + 4.0 * alpha.min(1e3));
        let exact_transform = RadialTransform::new(bump, q_max);
        let (transform, tail) = if alpha.is_infinite() {
            let half = |v: f64| [0.5 * (1.0 - v * v)];
            (Table::fit(1.0, 1.0, |_| [0.0]), Table::fit(1.0, 1.0, half))
        } else {
            let integral = TailIntegral::new(bump);
            let panel = 1.0 / (64.0 + 2.0 * alpha.min(2e3));
            (
                Table::fit(q_max, 0.125, |q| [exact_transform.value(q)]),
                Table::fit(1.0, panel, |v| [integral.value(v)]),
            )
        };
        Ok(Self {
            options,
            band,
            bump,
            exact_transform,
            transform,
            tail,
            w_max,
        })
    }

    /// The options it was built from.
    pub fn options(&self) -> &KernelOptions {
        &self.options
    }

    /// The band in use.
    pub fn band(&self) -> Band {
        self.band
    }

    /// Frequency from which on the kernel counts as 0, in cycles per Å.
    pub fn w_max(&self) -> f64 {
        self.w_max
    }

    /// W(|w|): the band's factor at a frequency.
    pub fn low_pass(&self, w: f64) -> f64 {
        match self.band {
            Band::Whole => 1.0,
            Band::LowPass => smooth_step_down(
                w,
                1.0 / self.options.pass_length,
                1.0 / self.options.resolution,
            ),
        }
    }

    /// A body's function of one ball of radius r at distance d from its centre, as a rasteriser writes it.
    #[inline(always)]
    pub fn density(&self, body: Body, radius: f64, distance: f64) -> f64 {
        let grown = radius + self.options.offset;
        match body {
            Body::Solid => self.bump.value(distance / radius),
            Body::Grown => self.bump.value(distance / grown),
            Body::DoubleSkin => {
                self.bump.value(distance / grown)
                    - self.options.lambda * self.bump.value(distance / radius)
            }
        }
    }

    /// Radius in Å beyond which [`Self::density`] is 0.
    pub fn density_reach(&self, body: Body, radius: f64) -> f64 {
        match body {
            Body::Solid => radius,
            Body::Grown | Body::DoubleSkin => radius + self.options.offset,
        }
    }

    /// Transform of [`Self::density`] at frequency w, in Å^3; the low-pass is not in it.
    pub fn spectrum(&self, body: Body, radius: f64, w: f64) -> f64 {
        let ball = |radius: f64| {
            let q = radius * w;
            let unit = if self.bump.alpha().is_infinite() {
                self.exact_transform.value(q)
            } else {
                self.transform.value(q)[0]
            };
            radius.powi(3) * unit
        };
        let grown = radius + self.options.offset;
        match body {
            Body::Solid => ball(radius),
            Body::Grown => ball(grown),
            Body::DoubleSkin => ball(grown) - self.options.lambda * ball(radius),
        }
    }

    /// Transform of a fold's pair kernel for radii r and s at frequency w, low-pass included: what couples the two bodies' modes.
    pub fn coupling(&self, fold: Fold, r: f64, s: f64, w: f64) -> f64 {
        let products: f64 = factors(fold)
            .iter()
            .map(|&(a, b, factor)| factor * self.spectrum(a, r, w) * self.spectrum(b, s, w))
            .sum();
        products * self.low_pass(w)
    }

    /// (psi_a * psi_b)(d) in Å^3 over all frequencies, by quadrature in space; the lens volume of two spheres at alpha = infinity.
    ///
    /// In the bipolar coordinates u = |x|, v = |x - d| it is (2 pi / d) * integral over u of u psi_a(u) [Psi_b(|d - u|) - Psi_b(d + u)], Psi
    /// the tail integral of v psi_b(v). The integrand is even about 0 and vanishes with all derivatives at u = a, so that the trapezoidal
    /// rule converges faster than any power.
    pub fn overlap(&self, distance: f64, a: f64, b: f64) -> f64 {
        let (a, b) = (a.min(b), a.max(b));
        if distance >= a + b {
            return 0.0;
        }
        let alpha = self.bump.alpha();
        if alpha.is_infinite() {
            return lens_volume(a, b, distance);
        }
        let nodes = (256.0 + 64.0 * alpha.min(1e3)) as usize * if alpha < 2.0 { 4 } else { 1 };
        let step = a / nodes as f64;
        let tail = |v: f64| b * b * self.tail.value(v / b)[0];
        // Closer than this the difference quotient would lose more digits than the limit d = 0 errs by.
        let limit = distance < 1e-5 * a;
        let sum: f64 = (1..nodes)
            .map(|k| {
                let u = step * k as f64;
                let near = u * self.bump.value(u / a);
                near * if limit {
                    2.0 * u * self.bump.value(u / b)
                } else {
                    (tail((distance - u).abs()) - tail(distance + u)) / distance
                }
            })
            .sum();
        2.0 * PI * step * sum
    }

    /// Slices 0, 1, 2 and the score kernel of one pair of radii at one distance, by their definition (slow; tables come from this).
    pub fn value(&self, distance: f64, r: f64, s: f64) -> [f64; 4] {
        match self.band {
            Band::Whole => {
                let (grown_r, grown_s) = (r + self.options.offset, s + self.options.offset);
                self.with_score([
                    self.overlap(distance, r, s),
                    0.5 * (self.overlap(distance, grown_r, s) + self.overlap(distance, r, grown_s)),
                    self.overlap(distance, grown_r, grown_s),
                ])
            }
            Band::LowPass => self.low_passed(&self.bands(r, s), distance),
        }
    }

    fn with_score(&self, slices: [f64; 3]) -> [f64; 4] {
        let weights = self.options.slice_weights();
        let score = (0..3).map(|i| weights[i] * slices[i]).sum();
        [slices[0], slices[1], slices[2], score]
    }

    /// Distance in Å from which a pair's kernel counts as 0: exactly without a low-pass, to 1e-8 of its rim with one.
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
    fn bands(&self, r: f64, s: f64) -> Vec<(f64, [f64; 3])> {
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
                    [0, 1, 2].map(|slice| weight * self.coupling(Fold::Slice(slice), r, s, w)),
                )
            })
            .collect()
    }

    fn low_passed(&self, bands: &[(f64, [f64; 3])], distance: f64) -> [f64; 4] {
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

    /// Integral over |w| > f of 4 pi w^2 |transform of the score kernel| up to [`Self::w_max`]: the most that dropping those modes can
    /// move one pair.
    pub fn leak_beyond(&self, r: f64, s: f64, frequency: f64) -> f64 {
        let step = 0.125 / (r + s + 2.0 * self.options.offset);
        (0..)
            .map(|i| frequency + f64::from(i) * step)
            .take_while(|&w| w < self.w_max)
            .map(|w| 4.0 * PI * w * w * self.coupling(Fold::Score, r, s, w).abs() * step)
            .sum()
    }
}

/// Largest value of the score kernel in a pair's table, and the distance beyond which it stays below `share` of that.
pub fn rim_and_reach(table: &Table<4>, share: f64) -> (f64, f64) {
    let samples = 2000;
    let distance = |i: usize| table.end() * i as f64 / samples as f64;
    let rim = (0..samples)
        .map(|i| table.value(distance(i))[3])
        .fold(f64::MIN_POSITIVE, f64::max);
    let reach = (0..samples)
        .rev()
        .find(|&i| table.value(distance(i))[3].abs() > share * rim)
        .map_or(0.0, |i| distance(i + 1));
    (rim, reach)
}

/// Volume in Å^3 that two balls of radii a and b share at distance d of their centres.
///
/// Inside the other while d <= |a - b|; else the two caps, pi (a + b - d)^2 (d^2 + 2 d (a + b) - 3 (a - b)^2) / (12 d)
/// (Weisstein, "Sphere-Sphere Intersection", MathWorld).
pub fn lens_volume(a: f64, b: f64, distance: f64) -> f64 {
    if distance >= a + b {
        return 0.0;
    }
    if distance <= (a - b).abs() {
        return 4.0 / 3.0 * PI * a.min(b).powi(3);
    }
    let square = distance * distance + 2.0 * distance * (a + b) - 3.0 * (a - b).powi(2);
    PI * (a + b - distance).powi(2) * square / (12.0 * distance)
}

/// Integral from v to 1 of u psi(u) du by double-exponential quadrature, which takes in the bump's end however steep it is.
struct TailIntegral {
    bump: Bump,
    /// Distance from the nearer end of the unit interval (negative: from its start), and weight.
    nodes: Vec<(f64, bool, f64)>,
}

impl TailIntegral {
    fn new(bump: Bump) -> Self {
        let step = 1.0 / 32.0;
        let nodes = (-128..=128)
            .map(|k| {
                let t = f64::from(k) * step;
                let s = 0.5 * PI * t.sinh();
                let end = 1.0 / (1.0 + (2.0 * s.abs()).exp());
                (end, s < 0.0, PI * t.cosh() * end * (1.0 - end) * step)
            })
            .filter(|&(_, _, weight)| weight > 1e-24)
            .collect();
        Self { bump, nodes }
    }

    fn value(&self, v: f64) -> f64 {
        let length = 1.0 - v;
        self.nodes
            .iter()
            .map(|&(end, at_start, weight)| {
                let u = if at_start {
                    v + length * end
                } else {
                    1.0 - length * end
                };
                length * weight * u * self.bump.value(u)
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Trim;

    fn options(alpha: f64) -> KernelOptions {
        KernelOptions {
            lambda: 10.0,
            offset: 2.0,
            alpha,
            resolution: 4.0,
            pass_length: 8.0,
            trim: Trim::FlatTop,
        }
    }

    fn kernel(alpha: f64, band: Band) -> ProductKernel {
        ProductKernel::new(options(alpha), band, 1.9, 3.0).unwrap()
    }

    /// The limit alpha -> infinity is the lens volume, approached like 1 / alpha: the bump's edge is about radius / alpha wide. Distances
    /// cover coincidence, one ball inside the other, crossing, near touch and beyond.
    #[test]
    fn tends_to_the_lens_volume() {
        let (a, b) = (1.5, 1.9);
        let mut last = f64::INFINITY;
        for alpha in [10.0, 30.0, 100.0, 300.0, 1000.0] {
            let kernel = kernel(alpha, Band::Whole);
            let mut worst: f64 = 0.0;
            for d in [0.0, 1e-6, 0.2, 0.4, 1.0, 1.7, 2.5, 3.3, 3.4, 5.0] {
                let error = (kernel.overlap(d, a, b) - lens_volume(a, b, d)).abs();
                worst = worst.max(error / lens_volume(a, b, 0.0));
            }
            println!(
                "alpha {alpha}: {worst:.2e}, times alpha {:.2}",
                worst * alpha
            );
            assert!(worst * alpha < 6.0 && worst < 0.5 * last);
            last = worst;
        }
        let sharp = kernel(f64::INFINITY, Band::Whole);
        assert_eq!(sharp.overlap(0.3, a, b), 4.0 / 3.0 * PI * 1.5f64.powi(3));
        // Two unit balls a radius apart share 5 pi / 12.
        assert!((lens_volume(1.0, 1.0, 1.0) - 5.0 * PI / 12.0).abs() < 1e-15);
    }

    /// Overlap in space and product of transforms are the same function: the quadrature in u against the inverse radial transform.
    #[test]
    fn space_and_frequency_agree() {
        let kernel = ProductKernel::new(options(2.0), Band::Whole, 1.9, 12.0).unwrap();
        let scale = kernel.overlap(0.0, 1.5, 1.9);
        for d in [0.0, 1e-7, 1e-3, 0.4, 1.0, 2.2, 3.3, 4.0] {
            let step = 1.0 / 40.0;
            let inverse: f64 = (0..480)
                .map(|n| f64::from(n) * step)
                .map(|w| {
                    4.0 * PI
                        * w
                        * w
                        * step
                        * sinc(2.0 * w * d)
                        * kernel.coupling(Fold::Slice(0), 1.5, 1.9, w)
                })
                .sum();
            let direct = kernel.overlap(d, 1.5, 1.9);
            assert!(
                (inverse - direct).abs() < 1e-8 * scale,
                "{d}: {inverse} against {direct}"
            );
        }
        // At w = 0 both say the product of the bumps' volumes.
        let volume =
            kernel.spectrum(Body::Solid, 1.5, 0.0) * kernel.spectrum(Body::Solid, 1.9, 0.0);
        let integral: f64 = (0..4000)
            .map(|i| 1e-3 * f64::from(i))
            .map(|d| 4.0 * PI * d * d * kernel.overlap(d, 1.5, 1.9) * 1e-3)
            .sum();
        assert!((integral / volume - 1.0).abs() < 1e-6);
    }

    #[test]
    fn tables_follow_the_definition_and_end_where_they_say() {
        for band in [Band::Whole, Band::LowPass] {
            for alpha in [2.0, 4.0] {
                let kernel = kernel(alpha, band);
                let table = kernel.pair_table(1.5, 1.9);
                let (rim, _) = rim_and_reach(&table, 1e-3);
                let mut worst: f64 = 0.0;
                for i in 0..200 {
                    let d = 0.0137 + 0.05 * f64::from(i);
                    let exact = kernel.value(d, 1.5, 1.9);
                    for (ours, exact) in table.value(d).into_iter().zip(exact) {
                        worst = worst.max((ours - exact).abs());
                    }
                }
                let tail = table.value(0.999 * table.end())[3].abs();
                println!("{band:?} {alpha}: rim {rim:.3}, table {worst:.1e}, tail {tail:.1e}");
                assert!(worst < 1e-6 * rim && tail < 1e-7 * rim);
            }
        }
    }

    /// The four products of the double skin are the three slices with the weights of the score, in either domain.
    #[test]
    fn score_is_the_weighted_slices() {
        let kernel = kernel(2.0, Band::LowPass);
        let weights = kernel.options().slice_weights();
        for w in [0.0, 0.05, 0.12, 0.2, 0.24] {
            let sum: f64 = (0..3)
                .map(|i| weights[i] * kernel.coupling(Fold::Slice(i), 1.5, 1.9, w))
                .sum();
            let score = kernel.coupling(Fold::Score, 1.5, 1.9, w);
            assert!((sum - score).abs() < 1e-12 * score.abs().max(1.0));
        }
        assert_eq!(kernel.low_pass(0.25), 0.0);
    }

    #[test]
    fn refuses_what_defines_no_kernel() {
        assert!(ProductKernel::new(options(0.0), Band::Whole, 1.9, 1.0).is_err());
        assert!(ProductKernel::new(options(2.0), Band::Whole, f64::NAN, 1.0).is_err());
        assert!(ProductKernel::new(options(2.0), Band::Whole, 1.9, 0.0).is_err());
    }
}
