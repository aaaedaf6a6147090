//! The run: fold the receptor, search the rotations, refine the best peaks, score exactly, merge, cluster, rank.

use super::cluster::{RigidBody, greedy};
use super::options::{Effect, SearchError};
use super::outcome::{DockOutcome, EffectCost, MeasuredError, RankedPose, StageTime};
use super::peaks::{Peak, find_peaks};
use super::plan::DockPlan;
use super::refine::{ClimbLimits, climb};
use cpu_time::ProcessTime;
use knotdock_scoring::engine::CpuEngine;
use knotdock_scoring::engine::cpu::Folded;
use knotdock_scoring::exact::{ExactScore, ExactScorer};
use knotdock_scoring::field::ReceptorField;
use knotdock_scoring::lifted_axis::Fold;
use knotdock_scoring::se3::{HalfTurn, Pose};
use knotdock_structures::molecule::Molecule;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Who is told how far a run has come.
pub trait Progress: Sync {
    /// A stage of `total` steps begins.
    fn stage(&self, name: &str, total: u64);
    /// So many steps more are done.
    fn advance(&self, by: u64);
}

/// Grid poses over which the fast path's error is measured.
const ERROR_POSES: usize = 100;
/// Refined poses closer than this share of the grid spacing (ligand RMSD) are one.
const MERGE_SPACINGS: f64 = 0.25;

struct Clock {
    stages: Vec<StageTime>,
    wall: Instant,
    cpu: Option<ProcessTime>,
}

impl Clock {
    fn start() -> Self {
        Self {
            stages: Vec::new(),
            wall: Instant::now(),
            cpu: ProcessTime::try_now().ok(),
        }
    }

    fn lap(&mut self, name: &'static str) {
        let cpu = self.cpu.and_then(|cpu| cpu.try_elapsed().ok());
        self.stages.push(StageTime {
            name,
            wall_seconds: self.wall.elapsed().as_secs_f64(),
            cpu_seconds: cpu.map(|cpu| cpu.as_secs_f64()),
        });
        self.wall = Instant::now();
        self.cpu = ProcessTime::try_now().ok();
    }
}

/// Docks as planned.
///
/// # Errors
/// [`SearchError`] when threads cannot be had or no pose scores.
pub fn dock(
    plan: &DockPlan,
    ligand: &Molecule,
    progress: &dyn Progress,
) -> Result<DockOutcome, SearchError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(plan.in_flight)
        .build()
        .map_err(|error| SearchError::Threads(error.to_string()))?;
    pool.install(|| dock_in_pool(plan, ligand, progress))
}

fn dock_in_pool(
    plan: &DockPlan,
    ligand: &Molecule,
    progress: &dyn Progress,
) -> Result<DockOutcome, SearchError> {
    let options = &plan.options;
    let mut clock = Clock::start();
    progress.stage("prepare", 1);
    let folded = Folded::<f32>::new(&plan.engine, &plan.receptor, &plan.ligand, Fold::Score);
    let (engine, rank_error) = choose_rank(plan, &folded);
    let scorer = ExactScorer::new(&plan.engine.kernel, &plan.receptor, &plan.ligand)?;
    progress.advance(1);
    clock.lap("prepare");

    progress.stage("search", plan.rotations as u64);
    let peaks = search(plan, &engine, progress);
    clock.lap("search");
    if peaks.is_empty() {
        return Err(SearchError::NoPose);
    }
    let grid_poses: Vec<Pose> = peaks
        .iter()
        .map(|peak| {
            let index = peak.rotation as usize;
            let half_turn = HalfTurn::ALL[index % 4];
            let place =
                plan.engine.receptor_center + engine.position_after(half_turn, peak.voxel as usize);
            let rotation = plan.set[index];
            Pose::about(rotation, plan.engine.ligand_center, place)
        })
        .collect();

    let points = cluster_points(ligand);
    let body = RigidBody::new(&points);
    let refined_count = options.refine.min(peaks.len());
    progress.stage("refine", refined_count as u64);
    let refined: Vec<Pose> = if refined_count == 0 {
        Vec::new()
    } else {
        let field = ReceptorField::new(&plan.engine, &folded, &plan.ligand);
        let limits = ClimbLimits {
            evaluations: 40,
            distance: 3.0 * plan.spacing,
            angle: plan.covering_radius_degrees.to_radians(),
            gyration: body.gyration(),
        };
        grid_poses[..refined_count]
            .par_iter()
            .map(|&pose| {
                let top = climb(pose, plan.engine.ligand_center, &limits, |pose| {
                    field.gradient(pose)
                });
                progress.advance(1);
                top
            })
            .collect()
    };
    drop(folded);
    clock.lap("refine");

    progress.stage("score", peaks.len() as u64);
    let checked = ERROR_POSES.min(peaks.len()).max(refined_count);
    // Printed poses are what is scored: a quaternion's digits survive the table's round trip.
    let at_grid: Vec<ExactScore> = grid_poses[..checked]
        .par_iter()
        .map(|pose| scorer.score(pose))
        .collect();
    let mut rows: Vec<RankedPose> = (0..peaks.len())
        .into_par_iter()
        .map(|index| {
            let peak = &peaks[index];
            let grid_pose = printed(&grid_poses[index]);
            let grid_score = || {
                at_grid
                    .get(index)
                    .copied()
                    .unwrap_or_else(|| scorer.score(&grid_pose))
            };
            let (pose, exact, moved) = match refined.get(index).map(printed) {
                Some(pose) => {
                    let exact = scorer.score(&pose);
                    let before = grid_score();
                    // A climb on the fast path's values that the exact sum does not confirm is undone.
                    if exact.score >= before.score {
                        (pose, exact, true)
                    } else {
                        (grid_pose, scorer.score(&grid_pose), true)
                    }
                }
                None => (grid_pose, grid_score(), false),
            };
            progress.advance(1);
            RankedPose {
                pose,
                score: exact.score,
                cluster: None,
                cluster_size: None,
                refined: moved,
                rotation: peak.rotation as usize,
                score_grid: f64::from(peak.score),
                score_unfiltered: exact.unfiltered,
                shape: exact.score,
                slices: exact.slices,
            }
        })
        .filter(|row| row.score.is_finite() && row.score_unfiltered.is_finite())
        .collect();
    // The list comes in the order of the grid's scores, which breaks ties.
    rows.sort_by(|a, b| b.score.total_cmp(&a.score));
    let best = rows
        .first()
        .map_or(1.0, |row| row.score.abs())
        .max(f64::MIN_POSITIVE);
    let error = measured(&peaks, &at_grid, best);
    clock.lap("score");

    merge(&mut rows, &body, MERGE_SPACINGS * plan.spacing);
    let clusters = number_clusters(&mut rows, &body, options.cluster_radius);
    let kept = rows.len();
    if !options.every_pose {
        let mut seen = 0;
        rows.retain(|row| {
            let first = row.cluster == Some(seen + 1);
            seen += usize::from(first);
            first
        });
    }
    clock.lap("cluster");

    let seconds = |name: &str| {
        clock
            .stages
            .iter()
            .find(|stage| stage.name == name)
            .map_or(0.0, |stage| stage.cpu_seconds.unwrap_or(stage.wall_seconds))
    };
    Ok(DockOutcome {
        poses: rows,
        poses_kept: kept,
        clusters,
        error,
        rank_error,
        effects: vec![EffectCost {
            effect: Effect::Shape,
            reason: "always on",
            rank: engine.rank(),
            milliseconds_per_rotation: 1e3 * seconds("search") / plan.rotations as f64,
        }],
        timing: clock.stages,
    })
}

/// The pose as its printed digits give it back: normalised, w not negative.
fn printed(pose: &Pose) -> Pose {
    Pose::from_parts(pose.quaternion(), pose.translation.into())
}

/// Ligand points whose RMSD makes clusters: CA atoms, or all where fewer than three residues have one.
fn cluster_points(ligand: &Molecule) -> Vec<[f64; 3]> {
    let alphas: Vec<[f64; 3]> = ligand
        .atoms
        .iter()
        .filter(|atom| atom.name == "CA" && atom.element == "C")
        .map(|atom| atom.position)
        .collect();
    if alphas.len() >= 3 {
        alphas
    } else {
        ligand.atoms.iter().map(|atom| atom.position).collect()
    }
}

/// The lowest rank of the lifted axis whose error at the best poses of a few probe rotations is within a third of the tolerance,
/// with the error measured there (relative to the best of them).
fn choose_rank(plan: &DockPlan, folded: &Folded<f32>) -> (CpuEngine<f32>, f64) {
    const PROBES: usize = 3;
    const BEST: usize = 50;
    let build = |rank| CpuEngine::new(plan.engine.clone(), folded, &plan.ligand, rank);
    let full = build(folded.full_rank());
    if folded.full_rank() == 1 {
        return (full, 0.0);
    }
    let mut work = full.workspace();
    let mut samples: Vec<(usize, Vec<(usize, f32)>)> = Vec::new();
    let mut best = f32::MIN_POSITIVE;
    for probe in 0..PROBES {
        let index = (2 * probe + 1) * plan.set.len() / (2 * PROBES);
        full.correlate(&plan.set[index], &mut work);
        let mut order: Vec<usize> = (0..work.grid.len()).collect();
        let count = BEST.min(order.len() - 1);
        order.select_nth_unstable_by(count, |&a, &b| {
            work.grid[b].total_cmp(&work.grid[a]).then(a.cmp(&b))
        });
        let values: Vec<(usize, f32)> = order[..count].iter().map(|&v| (v, work.grid[v])).collect();
        best = values.iter().fold(best, |best, value| best.max(value.1));
        samples.push((index, values));
    }
    for rank in 1..folded.full_rank() {
        let engine = build(rank);
        let mut work = engine.workspace();
        let mut error = 0.0f32;
        for (index, values) in &samples {
            engine.correlate(&plan.set[*index], &mut work);
            for &(voxel, exact) in values {
                error = error.max((work.grid[voxel] - exact).abs() / best);
            }
        }
        if f64::from(error) <= plan.options.tolerance / 3.0 {
            return (engine, f64::from(error));
        }
    }
    (full, 0.0)
}

/// The best peaks over all rotations, best first.
fn search(plan: &DockPlan, engine: &CpuEngine<f32>, progress: &dyn Progress) -> Vec<Peak> {
    let options = &plan.options;
    let next = AtomicUsize::new(0);
    let mut peaks: Vec<Peak> = (0..plan.in_flight)
        .into_par_iter()
        .with_max_len(1)
        .map(|_| {
            let mut work = engine.workspace();
            let mut found = Vec::with_capacity(2 * options.poses + options.per_rotation);
            loop {
                // Four rotations that differ by half-turns share the ligand's transform.
                let first = 4 * next.fetch_add(1, Ordering::Relaxed);
                let Some(rotation) = plan.set.get(first) else {
                    break;
                };
                engine.turn(rotation, &mut work);
                for (index, half_turn) in (first..plan.set.len()).zip(HalfTurn::ALL) {
                    engine.correlate_turned(half_turn, &mut work);
                    find_peaks(
                        plan.grid,
                        &mut work.grid,
                        &mut work.row_best,
                        index as u32,
                        options.per_rotation,
                        &mut found,
                    );
                    if found.len() >= 2 * options.poses {
                        found.sort_unstable_by(Peak::order);
                        found.truncate(options.poses);
                    }
                    progress.advance(1);
                }
            }
            found
        })
        .flatten()
        .collect();
    peaks.retain(|peak| peak.score.is_finite());
    peaks.sort_unstable_by(Peak::order);
    peaks.truncate(options.poses);
    peaks
}

/// The fast path's error at the best grid poses, relative to the best exact score.
fn measured(peaks: &[Peak], exact: &[ExactScore], best: f64) -> MeasuredError {
    let count = ERROR_POSES.min(exact.len());
    let (mut squares, mut worst, mut removed) = (0.0, 0.0f64, 0.0);
    for (peak, exact) in peaks[..count].iter().zip(exact) {
        let error = (f64::from(peak.score) - exact.score).abs() / best;
        squares += error * error;
        worst = worst.max(error);
        removed += (exact.score - exact.unfiltered).abs() / best;
    }
    MeasuredError {
        poses: count,
        rms: (squares / count.max(1) as f64).sqrt(),
        worst,
        low_pass_share: removed / count.max(1) as f64,
    }
}

/// Drops refined poses that ended where a better one did.
fn merge(rows: &mut Vec<RankedPose>, body: &RigidBody, distance: f64) {
    let poses: Vec<Pose> = rows
        .iter()
        .filter(|row| row.refined)
        .map(|row| row.pose)
        .collect();
    let groups = greedy(body, &poses, distance);
    let (mut index, mut seen) = (0, 0);
    rows.retain(|row| {
        if !row.refined {
            return true;
        }
        let founder = groups[index] == seen;
        index += 1;
        seen += usize::from(founder);
        founder
    });
}

/// Numbers clusters from 1 and fills in their sizes; returns how many there are.
fn number_clusters(rows: &mut [RankedPose], body: &RigidBody, radius: f64) -> usize {
    let poses: Vec<Pose> = rows.iter().map(|row| row.pose).collect();
    let clusters = greedy(body, &poses, radius);
    let count = clusters.iter().max().map_or(0, |last| last + 1);
    let mut sizes = vec![0; count];
    for &cluster in &clusters {
        sizes[cluster] += 1;
    }
    for (row, &cluster) in rows.iter_mut().zip(&clusters) {
        row.cluster = Some(cluster + 1);
        row.cluster_size = Some(sizes[cluster]);
    }
    count
}
