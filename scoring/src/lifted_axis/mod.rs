//! The fourth axis: modes eta_k = k / P along the radius, the weights of the three slices, and the basis of the radii.
//!
//! # Conventions
//!
//! Of a receptor with knots (x_i, r_i), weights c_i, and a ligand with knots (y_j, s_j), weights d_j, at rotation R:
//!
//! - rhoA(w, eta) = sum_i c_i exp(-2 pi i (w.x_i + eta r_i));
//! - rhoB(w, eta) = sum_j d_j exp(-2 pi i (w.R y_j - eta s_j)), the ligand's r-mirror (B&I eq. 38, 49): s_j enters with
//!   the other sign. Its conjugate is then sum_j d_j exp(+2 pi i (w.R y_j - eta s_j)), so that the product depends on r
//!   + s. Without the mirror it would depend on r - s;
//! - K(w, eta_k) = (1 / P) integral of kappa^(|w|; sigma) exp(+2 pi i eta_k sigma) d sigma.
//!
//! The slice at offset rho is g^(w; rho) = sum_k K(w, eta_k) exp(-2 pi i eta_k rho) rhoA(w, eta_k) conj(rhoB(w,
//! eta_k)). The score's slices add up to one factor a mode, C_k = -lambda^2 + 2 lambda exp(-2 pi i eta_k r0) - exp(-4
//! pi i eta_k r0).

mod basis;
#[cfg(test)]
mod tests;

pub use basis::RadiusBasis;

use crate::kernel::RankingKernel;
use crate::quantity::Quantity;
use num_complex::Complex64;
use rayon::prelude::*;
use std::f64::consts::PI;

/// The lifted kernel's modes: for each k = 0..=K a complex radial profile (negative k are the conjugates).
#[derive(Clone, Debug)]
pub struct LiftedAxis {
    period: f64,
    /// [k][distance node], the input of `RankingKernel::spectrum_of`, real and imaginary parts.
    profiles: Vec<(Vec<f64>, Vec<f64>)>,
}

impl LiftedAxis {
    /// The modes of `kernel` with |k| <= `modes`.
    pub fn new(kernel: &RankingKernel, modes: usize) -> Self {
        let cone = kernel.cone();
        let period = cone.period();
        let [low, _] = cone.ends();
        // The integrand is smooth and periodic: the trapezoidal rule needs a few points a mode.
        let samples = (4 * modes).max(32);
        let sigmas: Vec<f64> = (0..samples)
            .map(|sample| low + period * sample as f64 / samples as f64)
            .collect();
        // All the time goes here, with the square of the kernel's length in resolutions.
        let sampled: Vec<Vec<f64>> = sigmas
            .par_iter()
            .map(|&sigma| kernel.profile(sigma))
            .collect();
        let mut profiles: Vec<(Vec<f64>, Vec<f64>)> = vec![Default::default(); modes + 1];
        for (sigma, profile) in sigmas.iter().zip(&sampled) {
            for (k, (re, im)) in profiles.iter_mut().enumerate() {
                re.resize(profile.len(), 0.0);
                im.resize(profile.len(), 0.0);
                let turn = Complex64::cis(2.0 * PI * k as f64 * sigma / period) / samples as f64;
                for (index, value) in profile.iter().enumerate() {
                    re[index] += turn.re * value;
                    im[index] += turn.im * value;
                }
            }
        }
        Self { period, profiles }
    }

    /// The fewest modes whose series reproduces the kernel to `tolerance` and the score to ten times that, relative to the
    /// largest transform values at all radius sums in use. It comes with the error reached, which is above the tolerance
    /// if too many modes would be needed.
    ///
    /// The score is checked by itself because its slices may cancel. For lambda = 1 and small r0 it is a second difference
    /// along the axis, r0^2 of the kernel, to which high modes add more.
    pub fn for_tolerance(kernel: &RankingKernel, tolerance: f64) -> (Self, f64) {
        let mut most = if tolerance < 1e-7 { 128 } else { 64 };
        loop {
            let full = Self::new(kernel, most);
            let errors = full.errors(kernel);
            // Of the score the whole series is the reference, so the last modes show nothing.
            let found = (2..=most - most / 4).find(|&modes| errors[modes] <= tolerance);
            let modes = match found {
                Some(modes) => modes,
                None if 2 * most > most_modes(kernel) => most - most / 4,
                None => {
                    most *= 2;
                    continue;
                }
            };
            let axis = Self {
                period: full.period,
                profiles: full.profiles[..=modes].to_vec(),
            };
            return (axis, errors[modes]);
        }
    }

    /// Largest error of the series when cut after each mode, over radius sums and frequencies, relative to the largest
    /// transform value. It is the error of the kernel against its definition, or a tenth of the score's against the
    /// whole series.
    fn errors(&self, kernel: &RankingKernel) -> Vec<f64> {
        let cone = kernel.cone();
        let frequencies: Vec<f64> = (0..=16)
            .map(|i| kernel.stop() * f64::from(i) / 16.0)
            .collect();
        let modes: Vec<i64> = (0..self.profiles.len() as i64).collect();
        // [frequency][mode]: K_k, twice that of k > 0, whose conjugates add the same.
        let coefficients: Vec<Vec<Complex64>> = frequencies
            .par_iter()
            .map(|&w| {
                let twice = |k: i64| if k == 0 { 1.0 } else { 2.0 };
                let coefficient = |&k: &i64| twice(k) * self.coefficient(kernel, w, k);
                modes.iter().map(coefficient).collect()
            })
            .collect();
        let mut largest = vec![0.0f64; modes.len()];
        for fold in [Quantity::Slice(0), Quantity::Score] {
            let is_score = fold == Quantity::Score;
            let skins = if is_score {
                2.0 * kernel.options().offset
            } else {
                0.0
            };
            let mut errors = vec![0.0f64; modes.len()];
            let mut scale = f64::MIN_POSITIVE;
            for i in 0..=12 {
                let sigma = cone.low + (cone.high - skins - cone.low) * f64::from(i) / 12.0;
                let exact = (!is_score).then(|| kernel.profile(sigma));
                let factors: Vec<Complex64> = modes
                    .iter()
                    .map(|&k| {
                        let turn = Complex64::cis(-2.0 * PI * self.eta(k) * sigma);
                        turn * self.fold_factor(kernel, fold, k)
                    })
                    .collect();
                for (&w, coefficients) in frequencies.iter().zip(&coefficients) {
                    let mut sum = 0.0;
                    let terms = coefficients.iter().zip(&factors);
                    let sums: Vec<f64> = terms
                        .map(|(coefficient, factor)| {
                            sum += (coefficient * factor).re;
                            sum
                        })
                        .collect();
                    let target = exact
                        .as_ref()
                        .map_or(sum, |profile| kernel.spectrum_of(profile, w));
                    scale = scale.max(target.abs());
                    for (error, sum) in errors.iter_mut().zip(sums) {
                        *error = error.max((sum - target).abs());
                    }
                }
            }
            // The bound of the kernel leaves room for the weights of the slices, which the score contains.
            let share = if is_score { 0.1 } else { 1.0 };
            for (largest, error) in largest.iter_mut().zip(errors) {
                *largest = largest.max(share * error / scale);
            }
        }
        largest
    }

    /// Period P in Å.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Largest k.
    pub fn modes(&self) -> usize {
        self.profiles.len() - 1
    }

    /// eta_k = k / P, cycles per Å.
    pub fn eta(&self, k: i64) -> f64 {
        k as f64 / self.period
    }

    /// K(w, eta_k) by its definition.
    pub fn coefficient(&self, kernel: &RankingKernel, w: f64, k: i64) -> Complex64 {
        let (re, im) = &self.profiles[k.unsigned_abs() as usize];
        let value = Complex64::new(kernel.spectrum_of(re, w), kernel.spectrum_of(im, w));
        if k < 0 { value.conj() } else { value }
    }

    /// C_k: the factor of mode eta_k in a quantity.
    pub fn fold_factor(&self, kernel: &RankingKernel, fold: Quantity, k: i64) -> Complex64 {
        let eta = self.eta(k);
        match fold {
            // The square of an affinity function's factor (B&I eq. 51): i (exp(-2 pi i eta r0) - lambda).
            Quantity::Score => {
                let shift = Complex64::cis(-2.0 * PI * eta * kernel.options().offset);
                (Complex64::i() * (shift - kernel.options().lambda)).powi(2)
            }
            Quantity::Slice(index) => {
                let offset = kernel.options().slice_offsets()[index];
                Complex64::cis(-2.0 * PI * eta * offset)
            }
            // Modes turn as exp(-2 pi i eta rho): to differentiate is to multiply by -2 pi i eta.
            Quantity::ScoreByOffset => {
                self.fold_factor(kernel, Quantity::Score, k) * Complex64::new(0.0, -2.0 * PI * eta)
            }
            Quantity::SliceByOffset(index) => {
                let slice = self.fold_factor(kernel, Quantity::Slice(index), k);
                slice * Complex64::new(0.0, -2.0 * PI * eta)
            }
        }
    }

    /// Re sum_{k >= 0} f_k K_k as a profile.
    fn profile(&self, factor: impl Fn(&Self, i64) -> Complex64) -> Vec<f64> {
        let mut sum = vec![0.0; self.profiles[0].0.len()];
        for (k, (re, im)) in self.profiles.iter().enumerate() {
            let factor = factor(self, k as i64);
            for ((sum, re), im) in sum.iter_mut().zip(re).zip(im) {
                *sum += factor.re * re - factor.im * im;
            }
        }
        sum
    }
}

/// Most modes of a kernel's series that take seconds: profiles cost the square of its length in resolutions.
fn most_modes(kernel: &RankingKernel) -> usize {
    let length = kernel.reach() * kernel.stop();
    (2e6 / (length * length)).clamp(128.0, 512.0) as usize
}
