//! The scan of all rotations: how many fields of the lifted axis it needs, and the best grid poses that it finds.

use crate::dock::plan::DockPlan;
use crate::error::SearchError;
use crate::pose_space::axes::RingVoxels;
use crate::progress::Progress;
use crate::search::peaks::{Peak, find_peaks};
use crate::search::scan_engine::ScanEngine;
use crate::search::schedule::Deadline;
use knotdock_scoring::engine::CpuEngine;
use knotdock_scoring::engine::ReceptorSpectra;
#[cfg(feature = "gpu")]
use knotdock_scoring::engine::gpu::{GpuEngine, Turn};
use knotdock_scoring::se3::HalfTurn;
use knotdock_scoring::transform::Real;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// The values that a rank is judged by: the best of a few probe rotations at full rank.
pub(crate) struct Probes<T> {
    /// Index of the rotation, and its best voxels with their values.
    samples: Vec<(usize, Vec<(usize, T)>)>,
    /// The best of all.
    best: T,
}

/// An engine of the lowest rank that serves, with its error at the probes, relative to the best score there.
pub(crate) struct Chosen<T: Real> {
    pub engine: CpuEngine<T>,
    pub error: f64,
}

impl<T: Real> Probes<T> {
    /// Correlates the probe rotations at full rank.
    pub fn new(plan: &DockPlan, full: &CpuEngine<T>) -> Self {
        const PROBES: usize = 3;
        const BEST: usize = 50;
        let mut work = full.workspace();
        let mut samples: Vec<(usize, Vec<(usize, T)>)> = Vec::new();
        let mut best = T::min_positive_value();
        for probe in 0..PROBES {
            let index = (2 * probe + 1) * plan.set.len() / (2 * PROBES);
            full.correlate(&plan.set[index], &mut work);
            let mut order: Vec<usize> = (0..work.grid.len()).collect();
            let count = BEST.min(order.len() - 1);
            order.select_nth_unstable_by(count, |&a, &b| {
                let (first, second) = (work.grid[a].wide(), work.grid[b].wide());
                second.total_cmp(&first).then(a.cmp(&b))
            });
            let values: Vec<(usize, T)> =
                order[..count].iter().map(|&v| (v, work.grid[v])).collect();
            best = values.iter().fold(best, |best, value| best.max(value.1));
            samples.push((index, values));
        }
        Self { samples, best }
    }

    /// Largest error of an engine at the probes' best voxels, as a share of the best.
    fn error(&self, plan: &DockPlan, engine: &CpuEngine<T>) -> f64 {
        let mut work = engine.workspace();
        let mut error = T::zero();
        for (index, values) in &self.samples {
            engine.correlate(&plan.set[*index], &mut work);
            for &(voxel, exact) in values {
                error = error.max((work.grid[voxel] - exact).abs() / self.best);
            }
        }
        error.wide()
    }
}

/// The engine of the lowest rank whose error at the best poses of a few probe rotations is within a third of the tolerance, found by halving, for the
/// error falls with the rank.
pub(crate) fn choose_rank<T: Real>(plan: &DockPlan, folded: &ReceptorSpectra<T>) -> Chosen<T> {
    let factors = folded.factor(&plan.engine.modes);
    // What lies below rounding is no rank.
    let rounding = T::epsilon().wide();
    let largest = factors.singular.first().copied().unwrap_or(0.0);
    let numerical = factors.singular.iter().filter(|s| **s > rounding * largest);
    let full_rank = numerical.count().max(1);
    let engine = CpuEngine::with_factors(
        plan.engine.clone(),
        folded,
        &factors,
        &plan.ligand,
        full_rank,
    );
    let mut chosen = Chosen { engine, error: 0.0 };
    if full_rank == 1 {
        return chosen;
    }
    let probes = Probes::new(plan, &chosen.engine);
    let limit = plan.options.kernel.tolerance / 3.0;
    // `chosen` serves, and no rank below `least` does.
    let mut least = 1;
    while least < chosen.engine.rank() {
        let middle = least.midpoint(chosen.engine.rank());
        let engine = chosen.engine.truncated(middle);
        let error = probes.error(plan, &engine);
        if error <= limit {
            chosen = Chosen { engine, error };
        } else {
            least = middle + 1;
        }
    }
    chosen
}

/// Four rotations of a set that differ by half-turns and so share the ligand's transform.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quartet {
    /// Index of the first ([`DockPlan::rotation`]).
    pub first: usize,
    /// Which of the four are searched.
    pub wanted: [bool; 4],
}

impl Quartet {
    /// How many of the four are searched.
    pub fn count(&self) -> usize {
        self.wanted.iter().filter(|wanted| **wanted).count()
    }
}

/// What a scan found.
pub(crate) struct Scanned {
    /// The best peaks, best first.
    pub peaks: Vec<Peak>,
    /// Rotations that were searched.
    pub rotations: usize,
}

/// The coarse set, in fours; axes of rings one by one, for half-turns make no rings of rings.
pub(crate) fn all_rotations(plan: &DockPlan) -> Vec<Quartet> {
    let count = plan.set.len();
    if plan.options.search.symmetry.is_some() {
        let wanted = [true, false, false, false];
        return (0..count).map(|first| Quartet { first, wanted }).collect();
    }
    let quartet = |first| Quartet {
        first,
        wanted: std::array::from_fn(|image| first + image < count),
    };
    (0..count).step_by(4).map(quartet).collect()
}

/// The best `most` peaks over the rotations given: over the first of them, where a deadline comes before the last.
///
/// # Errors
/// [`SearchError::Graphics`] where the graphics processor fails.
pub(crate) fn scan<T: Real>(
    plan: &DockPlan,
    engine: &ScanEngine<T>,
    quartets: &[Quartet],
    most: usize,
    deadline: Option<&Deadline>,
    progress: &dyn Progress,
) -> Result<Scanned, SearchError> {
    // No list grows beyond all peaks that there are.
    let most = most.min(4 * quartets.len() * plan.options.search.per_rotation);
    #[cfg(feature = "gpu")]
    let mut scanned = match &engine.gpu {
        Some(gpu) => scan_on_card(plan, gpu, quartets, most, progress)?,
        None => scan_on_cores(plan, &engine.cpu, quartets, most, deadline, progress),
    };
    #[cfg(not(feature = "gpu"))]
    let mut scanned = scan_on_cores(plan, &engine.cpu, quartets, most, deadline, progress);
    let peaks = &mut scanned.peaks;
    peaks.retain(|peak| peak.score.is_finite());
    peaks.sort_unstable_by(Peak::order);
    peaks.truncate(most);
    Ok(scanned)
}

/// Peaks of the graphics processor, the best `most` among them.
#[cfg(feature = "gpu")]
fn scan_on_card(
    plan: &DockPlan,
    gpu: &GpuEngine,
    quartets: &[Quartet],
    most: usize,
    progress: &dyn Progress,
) -> Result<Scanned, SearchError> {
    // Peaks that come back together.
    const TOGETHER: usize = 1 << 20;
    let part = (TOGETHER / (4 * plan.options.search.per_rotation)).max(1);
    let mut peaks: Vec<Peak> = Vec::new();
    for quartets in quartets.chunks(part) {
        let turn = |quartet: &Quartet| Turn {
            rotation: plan.rotation(quartet.first).0,
            wanted: quartet.wanted,
        };
        let turns: Vec<Turn> = quartets.iter().map(turn).collect();
        let found = gpu.best(&turns, |images| progress.advance(images as u64))?;
        peaks.extend(found.into_iter().map(|peak| Peak {
            score: f64::from(peak.score),
            rotation: (quartets[peak.turn].first + peak.half_turn) as u32,
            voxel: peak.voxel,
        }));
        peaks.sort_unstable_by(Peak::order);
        peaks.truncate(most);
    }
    Ok(Scanned {
        peaks,
        rotations: quartets.iter().map(Quartet::count).sum(),
    })
}

/// Peaks of the CPU's cores, the best `most` of each thread among them. The quartets that are searched are the first ones, at
/// least one, whatever the threads: each takes the next one and searches it to its end.
fn scan_on_cores<T: Real>(
    plan: &DockPlan,
    engine: &CpuEngine<T>,
    quartets: &[Quartet],
    most: usize,
    deadline: Option<&Deadline>,
    progress: &dyn Progress,
) -> Scanned {
    let options = &plan.options;
    let rings = plan.rings.map(|rings| RingVoxels::new(engine, rings.axis));
    let (next, searched) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let begun = Instant::now();
    let take = || {
        let done = searched.load(Ordering::Relaxed);
        let is_late = |deadline: &Deadline| deadline.is_reached(begun, done);
        if next.load(Ordering::Relaxed) > 0 && deadline.is_some_and(is_late) {
            return None;
        }
        quartets.get(next.fetch_add(1, Ordering::Relaxed))
    };
    let peaks = (0..plan.in_flight)
        .into_par_iter()
        .with_max_len(1)
        .map(|_| {
            let mut work = engine.workspace();
            let mut found = Vec::with_capacity(2 * most + options.search.per_rotation);
            while let Some(quartet) = take() {
                let (rotation, _) = plan.rotation(quartet.first);
                engine.turn(&rotation, &mut work);
                for (image, half_turn) in HalfTurn::ALL.into_iter().enumerate() {
                    if !quartet.wanted[image] {
                        continue;
                    }
                    engine.correlate_turned(half_turn, &mut work);
                    if let Some(rings) = &rings {
                        rings.keep(&rotation, &mut work.grid, &mut work.row_best);
                    }
                    find_peaks(
                        plan.grid,
                        &mut work.grid,
                        &mut work.row_best,
                        (quartet.first + image) as u32,
                        options.search.per_rotation,
                        &mut found,
                    );
                    if found.len() >= 2 * most {
                        found.sort_unstable_by(Peak::order);
                        found.truncate(most);
                    }
                    progress.advance(1);
                }
                searched.fetch_add(quartet.count(), Ordering::Relaxed);
            }
            found
        })
        .flatten()
        .collect();
    Scanned {
        peaks,
        rotations: searched.into_inner(),
    }
}
