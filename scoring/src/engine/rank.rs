//! The choice of the rank: how many components of the lifted axis and the effects a tolerance needs.

use super::cpu::CpuEngine;
use super::plan::Plan;
use super::receptor_spectra::ReceptorSpectra;
use crate::transform::Real;
use knotdock_structures::Knots;
use nalgebra::UnitQuaternion;
use std::sync::Arc;

/// Rotations at which ranks are compared.
const PROBES: usize = 3;
/// Best voxels of each probe rotation at which ranks are compared.
const BEST: usize = 50;

/// An engine of the lowest rank that stays within a third of its plan's tolerance.
pub struct ChosenRank<T: Real> {
    /// The engine.
    pub engine: CpuEngine<T>,
    /// Its largest error at the best voxels of the probe rotations, relative to the best score there.
    pub error: f64,
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
    let mut chosen = ChosenRank { engine, error: 0.0 };
    if full_rank == 1 {
        return chosen;
    }
    let probes = Probes::new(set, &chosen.engine);
    let limit = plan.options().tolerance / 3.0;
    // The rank of `chosen` serves, and no rank below `least` does.
    let mut least = 1;
    while least < chosen.engine.rank() {
        let middle = least.midpoint(chosen.engine.rank());
        let engine = chosen.engine.truncated(middle);
        let error = probes.error(&engine);
        if error <= limit {
            chosen = ChosenRank { engine, error };
        } else {
            least = middle + 1;
        }
    }
    chosen
}

/// Reference values for the comparison of ranks: the best voxels of a few rotations at full rank.
struct Probes<T> {
    samples: Vec<Sample<T>>,
    /// The best value of all.
    best: T,
}

/// The best voxels of one rotation at full rank.
struct Sample<T> {
    rotation: UnitQuaternion<f64>,
    /// Voxels with their values.
    values: Vec<(usize, T)>,
}

impl<T: Real> Probes<T> {
    /// Correlates the probe rotations at full rank.
    fn new(set: &[UnitQuaternion<f64>], full: &CpuEngine<T>) -> Self {
        let mut work = full.workspace();
        let mut samples: Vec<Sample<T>> = Vec::with_capacity(PROBES);
        let mut best = T::min_positive_value();
        for probe in 0..PROBES {
            let rotation = set[(2 * probe + 1) * set.len() / (2 * PROBES)];
            full.correlate(&rotation, &mut work);
            // A grid has fewer voxels than 32 bits number.
            let mut order: Vec<u32> = (0..work.grid.len() as u32).collect();
            let count = BEST.min(order.len() - 1);
            order.select_nth_unstable_by(count, |&a, &b| {
                let value = |voxel: u32| work.grid[voxel as usize].wide();
                let (first, second) = (value(a), value(b));
                second.total_cmp(&first).then(a.cmp(&b))
            });
            let values: Vec<(usize, T)> = order[..count]
                .iter()
                .map(|&v| (v as usize, work.grid[v as usize]))
                .collect();
            best = values.iter().fold(best, |best, value| best.max(value.1));
            samples.push(Sample { rotation, values });
        }
        Self { samples, best }
    }

    /// Largest error of an engine at the probes' best voxels, as a share of the best.
    fn error(&self, engine: &CpuEngine<T>) -> f64 {
        let mut work = engine.workspace();
        let mut error = T::zero();
        for Sample { rotation, values } in &self.samples {
            engine.correlate(rotation, &mut work);
            for &(voxel, exact) in values {
                error = error.max((work.grid[voxel] - exact).abs() / self.best);
            }
        }
        error.wide()
    }
}
