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
mod nodes;
#[cfg(test)]
mod tests;

pub use basis::RadiusBasis;

use crate::affinity::DoubleSkin;
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

    /// The fewest modes whose series reproduces the kernel at all radius sums in use to `tolerance`, relative to the
    /// largest transform value among them; at most 64, or 128 for a tolerance below 1e-7. Returns them with the error
    /// reached.
    pub fn for_tolerance(kernel: &RankingKernel, tolerance: f64) -> (Self, f64) {
        let most = if tolerance < 1e-7 { 128 } else { 64 };
        let full = Self::new(kernel, most);
        let cone = kernel.cone();
        let checks: Vec<f64> = (0..=12)
            .map(|i| cone.low + (cone.high - cone.low) * f64::from(i) / 12.0)
            .collect();
        let exact: Vec<Vec<f64>> = checks.iter().map(|&sigma| kernel.profile(sigma)).collect();
        let frequencies: Vec<f64> = (0..=16)
            .map(|i| kernel.stop() * f64::from(i) / 16.0)
            .collect();
        let scale = exact
            .iter()
            .map(|profile| kernel.spectrum_of(profile, 0.0).abs())
            .fold(f64::MIN_POSITIVE, f64::max);
        let mut error = f64::INFINITY;
        for modes in 2..=most {
            let axis = Self {
                period: full.period,
                profiles: full.profiles[..=modes].to_vec(),
            };
            error = 0.0;
            for (sigma, exact) in checks.iter().zip(&exact) {
                let mut profile = axis.slice_profile(*sigma);
                for (value, exact) in profile.iter_mut().zip(exact) {
                    *value -= exact;
                }
                for &w in &frequencies {
                    error = f64::max(error, kernel.spectrum_of(&profile, w).abs() / scale);
                }
            }
            if error <= tolerance {
                return (axis, error);
            }
        }
        (full, error)
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
            Quantity::Score => DoubleSkin {
                lambda: kernel.options().lambda,
                offset: kernel.options().offset,
            }
            .multiplier(eta)
            .powi(2),
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

    /// sum_k K_k exp(-2 pi i eta_k sigma) as a profile: the series' stand-in for `RankingKernel::profile`.
    fn slice_profile(&self, sigma: f64) -> Vec<f64> {
        self.profile(|axis, k| {
            let turn = Complex64::cis(-2.0 * PI * axis.eta(k) * sigma);
            if k == 0 { turn } else { 2.0 * turn }
        })
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
