//! The choice of the rank: how many components of the lifted axis and the effects a tolerance needs.

use super::cpu::CpuEngine;
use super::plan::Plan;
use super::probes::Probes;
use super::receptor_spectra::ReceptorSpectra;
use crate::transform::Real;
use knotdock_structures::Knots;
use nalgebra::UnitQuaternion;
use std::sync::Arc;

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
