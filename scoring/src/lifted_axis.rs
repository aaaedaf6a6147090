//! The fourth axis: modes eta_k = k / P along the radius, the fold of the three slices, and the basis in which knots meet it.
//!
//! K(w, eta_k) = (1/P) integral of kappa^(|w|; sigma) exp(+2 pi i eta_k sigma) d sigma, so that a slice at offset rho is
//! g^(w; rho) = sum_k K(w, eta_k) exp(-2 pi i eta_k rho) rhoA(w, eta_k) conj(rhoB(w, eta_k)).
//! The slices' weights fold into one factor per mode, C_k = -lambda^2 + 2 lambda exp(-2 pi i eta_k r0) - exp(-4 pi i eta_k r0).

use crate::affinity::DoubleSkin;
use crate::kernel::product::Body;
use crate::kernel::table::Table;
use crate::kernel::{ProductKernel, RankingKernel};
use num_complex::Complex64;
use std::f64::consts::PI;

/// What the engine correlates: one slice, or the score that folds all three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fold {
    /// The weighted sum of the three slices: G.
    Score,
    /// One unweighted slice, 0, 1 or 2 for rho = 0, r0, 2 r0.
    Slice(usize),
    /// dG / d rho, all three offsets moved by the same length: the score's sensitivity to the knots' radii, per Å.
    ScoreByOffset,
    /// dg / d rho of one slice, per Å (= -dg / dr on B&I's r axis, which runs the other way).
    SliceByOffset(usize),
}

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
        let low = cone.low - cone.taper();
        // The integrand is smooth and periodic: the trapezoidal rule needs a few points a mode.
        let samples = (4 * modes).max(32);
        let mut profiles: Vec<(Vec<f64>, Vec<f64>)> = vec![Default::default(); modes + 1];
        for sample in 0..samples {
            let sigma = low + period * sample as f64 / samples as f64;
            let profile = kernel.profile(sigma);
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

    /// The fewest modes whose series reproduces the kernel at all radius sums in use to `tolerance`, relative to the largest
    /// transform value among them; at most 64, or 128 for a tolerance below 1e-7. Returns them with the error reached.
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

    /// C_k: what the fold multiplies mode eta_k by.
    pub fn fold_factor(&self, kernel: &RankingKernel, fold: Fold, k: i64) -> Complex64 {
        let eta = self.eta(k);
        match fold {
            Fold::Score => DoubleSkin {
                lambda: kernel.options().lambda,
                offset: kernel.options().offset,
            }
            .multiplier(eta)
            .powi(2),
            Fold::Slice(index) => {
                let offset = kernel.options().slice_offsets()[index.min(2)];
                Complex64::cis(-2.0 * PI * eta * offset)
            }
            // Modes turn as exp(-2 pi i eta rho): to differentiate is to multiply by -2 pi i eta.
            Fold::ScoreByOffset => {
                self.fold_factor(kernel, Fold::Score, k) * Complex64::new(0.0, -2.0 * PI * eta)
            }
            Fold::SliceByOffset(index) => {
                let slice = self.fold_factor(kernel, Fold::Slice(index), k);
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

/// The functions of a radius in which receptor and ligand meet the lifted axis.
#[derive(Clone, Debug, PartialEq)]
pub enum RadiusBasis {
    /// One indicator for each distinct radius (Å): exact, and the shortest when radii are few.
    Classes {
        /// Distinct radii of the receptor.
        receptor: Vec<f64>,
        /// Distinct radii of the ligand.
        ligand: Vec<f64>,
    },
    /// 1, cos and sin of 2 pi eta_k r for k = 1..=K: the lifted modes themselves, for any number of radii.
    Modes,
    /// Lagrange polynomials on Chebyshev nodes (Å): any number of radii for the product kernel, whose factors are smooth in the radius
    /// and have no lifted modes.
    Nodes {
        /// Nodes over the receptor's radii.
        receptor: Vec<f64>,
        /// Nodes over the ligand's radii.
        ligand: Vec<f64>,
    },
}

/// Most nodes of [`RadiusBasis::Nodes`], and most distinct radii that are carried as they are beside a product kernel.
const MOST_NODES: usize = 32;

impl RadiusBasis {
    /// The shorter of the two for these radii.
    pub fn choose(axis: &LiftedAxis, receptor: Vec<f64>, ligand: Vec<f64>) -> Self {
        if receptor.len().max(ligand.len()) <= 2 * axis.modes() + 1 {
            Self::Classes { receptor, ligand }
        } else {
            Self::Modes
        }
    }

    /// The basis for a product kernel on |w| <= `w_max`, and the largest error of interpolating over radii relative to the largest ball's
    /// transform: 0 for as many radii as are carried as they are, else as near to `tolerance` as `MOST_NODES` nodes bring it.
    pub fn for_product(
        kernel: &ProductKernel,
        receptor: Vec<f64>,
        ligand: Vec<f64>,
        w_max: f64,
        tolerance: f64,
    ) -> (Self, f64) {
        if receptor.len().max(ligand.len()) <= MOST_NODES {
            return (Self::Classes { receptor, ligand }, 0.0);
        }
        let (receptor, a) = nodes_for(kernel, &receptor, w_max, tolerance);
        let (ligand, b) = nodes_for(kernel, &ligand, w_max, tolerance);
        (Self::Nodes { receptor, ligand }, a.max(b))
    }

    /// Number of functions on the receptor's and on the ligand's side.
    pub fn sizes(&self, axis: &LiftedAxis) -> (usize, usize) {
        match self {
            Self::Classes { receptor, ligand } | Self::Nodes { receptor, ligand } => {
                (receptor.len(), ligand.len())
            }
            Self::Modes => (2 * axis.modes() + 1, 2 * axis.modes() + 1),
        }
    }

    /// Value of function `index` at a radius of the receptor.
    pub fn receptor_value(&self, axis: &LiftedAxis, index: usize, radius: f64) -> f64 {
        match self {
            Self::Classes { receptor, .. } => f64::from(u8::from(receptor[index] == radius)),
            Self::Nodes { receptor, .. } => node_value(receptor, index, radius),
            Self::Modes => mode_value(axis, index, radius),
        }
    }

    /// Value of function `index` at a radius of the ligand.
    pub fn ligand_value(&self, axis: &LiftedAxis, index: usize, radius: f64) -> f64 {
        match self {
            Self::Classes { ligand, .. } => f64::from(u8::from(ligand[index] == radius)),
            Self::Nodes { ligand, .. } => node_value(ligand, index, radius),
            Self::Modes => mode_value(axis, index, radius),
        }
    }

    /// Radial spectrum that couples receptor function a with ligand function b in the folded kernel, on 0 <= |w| <= `w_max`;
    /// `None` where it is zero.
    pub fn coupling(
        &self,
        kernel: &RankingKernel,
        axis: &LiftedAxis,
        fold: Fold,
        (a, b): (usize, usize),
        w_max: f64,
    ) -> Option<Table<1>> {
        let profile = match self {
            Self::Classes { receptor, ligand } | Self::Nodes { receptor, ligand } => {
                let sigma = receptor[a] + ligand[b];
                axis.profile(|axis, k| {
                    let turn = Complex64::cis(-2.0 * PI * axis.eta(k) * sigma)
                        * axis.fold_factor(kernel, fold, k);
                    if k == 0 { turn } else { 2.0 * turn }
                })
            }
            Self::Modes => {
                // sum_k Z_k exp(-i theta (r + s)) = Z_0 + 2 sum [Re Z cos theta(r + s) + Im Z sin theta(r + s)].
                let (ka, kb) = (a.div_ceil(2), b.div_ceil(2));
                if ka != kb {
                    return None;
                }
                let mix = match (a % 2 == 1, b % 2 == 1) {
                    _ if a == 0 => Complex64::new(1.0, 0.0),
                    (true, true) => Complex64::new(2.0, 0.0),
                    (false, false) => Complex64::new(-2.0, 0.0),
                    // Im Z = Re(-i Z).
                    _ => Complex64::new(0.0, -2.0),
                };
                axis.profile(|axis, k| {
                    if k == ka as i64 {
                        mix * axis.fold_factor(kernel, fold, k)
                    } else {
                        Complex64::new(0.0, 0.0)
                    }
                })
            }
        };
        let panel = 0.125 / kernel.reach();
        Some(Table::fit(w_max, panel.max(w_max / 2000.0), |w| {
            [kernel.spectrum_of(&profile, w)]
        }))
    }

    /// As [`Self::coupling`] for a product kernel, which needs no lifted modes: each basis function stands for a radius, and the two
    /// bodies' transforms at their radii multiply. `None` for [`Self::Modes`], whose functions stand for no radius.
    pub fn product_coupling(
        &self,
        kernel: &ProductKernel,
        fold: Fold,
        (a, b): (usize, usize),
        w_max: f64,
    ) -> Option<Table<1>> {
        let (Self::Classes { receptor, ligand } | Self::Nodes { receptor, ligand }) = self else {
            return None;
        };
        let (r, s) = (receptor[a], ligand[b]);
        let options = kernel.options();
        let support = r + s + 2.0 * options.offset;
        let fall = 1.0 / options.resolution - 1.0 / options.pass_length;
        let panel = (0.25 / support).min(0.1 * fall);
        Some(Table::fit(w_max, panel.max(w_max / 2000.0), |w| {
            [kernel.coupling(fold, r, s, w)]
        }))
    }
}

/// Value at `radius` of the Lagrange polynomial that is 1 at node `index`.
fn node_value(nodes: &[f64], index: usize, radius: f64) -> f64 {
    let own = nodes[index];
    nodes
        .iter()
        .enumerate()
        .filter(|&(other, _)| other != index)
        .map(|(_, node)| (radius - node) / (own - node))
        .product()
}

/// The fewest Chebyshev nodes over a range of radii that carry both bodies' transforms to `tolerance`, and the error reached.
fn nodes_for(kernel: &ProductKernel, radii: &[f64], w_max: f64, tolerance: f64) -> (Vec<f64>, f64) {
    let (Some(&low), Some(&high)) = (radii.first(), radii.last()) else {
        return (Vec::new(), 0.0);
    };
    if low == high {
        return (vec![low], 0.0);
    }
    let bodies = [Body::Solid, Body::Grown];
    let between = |i: usize, n: usize| low + (high - low) * i as f64 / n as f64;
    let mut reached = (Vec::new(), f64::INFINITY);
    for count in 2..=MOST_NODES {
        let nodes: Vec<f64> = (0..count)
            .map(|i| (PI * (i as f64 + 0.5) / count as f64).cos())
            .map(|x| 0.5 * (low + high) + 0.5 * (high - low) * x)
            .collect();
        let mut error = 0.0f64;
        for i in 0..=48 {
            let radius = between(i, 48);
            let values: Vec<f64> = (0..count).map(|m| node_value(&nodes, m, radius)).collect();
            for j in 0..=16 {
                let w = w_max * f64::from(j) / 16.0;
                for body in bodies {
                    let sum: f64 = nodes
                        .iter()
                        .zip(&values)
                        .map(|(&node, value)| value * kernel.spectrum(body, node, w))
                        .sum();
                    let scale = kernel.spectrum(body, high, 0.0);
                    error = error.max((sum - kernel.spectrum(body, radius, w)).abs() / scale);
                }
            }
        }
        reached = (nodes, error);
        if error <= tolerance {
            break;
        }
    }
    reached
}

fn mode_value(axis: &LiftedAxis, index: usize, radius: f64) -> f64 {
    let angle = 2.0 * PI * axis.eta(index.div_ceil(2) as i64) * radius;
    if index % 2 == 1 || index == 0 {
        angle.cos()
    } else {
        angle.sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{KernelOptions, Trim};

    fn kernel(low: f64, high: f64) -> RankingKernel {
        let options = KernelOptions {
            lambda: 10.0,
            offset: 2.0,
            alpha: 2.0,
            resolution: 4.0,
            pass_length: 8.0,
            trim: Trim::FlatTop,
        };
        RankingKernel::new(options, low, high, 1.0).unwrap()
    }

    #[test]
    fn series_converges_to_the_slices() {
        let kernel = kernel(3.0, 3.8);
        let mut last = usize::MAX;
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-6].into_iter().rev() {
            let (axis, error) = LiftedAxis::for_tolerance(&kernel, tolerance);
            assert!(error <= tolerance);
            assert!(axis.modes() <= last);
            last = axis.modes();
        }
    }

    /// Both bases are the same finite sum over eta_k written two ways: they agree to rounding.
    #[test]
    fn classes_and_modes_are_the_same_sum() {
        let kernel = kernel(3.0, 3.8);
        let axis = LiftedAxis::new(&kernel, 9);
        let (r, s) = (1.61, 1.83);
        let classes = RadiusBasis::Classes {
            receptor: vec![r],
            ligand: vec![s],
        };
        let modes = RadiusBasis::Modes;
        for fold in [Fold::Score, Fold::Slice(0), Fold::Slice(2)] {
            for w in [0.0, 0.05, 0.13, 0.22] {
                let direct = classes
                    .coupling(&kernel, &axis, fold, (0, 0), 0.25)
                    .unwrap()
                    .value(w)[0];
                let (na, nb) = modes.sizes(&axis);
                let mut sum = 0.0;
                for a in 0..na {
                    for b in 0..nb {
                        if let Some(table) = modes.coupling(&kernel, &axis, fold, (a, b), 0.25) {
                            sum += table.value(w)[0]
                                * modes.receptor_value(&axis, a, r)
                                * modes.ligand_value(&axis, b, s);
                        }
                    }
                }
                let mut definition = Complex64::new(0.0, 0.0);
                for k in -9..=9 {
                    definition += axis.coefficient(&kernel, w, k)
                        * axis.fold_factor(&kernel, fold, k)
                        * Complex64::cis(-2.0 * PI * axis.eta(k) * (r + s));
                }
                assert!((direct - sum).abs() < 1e-6 * direct.abs().max(1.0));
                assert!((definition.re - sum).abs() < 1e-6 * direct.abs().max(1.0));
                assert!(definition.im.abs() < 1e-9 * direct.abs().max(1.0));
            }
        }
    }
}
