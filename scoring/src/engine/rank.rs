//! The choice of the rank: how many components of the lifted axis and the effects a tolerance needs.

use super::cpu::CpuEngine;
use super::plan::Plan;
use super::probes::Probes;
use super::receptor_spectra::ReceptorSpectra;
use crate::transform::Real;
use knotdock_structures::Knots;
use nalgebra::{DMatrix, UnitQuaternion};
use num_complex::Complex;
use rayon::prelude::*;
use std::sync::Arc;

/// An engine of the lowest rank that stays within a third of its plan's tolerance.
pub struct ChosenRank<T: Real> {
    /// The engine.
    pub engine: CpuEngine<T>,
    /// Its largest error at the best voxels of the probe rotations, relative to the best score there.
    pub error: f64,
    /// Part of its components that belongs to each function of the spectra: none is below zero, and they add up to the
    /// rank.
    pub shares: Vec<f64>,
}

/// Builds the engine of the lowest rank whose error is within a third of the plan's tolerance.
///
/// The error is the largest at the 50 best voxels of three rotations of `set`, against the full rank. It falls with the
/// rank, so that halving finds the rank. `set` must not be empty.
pub fn choose_rank<T: Real>(
    plan: &Arc<Plan>,
    spectra: &ReceptorSpectra<T>,
    ligand: &Knots,
    set: &[UnitQuaternion<f64>],
) -> ChosenRank<T> {
    let factors = spectra.factor(plan.modes());
    // Singular values below rounding carry nothing.
    let rounding = T::epsilon().wide();
    let largest = factors.singular.first().copied().unwrap_or(0.0);
    let numerical = factors.singular.iter().filter(|s| **s > rounding * largest);
    let full_rank = numerical.count().max(1);
    let engine = CpuEngine::with_factors(Arc::clone(plan), spectra, &factors, ligand, full_rank);
    let (engine, error) = lowest(engine, plan.options().tolerance / 3.0, set);
    let shares = shares(spectra, &factors.combination, engine.rank());
    ChosenRank {
        engine,
        error,
        shares,
    }
}

/// Part of the first `rank` components that belongs to each function.
///
/// A component's spectrum is the sum of the functions' spectra times its combination. A function's part of it is the
/// square of what it contributes, as a share of the squares of all.
fn shares<T: Real>(
    spectra: &ReceptorSpectra<T>,
    combination: &DMatrix<f64>,
    rank: usize,
) -> Vec<f64> {
    let norm = |spectrum: &Arc<Vec<Complex<T>>>| -> f64 {
        spectrum.iter().map(|value| value.norm_sqr().wide()).sum()
    };
    let norms: Vec<f64> = spectra.spectra().par_iter().map(norm).collect();
    let mut shares = vec![0.0; norms.len()];
    for q in 0..rank {
        let squares = (0..norms.len()).map(|b| combination[(b, q)].powi(2) * norms[b]);
        let squares: Vec<f64> = squares.collect();
        let sum: f64 = squares.iter().sum();
        for (share, square) in shares.iter_mut().zip(squares) {
            *share += square / sum.max(f64::MIN_POSITIVE);
        }
    }
    shares
}

/// The engine of the lowest rank whose error is within a limit, made from that of full rank; and its error.
fn lowest<T: Real>(
    full: CpuEngine<T>,
    limit: f64,
    set: &[UnitQuaternion<f64>],
) -> (CpuEngine<T>, f64) {
    let mut chosen = (full, 0.0);
    if chosen.0.rank() == 1 {
        return chosen;
    }
    let probes = Probes::new(set, &chosen.0);
    // The rank of `chosen` serves, and no rank below `least` does.
    let mut least = 1;
    while least < chosen.0.rank() {
        let middle = least.midpoint(chosen.0.rank());
        let engine = chosen.0.truncated(middle);
        let error = probes.error(&engine);
        if error <= limit {
            chosen = (engine, error);
        } else {
            least = middle + 1;
        }
    }
    chosen
}
