//! Probes of an engine: voxels of a few rotations at which it is compared with another rank, and with the exact sum.

use super::cpu::CpuEngine;
use crate::exact::ExactScorer;
use crate::grid_turn::GridTurn;
use crate::se3::Pose;
use crate::transform::Real;
use nalgebra::UnitQuaternion;
use rayon::prelude::*;

/// Rotations of the probes.
const PROBES: usize = 3;
/// Best voxels of each.
const BEST: usize = 50;
/// Further voxels of each at which the exact sum is taken: evenly over the grid, and as many over the tenth of it with the
/// largest magnitudes, where bodies overlap and errors are largest.
const SWEPT: usize = 100;

/// Reference values for the comparison of ranks: the best voxels of a few rotations at full rank.
pub(super) struct Probes<T> {
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
    pub fn new(set: &[UnitQuaternion<f64>], full: &CpuEngine<T>) -> Self {
        let mut work = full.workspace();
        let mut samples: Vec<Sample<T>> = Vec::with_capacity(PROBES);
        let mut best = T::min_positive_value();
        for probe in 0..PROBES {
            let rotation = probe_rotation(set, probe);
            full.correlate(&rotation, &mut work);
            let values: Vec<(usize, T)> = best_voxels(&work.grid)
                .into_iter()
                .map(|voxel| (voxel, work.grid[voxel]))
                .collect();
            best = values.iter().fold(best, |best, value| best.max(value.1));
            samples.push(Sample { rotation, values });
        }
        Self { samples, best }
    }

    /// Largest error of an engine at the probes' best voxels, as a share of the best.
    pub fn error(&self, engine: &CpuEngine<T>) -> f64 {
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

/// One of the probes' rotations among those of `set`, which must not be empty.
fn probe_rotation(set: &[UnitQuaternion<f64>], probe: usize) -> UnitQuaternion<f64> {
    set[(2 * probe + 1) * set.len() / (2 * PROBES)]
}

/// The best voxels of a grid, in any order.
fn best_voxels<T: Real>(grid: &[T]) -> Vec<usize> {
    first_voxels(grid.len(), BEST, |voxel| grid[voxel].wide())
}

/// Voxels of a grid at which the exact sum is taken, in any order.
fn sampled_voxels<T: Real>(grid: &[T]) -> Vec<usize> {
    let count = grid.len();
    let mut voxels = best_voxels(grid);
    voxels.extend((0..count).step_by(count.div_ceil(SWEPT)));
    let overlap = first_voxels(count, count / 10, |voxel| grid[voxel].wide().abs());
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
pub(crate) fn measured_error<T: Real>(
    engine: &CpuEngine<T>,
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
        for voxel in sampled_voxels(&work.grid) {
            let place = plan.receptor_center() + engine.position_after(GridTurn::NONE, voxel);
            let pose = Pose::about(rotation, plan.ligand_center(), place);
            scored.push((work.grid[voxel].wide(), pose));
        }
    }
    let exact = scored.par_iter().map(|(_, pose)| exact.score_only(pose));
    let exact: Vec<f64> = exact.collect();
    let errors = scored
        .iter()
        .zip(&exact)
        .map(|((fast, _), exact)| (fast - exact).abs());
    let (error, best) = (
        errors.fold(0.0, f64::max),
        exact.iter().copied().fold(0.0, f64::max),
    );
    let largest = exact
        .iter()
        .fold(0.0f64, |largest, score| largest.max(score.abs()));
    let scale = if is_rewarded { best } else { largest };
    if error == 0.0 { 0.0 } else { error / scale }
}
