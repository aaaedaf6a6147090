//! The scan of all rotations: the best grid poses that it finds.

#[cfg(feature = "gpu")]
use crate::options::EngineChoice;
use crate::pose_space::rotations::RotationGroup;
use crate::progress::{Interruption, Progress};
use crate::search::allowed::Region;
use crate::search::deadline::Deadline;
use crate::search::plan::SearchPlan;
use crate::search::scan_engine::ScanEngine;
#[cfg(feature = "gpu")]
use crate::search::scan_engine::no_graphics;
#[cfg(feature = "gpu")]
use knotdock_scoring::engine::gpu::{GpuEngine, LigandRotation};
#[cfg(feature = "gpu")]
use knotdock_scoring::gpu::GpuError;
use knotdock_scoring::grid_turn::GridTurn;
use knotdock_scoring::peaks::{Peak, PeakLimits};
use knotdock_structures::Error;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Instant;

/// Images of a rotation at the most.
const IMAGES: usize = GridTurn::ALL.len();

/// Peaks that come back from a graphics processor together, at most.
pub(crate) const TOGETHER: usize = 1 << 20;

/// Peaks that a scan found.
pub(crate) struct Scanned {
    /// The best peaks, best first.
    pub peaks: Vec<Peak>,
    /// Rotations that were searched.
    pub rotations: usize,
}

/// The best `most` peaks over the rotations given: over the first of them, if a deadline comes before the last.
///
/// # Errors
/// [`Error`] if the graphics processor fails, and if `progress` ends the run.
pub(crate) fn scan(
    plan: &SearchPlan,
    engine: &ScanEngine,
    groups: &[RotationGroup],
    most: usize,
    deadline: Option<&Deadline>,
    progress: &dyn Progress,
) -> Result<Scanned, Error> {
    // No list grows beyond all peaks that there are.
    let most = most.min(plan.rotations.images * groups.len() * plan.per_rotation);
    let shown = AtomicU64::new(0);
    let at_least = |least| {
        let progress = Attempt::new(progress, &shown);
        scan_on_cores(plan, engine, groups, (most, least), deadline, &progress)
    };
    // At most rotations, the restraints may allow only overlapping poses. Poses that score less than the two bodies apart
    // are then kept only if there are no others.
    let on_cores = || {
        let restrained = plan.allowed.as_ref().map(|_| at_least(0.0));
        let scanned = restrained.filter(|scanned| !scanned.peaks.is_empty());
        scanned.unwrap_or_else(|| at_least(f64::NEG_INFINITY))
    };
    #[cfg(feature = "gpu")]
    let mut scanned = match &engine.gpu {
        Some(gpu) if engine.failure().is_none() => {
            match scan_on_card(plan, gpu, groups, most, &Attempt::new(progress, &shown)) {
                Err(error) if plan.device == EngineChoice::Auto => {
                    progress.go_on()?;
                    engine.leave_card(&error);
                    on_cores()
                }
                scanned => scanned.map_err(no_graphics)?,
            }
        }
        _ => on_cores(),
    };
    #[cfg(not(feature = "gpu"))]
    let mut scanned = on_cores();
    progress.go_on()?;
    let peaks = &mut scanned.peaks;
    peaks.retain(|peak| peak.score.is_finite());
    peaks.sort_unstable_by(Peak::order);
    peaks.truncate(most);
    peaks.shrink_to_fit();
    Ok(scanned)
}

/// Progress of one attempt at rotations that may be searched again: each counts once.
struct Attempt<'a> {
    progress: &'a dyn Progress,
    done: AtomicU64,
    /// The most that an attempt has done.
    shown: &'a AtomicU64,
}

impl<'a> Attempt<'a> {
    fn new(progress: &'a dyn Progress, shown: &'a AtomicU64) -> Self {
        Self {
            progress,
            done: AtomicU64::new(0),
            shown,
        }
    }
}

impl Progress for Attempt<'_> {
    fn advance(&self, by: u64) {
        let done = self.done.fetch_add(by, Ordering::Relaxed) + by;
        let before = self.shown.fetch_max(done, Ordering::Relaxed);
        if done > before {
            self.progress.advance(done - before);
        }
    }

    fn go_on(&self) -> Result<(), Interruption> {
        self.progress.go_on()
    }
}

/// Peaks of the graphics processor, the best `most` among them.
#[cfg(feature = "gpu")]
fn scan_on_card(
    plan: &SearchPlan,
    gpu: &GpuEngine,
    groups: &[RotationGroup],
    most: usize,
    progress: &dyn Progress,
) -> Result<Scanned, GpuError> {
    let part = (TOGETHER / (plan.rotations.images * plan.per_rotation)).max(1);
    let mut peaks: Vec<Peak> = Vec::new();
    for groups in groups.chunks(part) {
        if progress.go_on().is_err() {
            break; // The run ends where this is asked for next.
        }
        let turn = |group: &RotationGroup| LigandRotation {
            rotation: plan.rotations.rotation(group.first).0,
            wanted: group.wanted,
        };
        let turns: Vec<LigandRotation> = groups.iter().map(turn).collect();
        let found = gpu.best(&turns, &mut |images| progress.advance(images as u64));
        peaks.extend(found?.into_iter().map(|peak| Peak {
            score: f64::from(peak.score),
            rotation: (groups[peak.turn].first + peak.image) as u32,
            voxel: peak.voxel,
        }));
        peaks.sort_unstable_by(Peak::order);
        peaks.truncate(most);
    }
    Ok(Scanned {
        peaks,
        rotations: groups.iter().map(RotationGroup::count).sum(),
    })
}

/// Peaks of the CPU's cores that score `least` or more, the best `most` of each thread among them. The groups that are
/// searched are the first ones, at least one, for any number of threads: each takes the next one and searches it to its end.
fn scan_on_cores(
    plan: &SearchPlan,
    engine: &ScanEngine,
    groups: &[RotationGroup],
    (most, least): (usize, f64),
    deadline: Option<&Deadline>,
    progress: &dyn Progress,
) -> Scanned {
    let in_flight = engine.in_flight;
    let engine = &engine.cpu;
    let filter = plan.space.voxel_filter(engine);
    let restrained = plan.allowed.as_ref().map(|allowed| allowed.regions(engine));
    let (next, searched) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let started = Instant::now();
    let take = || {
        let done = searched.load(Ordering::Relaxed);
        let is_late = |deadline: &Deadline| deadline.is_reached(started, done);
        if next.load(Ordering::Relaxed) > 0 && deadline.is_some_and(is_late) {
            return None;
        }
        if progress.go_on().is_err() {
            return None;
        }
        groups.get(next.fetch_add(1, Ordering::Relaxed))
    };
    let peaks = (0..in_flight)
        .into_par_iter()
        .with_max_len(1)
        .map(|_| {
            let mut work = engine.workspace_of(plan.rotations.images);
            let mut regions: [Region; IMAGES] = Default::default();
            let mut found = Vec::with_capacity(2 * most + plan.per_rotation);
            // Peaks that score less are never kept.
            let mut floor = least;
            while let Some(group) = take() {
                let (rotation, _) = plan.rotations.rotation(group.first);
                let (mut turns, mut images) = ([GridTurn::NONE; IMAGES], [0; IMAGES]);
                let mut count = 0;
                for image in group.images() {
                    // A rotation at which no translation is allowed needs no correlation.
                    if let Some(restrained) = &restrained {
                        let (rotation, turn) = plan.rotations.rotation(group.first + image);
                        restrained.at(&rotation, turn, &mut regions[count]);
                        if regions[count].is_empty() {
                            progress.advance(1);
                            continue;
                        }
                    }
                    (turns[count], images[count]) = (GridTurn::ALL[image], image);
                    count += 1;
                }
                if count > 0 {
                    engine.transform_ligand(&rotation, &mut work);
                }
                engine.correlate_each(&turns[..count], &mut work, &mut |place, scores| {
                    if let Some(filter) = &filter {
                        filter.restrict(&rotation, scores);
                    }
                    let rotation = (group.first + images[place]) as u32;
                    let limits = PeakLimits {
                        count: plan.per_rotation,
                        floor,
                    };
                    if restrained.is_some() {
                        let region = &mut regions[place];
                        region.restrict(scores);
                        let check = &mut |row, open: &mut [bool]| region.check(row, open);
                        scores.find_peaks_among(rotation, limits, &mut found, check);
                    } else {
                        scores.find_peaks(rotation, limits, &mut found);
                    }
                    if found.len() >= 2 * most {
                        found.sort_unstable_by(Peak::order);
                        found.truncate(most);
                        floor = found.last().map_or(floor, |peak| peak.score);
                    }
                    progress.advance(1);
                });
                searched.fetch_add(group.count(), Ordering::Relaxed);
            }
            // The lists of all threads are joined: each is no longer than the list that is kept.
            if found.len() > most {
                found.sort_unstable_by(Peak::order);
                found.truncate(most);
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
