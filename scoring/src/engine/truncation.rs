//! Truncation of a whole correlation to its m' dominant modes, with a bound and an estimate of what that costs (B&I sections 2.5 and 4.1).
//!
//! G at a rotation is sum_w m(w) Re[H(w) conj(B(w)) exp(2 pi i w.t)] / V over half the modes, m their multiplicity, H the receptor's
//! folded spectra and B the turned ligand's. Without the modes D that are dropped it is off, at any rotation and translation, by at most
//!
//! bound = sum over D of m / V sum_b |H_b| sum_j |d_j v_b(s_j)|,
//!
//! which holds since no |exp| exceeds 1, and in the root mean square over translations by about
//!
//! estimate = sqrt(sum over D of m / V^2 sum_j |sum_b H_b d_j v_b(s_j)|^2),
//!
//! its mean over ligand knots placed at random (Parseval). The bound has all knots in phase, and lies far above the estimate; the estimate
//! is what a budget of modes is chosen by. Both cost one pass over H, once a run, whatever the number of rotations.
//!
//! [`Dominance::LowFrequency`] keeps whole shells of |w| and hands back a plan with fewer modes, so that each rotation is faster;
//! [`Dominance::Magnitude`] keeps the modes that the bound says matter most, wherever they lie, in a plan of the old size.

use super::cpu::Folded;
use super::plan::Plan;
use crate::transform::Real;
use crate::transform::modes::ModeSet;
use num_complex::Complex;
use std::sync::Arc;

/// Which modes dominate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dominance {
    /// Low |w| first, outward.
    LowFrequency,
    /// Largest share in the bound first.
    Magnitude,
}

/// A truncated correlation: a plan and spectra for [`super::CpuEngine::new`] in place of the whole ones, and the error of doing so.
pub struct Truncation<T: Real> {
    /// The plan with the modes kept.
    pub plan: Arc<Plan>,
    /// The receptor's side with the modes kept.
    pub folded: Folded<T>,
    /// Three-dimensional modes kept, conjugates counted: at most as many as asked.
    pub modes: usize,
    /// Most that any score is off by.
    pub bound: f64,
    /// Expected root mean square over translations of what scores are off by.
    pub estimate: f64,
}

/// What a mode has to do with the order and the error.
struct Share {
    mode: usize,
    frequency: f64,
    multiplicity: f64,
    /// Share in the bound.
    most: f64,
    /// Share in the estimate's square.
    square: f64,
}

impl<T: Real> Truncation<T> {
    /// Keeps at most `modes` modes (conjugates counted) of a prepared correlation.
    pub fn new(plan: &Plan, folded: &Folded<T>, dominance: Dominance, modes: usize) -> Self {
        let mut shares = shares(plan, folded);
        shares.sort_by(|a, b| match dominance {
            Dominance::LowFrequency => a.frequency.total_cmp(&b.frequency),
            // Ties by index: the same modes for the same input.
            Dominance::Magnitude => (b.most / b.multiplicity)
                .total_cmp(&(a.most / a.multiplicity))
                .then(a.mode.cmp(&b.mode)),
        });
        let mut kept = 0;
        let mut total = 0.0;
        for share in &shares {
            if total + share.multiplicity > modes as f64 {
                break;
            }
            total += share.multiplicity;
            kept += 1;
        }
        let mut own = plan.clone();
        let mut spectra = folded.clone();
        let zero = Complex::new(T::zero(), T::zero());
        match dominance {
            Dominance::LowFrequency => {
                // Whole shells only: a shell cut through would favour a direction.
                while kept > 0 && kept < shares.len() && same_shell(&shares[kept - 1..=kept]) {
                    kept -= 1;
                }
                if kept < shares.len() {
                    let below = kept.checked_sub(1).map_or(0.0, |i| shares[i].frequency);
                    let cut = 0.5 * (below + shares[kept].frequency);
                    let set = ModeSet::new(plan.modes.size, plan.modes.lengths, cut);
                    let places = places(&plan.modes, &set);
                    for spectrum in &mut spectra.spectra {
                        *spectrum = places.iter().map(|&place| spectrum[place]).collect();
                    }
                    own.modes = Arc::new(set);
                }
            }
            Dominance::Magnitude => {
                for share in &shares[kept..] {
                    for spectrum in &mut spectra.spectra {
                        spectrum[share.mode] = zero;
                    }
                }
            }
        }
        let dropped = &shares[kept..];
        Self {
            plan: Arc::new(own),
            folded: spectra,
            modes: shares[..kept].iter().map(|s| s.multiplicity).sum::<f64>() as usize,
            // An empty sum of floats is -0.
            bound: dropped.iter().map(|share| share.most).sum::<f64>() + 0.0,
            estimate: (dropped.iter().map(|share| share.square).sum::<f64>() + 0.0).sqrt(),
        }
    }
}

/// Whether two neighbours by frequency have the same, up to rounding.
fn same_shell(pair: &[Share]) -> bool {
    matches!(pair, [a, b] if b.frequency - a.frequency <= 1e-9 * b.frequency)
}

fn shares<T: Real>(plan: &Plan, folded: &Folded<T>) -> Vec<Share> {
    let functions = folded.full_rank();
    let ligand = &folded.ligand;
    let sizes: Vec<f64> = (0..functions)
        .map(|b| ligand.column(b).iter().map(|weight| weight.abs()).sum())
        .collect();
    let gram = ligand.transpose() * ligand;
    let volume = plan.modes.volume();
    let mut shares = Vec::with_capacity(plan.modes.count);
    plan.modes.for_each(|mode, w, multiplicity| {
        let values: Vec<Complex<f64>> = folded
            .spectra
            .iter()
            .map(|spectrum| Complex::new(spectrum[mode].re.wide(), spectrum[mode].im.wide()))
            .collect();
        let most: f64 = values.iter().zip(&sizes).map(|(h, d)| h.norm() * d).sum();
        let mut square = 0.0;
        for a in 0..functions {
            for b in 0..functions {
                square += gram[(a, b)] * (values[a] * values[b].conj()).re;
            }
        }
        shares.push(Share {
            mode,
            frequency: (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt(),
            multiplicity,
            most: multiplicity * most / volume,
            square: multiplicity * square.max(0.0) / (volume * volume),
        });
    });
    shares
}

/// For each mode of a smaller set of the same box its place in the larger.
fn places(large: &ModeSet, small: &ModeSet) -> Vec<usize> {
    let mut places = Vec::with_capacity(small.count);
    let mut columns = large.columns.iter();
    for column in &small.columns {
        // Both sets list columns in the same order, and the larger holds all of the smaller's.
        let Some(own) = columns.find(|own| (own.ky, own.kz) == (column.ky, column.kz)) else {
            break;
        };
        let first = own.start + (own.kx_max - column.kx_max) as usize;
        places.extend(first..first + column.len());
    }
    places
}
