//! The scan of all rotations: the best grid poses that it finds.

use crate::dock::plan::DockPlan;
use crate::error::SearchError;
use crate::pose_space::axes::RingVoxels;
use crate::progress::Progress;
use crate::search::scan_engine::ScanEngine;
use crate::search::schedule::Deadline;
#[cfg(feature = "gpu")]
use knotdock_scoring::engine::gpu::{GpuEngine, Turn};
use knotdock_scoring::engine::{self, ChosenRank, CpuEngine, ReceptorSpectra};
use knotdock_scoring::peaks::{Peak, find_peaks};
use knotdock_scoring::se3::HalfTurn;
use knotdock_scoring::transform::Real;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// The engine of the lowest rank that the plan's tolerance allows.
pub(crate) fn choose_rank<T: Real>(plan: &DockPlan, folded: &ReceptorSpectra<T>) -> ChosenRank<T> {
    engine::choose_rank(&plan.engine, folded, &plan.ligand, &plan.set)
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
    if plan.options.symmetry.is_some() {
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
    let most = most.min(4 * quartets.len() * plan.options.per_rotation);
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
    let part = (TOGETHER / (4 * plan.options.per_rotation)).max(1);
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
            let mut found = Vec::with_capacity(2 * most + options.per_rotation);
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
                        options.per_rotation,
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
