//! The choice of the rank: how many components of the lifted axis and the effects a tolerance needs. Probes are voxels
//! of a few rotations at which an engine is compared with another rank, and with the exact sum.

use super::cpu::CpuEngine;
use super::plan::Plan;
use super::receptor_spectra::ReceptorSpectra;
use crate::exact::ExactScorer;
use crate::peaks::ScoreGrid;
use crate::precision::Precision;
use crate::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::{DMatrix, UnitQuaternion};
use rayon::prelude::*;
use std::sync::Arc;

/// Rotations of the probes.
const PROBES: usize = 3;
/// Best voxels of each.
const BEST: usize = 50;
/// Further voxels of each at which the exact sum is taken: evenly over the grid, and as many over the tenth of it with the
/// largest magnitudes, where bodies overlap and errors are largest.
const SWEPT: usize = 100;

/// An engine of the lowest rank that stays within a third of its plan's tolerance.
pub struct ChosenRank {
    /// The engine.
    pub engine: CpuEngine,
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
pub fn choose_rank(
    plan: &Arc<Plan>,
    spectra: &ReceptorSpectra,
    ligand: &Knots,
    set: &[UnitQuaternion<f64>],
) -> ChosenRank {
    let factors = spectra.factor(plan.modes());
    // Singular values below rounding carry nothing.
    let rounding = spectra.precision().epsilon();
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
/// A component's spectrum is the sum of the functions' spectra times its combination. A function's part of it is its
/// squared contribution, as a share of the squares of all.
fn shares(spectra: &ReceptorSpectra, combination: &DMatrix<f64>, rank: usize) -> Vec<f64> {
    let norms = spectra.norms();
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
fn lowest(full: CpuEngine, limit: f64, set: &[UnitQuaternion<f64>]) -> (CpuEngine, f64) {
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

/// Reference values for the comparison of ranks: the best voxels of a few rotations at full rank.
struct Probes {
    samples: Vec<Sample>,
    /// The best value of all.
    best: f64,
}

/// The best voxels of one rotation at full rank.
struct Sample {
    rotation: UnitQuaternion<f64>,
    /// Voxels with their values.
    values: Vec<(usize, f64)>,
}

impl Probes {
    /// Correlates the probe rotations at full rank.
    pub fn new(set: &[UnitQuaternion<f64>], full: &CpuEngine) -> Self {
        let sample = |probe: usize| {
            let rotation = probe_rotation(set, probe);
            let mut work = full.workspace();
            full.correlate(&rotation, &mut work);
            let values = best_voxels(&work.scores).into_iter();
            let values = values.map(|voxel| (voxel, work.scores.score(voxel)));
            Sample {
                rotation,
                values: values.collect(),
            }
        };
        let samples: Vec<Sample> = (0..PROBES).into_par_iter().map(sample).collect();
        let values = samples.iter().flat_map(|sample| &sample.values);
        let least = full.precision().least_positive();
        let best = values.fold(least, |best, value| best.max(value.1));
        Self { samples, best }
    }

    /// Largest error of an engine at the probes' best voxels, as a share of the best.
    pub fn error(&self, engine: &CpuEngine) -> f64 {
        // In the precision of the scores.
        let share = |score: f64, exact: f64| match engine.precision() {
            Precision::Single => f64::from((score as f32 - exact as f32).abs() / self.best as f32),
            Precision::Double => (score - exact).abs() / self.best,
        };
        let of_sample = |Sample { rotation, values }: &Sample| {
            let mut work = engine.workspace();
            engine.correlate(rotation, &mut work);
            let errors = values.iter();
            let errors = errors.map(|&(voxel, exact)| share(work.scores.score(voxel), exact));
            errors.fold(0.0, f64::max)
        };
        let errors = self.samples.par_iter().map(of_sample);
        errors.reduce(|| 0.0, f64::max)
    }
}

/// One of the probes' rotations among those of `set`, which must not be empty.
fn probe_rotation(set: &[UnitQuaternion<f64>], probe: usize) -> UnitQuaternion<f64> {
    set[(2 * probe + 1) * set.len() / (2 * PROBES)]
}

/// The best voxels of a grid, in any order.
fn best_voxels(grid: &ScoreGrid) -> Vec<usize> {
    first_voxels(grid.count(), BEST, |voxel| grid.score(voxel))
}

/// Voxels of a grid at which the exact sum is taken, in any order.
fn sampled_voxels(grid: &ScoreGrid) -> Vec<usize> {
    let count = grid.count();
    let mut voxels = best_voxels(grid);
    voxels.extend((0..count).step_by(count.div_ceil(SWEPT)));
    let overlap = first_voxels(count, count / 10, |voxel| grid.score(voxel).abs());
    voxels.extend(overlap.iter().step_by(overlap.len().div_ceil(SWEPT).max(1)));
    voxels
}

/// The `first` of `count` voxels with the largest values, in any order; not all.
fn first_voxels(count: usize, first: usize, value: impl Fn(usize) -> f64) -> Vec<usize> {
    // A grid has fewer voxels than 32 bits number.
    let mut order: Vec<u32> = (0..count as u32).collect();
    let first = first.min(count - 1);
    order.select_nth_unstable_by(first, |&a, &b| {
        let [left, right] = [a, b].map(|voxel| value(voxel as usize));
        right.total_cmp(&left).then(a.cmp(&b))
    });
    order[..first].iter().map(|&voxel| voxel as usize).collect()
}

/// Largest error of an engine against the exact sum, over the best voxels of three rotations of `set` and sweeps through
/// their grids. A share of the best exact score there; if nothing is rewarded, of the largest magnitude.
pub(crate) fn measured_error(
    engine: &CpuEngine,
    exact: &ExactScorer,
    set: &[UnitQuaternion<f64>],
    is_rewarded: bool,
) -> f64 {
    let plan = engine.plan();
    let mut work = engine.workspace();
    let mut scored: Vec<(f64, Pose)> = Vec::with_capacity(PROBES * (BEST + 2 * SWEPT));
    for probe in 0..PROBES {
        let rotation = probe_rotation(set, probe);
        engine.correlate(&rotation, &mut work);
        for voxel in sampled_voxels(&work.scores) {
            let place = plan.receptor_center() + engine.position(voxel);
            let pose = Pose::about(rotation, plan.ligand_center(), place);
            scored.push((work.scores.score(voxel), pose));
        }
    }
    let exact = scored.par_iter().map(|(_, pose)| exact.score_only(pose));
    let exact: Vec<f64> = exact.collect();
    let errors = scored
        .iter()
        .zip(&exact)
        .map(|((fast, _), exact)| (fast - exact).abs());
    let error = errors.fold(0.0, f64::max);
    let size = |score: &f64| if is_rewarded { *score } else { score.abs() };
    let scale = exact.iter().map(size).fold(0.0, f64::max);
    if error == 0.0 { 0.0 } else { error / scale }
}
