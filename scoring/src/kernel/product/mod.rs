//! The product kernel: what a rasterised bump function correlates with another one.
//!
//! Grid engines (Kavraki's, Lysenko's, ZDock's way, and B&I's own comparison in their Fig. 8) write every ball as a
//! bump psi_r(x - x_i) onto a grid and correlate the two grids. Two balls at distance d then score their bumps' overlap
//!
//! (psi_a * psi_b)(d) = integral of psi(|x| / a) psi(|x - d| / b) dx, in Å^3, with the transform a^3 b^3 psi^(a w)
//! psi^(b w),
//!
//! and not the lifted cone psi(d / (a + b)): their scores must not be compared. The limit of the product kernel for
//! alpha -> infinity is the volume of two spheres' lens.
//!
//! # The double skin
//!
//! B&I's affinity function (eq. 51) is F_S = i (f_{S+B0} - lambda f_S) on each body, with f_S = sum_i c_i psi_{r_i}(x -
//! x_i) and the grown solid the same with radii r_i + r0. Its product with the other body's, i * i = -1 kept as their
//! text needs it, is for each pair of knots
//!
//! -lambda^2 (psi_r * psi_s) + lambda [(psi_{r+r0} * psi_s) + (psi_r * psi_{s+r0})] - (psi_{r+r0} * psi_{s+r0}).
//!
//! The slices are therefore: 0, both solids as they are; 1, the *mean* of growing either one; 2, both grown. The score
//! is -lambda^2 g_0 + 2 lambda g_1 - g_2, with the weights of the lifted kernel.
//!
//! # Two bands
//!
//! [`Band::Whole`] is the kernel itself, exactly 0 beyond r + s + 2 r0. [`Band::LowPass`] multiplies its transform by
//! the ranking kernel's low-pass W(|w|): it is then exactly band-limited, and rings in space. It has no window, which
//! would be no product of two bodies' transforms, and no trim along the lifted axis.

mod pairs;
pub(crate) mod tail_integral;
#[cfg(test)]
mod tests;

pub use knotdock_structures::ball_union::lens_volume;
pub use pairs::peak_score_and_reach;

use super::options::{KernelError, KernelOptions};
use super::radial_transform::RadialTransform;
use super::smooth_step_down;
use super::table::Table;
use crate::quantity::Quantity;
use knotdock_structures::numeric::Bump;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use tail_integral::TailIntegral;

/// Frequencies of the product kernel that count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Band {
    /// All of them.
    #[default]
    Whole,
    /// Those that the ranking kernel's smooth low-pass leaves: `KernelOptions::pass_length` and
    /// `KernelOptions::resolution`.
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

/// The functions of a body whose grown balls have separate weights.
pub const LAYERS: [Body; 2] = [Body::Solid, Body::Grown];

/// A quantity as a sum of products: receptor's function, ligand's function, factor. Derivatives by the offset have none:
/// they are taken along the lifted axis, which the product kernel lacks.
pub fn factors(fold: Quantity) -> &'static [(Body, Body, f64)] {
    use Body::{DoubleSkin, Grown, Solid};
    match fold {
        Quantity::Score => &[(DoubleSkin, DoubleSkin, -1.0)],
        Quantity::Slice(0) => &[(Solid, Solid, 1.0)],
        Quantity::Slice(1) => &[(Grown, Solid, 0.5), (Solid, Grown, 0.5)],
        Quantity::Slice(_) => &[(Grown, Grown, 1.0)],
        Quantity::ScoreByOffset | Quantity::SliceByOffset(_) => &[],
    }
}

/// Factor of the product of two functions of [`LAYERS`] in a fold of the slices: [`factors`] written out.
pub fn layer_factor(fold: Quantity, (a, b): (Body, Body), lambda: f64) -> f64 {
    let share = |of: Body, layer: Body| match (of, layer) {
        (Body::DoubleSkin, Body::Solid) => -lambda,
        (Body::DoubleSkin, _) => 1.0,
        _ => f64::from(u8::from(of == layer)),
    };
    let products = factors(fold).iter();
    products
        .map(|&(of_a, of_b, factor)| factor * share(of_a, a) * share(of_b, b))
        .sum()
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
    /// Length whose cube volumes are given in.
    unit: f64,
}

impl ProductKernel {
    /// The kernel for balls of radius up to `largest` (Å, not yet grown) and frequencies up to `w_max` (1/Å); beyond it
    /// the transform counts as 0.
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
            unit: 1.0,
        })
    }

    /// The same kernel with volumes in the cube of a length.
    ///
    /// # Errors
    /// [`KernelError`] where that is no length.
    pub fn in_unit(self, unit: f64) -> Result<Self, KernelError> {
        if unit.is_finite() && unit > 0.0 {
            return Ok(Self { unit, ..self });
        }
        let (name, bound) = ("unit of volumes", "above 0");
        let value = unit;
        Err(KernelError::Length { name, value, bound })
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

    /// Transform of a body's function of one ball of radius r at frequency w, in the unit of volumes; the low-pass is not
    /// in it.
    pub fn spectrum(&self, body: Body, radius: f64, w: f64) -> f64 {
        let ball = |radius: f64| {
            let q = radius * w;
            let unit = if self.bump.alpha().is_infinite() {
                self.exact_transform.value(q)
            } else {
                self.transform.value(q)[0]
            };
            (radius / self.unit).powi(3) * unit
        };
        let grown = radius + self.options.offset;
        match body {
            Body::Solid => ball(radius),
            Body::Grown => ball(grown),
            Body::DoubleSkin => ball(grown) - self.options.lambda * ball(radius),
        }
    }

    /// Transform of a fold's pair kernel for radii r and s at frequency w, low-pass included: what couples the two
    /// bodies' modes.
    pub fn coupling(&self, fold: Quantity, r: f64, s: f64, w: f64) -> f64 {
        let products: f64 = factors(fold)
            .iter()
            .map(|&(a, b, factor)| factor * self.spectrum(a, r, w) * self.spectrum(b, s, w))
            .sum();
        products * self.unit.powi(3) * self.low_pass(w)
    }

    /// As [`Self::coupling`], of one function of [`LAYERS`] a body.
    pub fn layer_coupling(
        &self,
        fold: Quantity,
        layers: (Body, Body),
        (r, s): (f64, f64),
        w: f64,
    ) -> f64 {
        let factor = layer_factor(fold, layers, self.options.lambda);
        let (a, b) = layers;
        let product = self.spectrum(a, r, w) * self.spectrum(b, s, w);
        factor * product * self.unit.powi(3) * self.low_pass(w)
    }

    /// (psi_a * psi_b)(d) in Å^3 over all frequencies, by quadrature in space; the lens volume of two spheres at alpha
    /// = infinity.
    ///
    /// In the bipolar coordinates u = |x|, v = |x - d| it is (2 pi / d) times the integral over u of u psi_a(u)
    /// [Psi_b(|d - u|) - Psi_b(d + u)]. Psi is the tail integral of v psi_b(v). The integrand is even about 0 and
    /// vanishes with all derivatives at u = a, so that the trapezoidal rule converges faster than any power.
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

    /// Slices 0, 1, 2 and the score kernel of one pair of radii at one distance, by their definition (slow; tables come
    /// from this).
    pub fn value(&self, distance: f64, r: f64, s: f64) -> [f64; 4] {
        match self.band {
            Band::Whole => {
                let [plain, of_r, of_s, both] = self.layer_overlaps(distance, r, s);
                self.with_score([plain, 0.5 * (of_r + of_s), both])
            }
            Band::LowPass => self.low_passed(&self.bands(r, s), distance),
        }
    }

    /// Overlaps of the balls at a distance: as they are, the first grown, the second grown, both grown; in the unit of
    /// volumes, over all frequencies.
    pub(super) fn layer_overlaps(&self, distance: f64, r: f64, s: f64) -> [f64; 4] {
        let (grown_r, grown_s) = (r + self.options.offset, s + self.options.offset);
        let volume = self.unit.powi(3);
        [(r, s), (grown_r, s), (r, grown_s), (grown_r, grown_s)]
            .map(|(a, b)| self.overlap(distance, a, b) / volume)
    }

    fn with_score(&self, slices: [f64; 3]) -> [f64; 4] {
        let weights = self.options.slice_weights();
        let score = (0..3).map(|i| weights[i] * slices[i]).sum();
        [slices[0], slices[1], slices[2], score]
    }
}
