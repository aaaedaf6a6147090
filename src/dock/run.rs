//! The run: fold the receptor, scan the rotations, refine the best peaks, score exactly, merge, cluster, report.

use crate::dock::effect_timings::costs;
use crate::dock::outcome::{DockOutcome, MeasuredError, StageTime, error_scale};
use crate::dock::plan::DockPlan;
use crate::error::SearchError;
use crate::options::{Precision, Stopped};
use crate::pose_space::refine::{ClimbLimits, maximize, rigid_body};
use crate::progress::Progress;
use crate::rank::candidates::{RefinedPose, candidates, clusters_of, listed, merge, printed};
use crate::rank::cluster::RigidBody;
use crate::rank::ranking::{PoseScorer, cluster_temperature, report};
use crate::rank::time_left::poses_in_time;
use crate::search::chance::chance;
use crate::search::coarse_to_fine::search_finer;
use crate::search::peaks::Peak;
use crate::search::scan::{Chosen, Quartet, Scanned, choose_rank, scan};
use crate::search::scan_engine::ScanEngine;
use crate::search::schedule::{Deadline, schedule};
use cpu_time::ProcessTime;
use knotdock_scoring::effect::Effect;
use knotdock_scoring::engine::ReceptorSpectra;
use knotdock_scoring::exact::ExactScore;
use knotdock_scoring::lifted_axis::Quantity;
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::transform::Real;
use knotdock_structures::molecule::Molecule;
use rayon::prelude::*;
use std::time::Instant;

/// Grid poses over which the fast path's error is measured.
const ERROR_POSES: usize = 100;
/// Refined poses closer than this share of the grid spacing (ligand RMSD) are one.
const MERGE_SPACINGS: f64 = 0.25;

/// Most climbs that a thread takes at once.
const CLIMBS_TOGETHER: usize = 4;

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

/// Docks as planned. The RMSD of `points` of the ligand, in its own frame, makes clusters: [`molecule_points`] of a molecule, the centres of
/// the balls of a mesh.
///
/// # Errors
/// [`SearchError`] when threads cannot be had or no pose scores.
pub fn dock(
    plan: &DockPlan,
    points: &[[f64; 3]],
    progress: &dyn Progress,
) -> Result<DockOutcome, SearchError> {
    dock_until(plan, points, None, progress)
}

/// Docks as planned, with as many of the rotations as a deadline leaves time for, if there is one.
/// [`DockOutcome::stopped`] says how many those were: planned with it as [`DockOptions::stopped`] and docked without a
/// deadline, the outcome is the same. Graphics processors search all.
///
/// [`DockOptions::stopped`]: crate::options::DockOptions::stopped
///
/// # Errors
/// As [`dock`].
pub fn dock_until(
    plan: &DockPlan,
    points: &[[f64; 3]],
    deadline: Option<&Deadline>,
    progress: &dyn Progress,
) -> Result<DockOutcome, SearchError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(plan.in_flight)
        .build()
        .map_err(|error| SearchError::Threads(error.to_string()))?;
    pool.install(|| match plan.options.search.precision {
        Precision::Single => dock_in::<f32>(plan, points, deadline, progress),
        Precision::Double => dock_in::<f64>(plan, points, deadline, progress),
    })
}

/// The run with the fast path in a floating-point type.
fn dock_in<T: Real>(
    plan: &DockPlan,
    points: &[[f64; 3]],
    deadline: Option<&Deadline>,
    progress: &dyn Progress,
) -> Result<DockOutcome, SearchError> {
    let options = &plan.options;
    let mut clock = Clock::start();
    progress.stage("prepare", 1);
    let folded =
        ReceptorSpectra::<T>::new(&plan.engine, &plan.receptor, &plan.ligand, Quantity::Score);
    let Chosen {
        engine,
        error: rank_error,
    } = choose_rank(plan, &folded);
    let effects = costs(plan, &folded, &engine);
    let engine = ScanEngine::new(plan, engine)?;
    let scorer = plan.exact_scorer()?;
    progress.advance(1);
    clock.lap("prepare");

    let quartets = schedule(plan, deadline);
    let wanted: usize = quartets.iter().map(Quartet::count).sum();
    progress.stage("search", wanted as u64);
    let Scanned {
        mut peaks,
        rotations: searched,
    } = scan(
        plan,
        &engine,
        &quartets,
        options.search.poses,
        deadline,
        progress,
    )?;
    clock.lap("search");
    if peaks.is_empty() {
        return Err(SearchError::NoPose);
    }
    let mut fine = None;
    if !plan.fine_set.is_empty() {
        let (finer, searched) = search_finer(plan, &engine, peaks, progress)?;
        (peaks, fine) = (finer, Some(searched));
        clock.lap("fine");
    }
    let mut grid_poses: Vec<Pose> = peaks
        .iter()
        .map(|peak| {
            let (rotation, half_turn) = plan.rotation(peak.rotation as usize);
            let position = engine.cpu.position_after(half_turn, peak.voxel as usize);
            let place = plan.engine.receptor_center + position;
            Pose::about(rotation, plan.engine.ligand_center, place)
        })
        .collect();

    let body = match &plan.rings {
        Some(rings) => RigidBody::new(points).in_ring(rings.axis.as_ref()),
        None => RigidBody::new(points),
    };
    let mut placed = refine(plan, &folded, &peaks, &grid_poses, &body, progress);
    drop(folded);
    clock.lap("refine");

    grid_poses.truncate(ERROR_POSES);
    let checking = Instant::now();
    let at_grid: Vec<ExactScore> = grid_poses
        .par_iter()
        .map(|pose| scorer.score(&printed(pose)))
        .collect();
    let checked = checking.elapsed().as_secs_f64() / at_grid.len() as f64;
    clock.lap("check");

    let on = Effect::ALL.map(|effect| plan.is_on(effect));
    let rescorer = plan.rescorer();
    let found = peaks.len();
    let kept = match (deadline, options.stopped) {
        (_, Some(stopped)) => stopped.poses.min(found),
        (Some(deadline), None) => {
            let poses = (&peaks[..], &placed[..]);
            poses_in_time(deadline, poses, rescorer.as_ref(), checked, &body, options)
        }
        (None, None) => found,
    };
    let stopped = (searched < plan.rotations || kept < found).then_some(Stopped {
        rotations: searched,
        poses: kept,
    });
    peaks.truncate(kept);
    placed.truncate(kept);
    if rescorer.is_some() {
        progress.stage("rescore", 1);
    }
    // No ring starts on the grid.
    let at_start = match options.search.symmetry {
        Some(_) => &[][..],
        None => &at_grid[..],
    };
    let mut candidates = candidates(&peaks, &placed, at_start, rescorer.as_ref());
    if rescorer.is_some() {
        progress.advance(1);
    }
    clock.lap("rescore");
    merge(&mut candidates, &body, MERGE_SPACINGS * plan.spacing);
    let kept = candidates.len();
    let clusters = clusters_of(&candidates, &body, options.ranking.cluster_radius);
    // Closer than neighbouring samples of the search are to each other, poses are one place to it.
    let step = body.step(plan.spacing, ligand_turn(plan));
    let listed = listed(&candidates, &clusters, &body, step);
    clock.lap("cluster");

    let best_peak = peaks.first().map_or(0.0, |peak| peak.score);
    let judge = PoseScorer {
        scorer: &scorer,
        rescorer: rescorer.as_ref(),
        on,
        symmetry: options.search.symmetry,
        cluster_temperature: cluster_temperature(plan.unit),
    };
    let ranking = report(
        judge,
        &candidates,
        (&clusters, &listed),
        options.ranking.no_cluster,
        2.0 * options.kernel.tolerance * best_peak.abs(),
        progress,
    );
    // Rows stand for clusters by their pose scores; the best score may be another pose's.
    let at_start = at_start.iter().map(|exact| exact.score);
    let scores = ranking.poses.iter().map(|row| row.score).chain(at_start);
    let best = error_scale(scores, 0.0);
    let error = MeasuredError::over(&peaks, &at_grid, best);
    clock.lap("score");

    Ok(DockOutcome {
        poses: ranking.poses,
        poses_kept: kept,
        clusters: ranking.clusters,
        chance: chance(options, on, ranking.clusters).filter(|_| stopped.is_none()),
        searched,
        stopped,
        error,
        rank_error,
        rank: engine.cpu.rank(),
        effects,
        fine,
        timing: clock.stages,
        adapter: engine.adapter,
    })
}

/// Angle in radians between neighbouring rotations of the search: the set's covering radius. Of rings that is of axes, and a copy turns by up to twice as much
/// as its axis.
fn ligand_turn(plan: &DockPlan) -> f64 {
    let turns = if plan.options.search.symmetry.is_some() {
        2.0
    } else {
        1.0
    };
    turns * plan.covering_radius_degrees.to_radians()
}

/// Climbs from the best grid poses, of rings from the ring nearest to each. Poses are given as they are printed, and so scored: a quaternion's digits
/// survive the table's round trip.
fn refine<T: Real>(
    plan: &DockPlan,
    folded: &ReceptorSpectra<T>,
    peaks: &[Peak],
    grid_poses: &[Pose],
    body: &RigidBody,
    progress: &dyn Progress,
) -> Vec<RefinedPose> {
    let count = plan.refined().min(peaks.len());
    progress.stage("refine", count as u64);
    let field = (count > 0).then(|| PotentialGrid::new(&plan.engine, folded, &plan.ligand));
    let limits = ClimbLimits {
        evaluations: 40,
        distance: 3.0 * plan.spacing,
        angle: ligand_turn(plan),
        gyration: body.gyration(),
        angstrom: plan.angstrom,
    };
    let center = plan.engine.ligand_center;
    let place = |(index, (peak, pose)): (usize, (&Peak, &Pose))| {
        let Some(field) = field.as_ref().filter(|_| index < count) else {
            return RefinedPose::best_of((printed(pose), peak.score), None);
        };
        let placed = match &plan.rings {
            Some(rings) => {
                let (top, score) = rings.maximize(field, center, pose, &limits);
                RefinedPose {
                    start: printed(&rings.nearest(pose)),
                    pose: printed(&top),
                    score,
                    refined: true,
                }
            }
            None => {
                let gradient = |pose: &Pose| field.gradient(pose);
                let (top, score) = maximize(*pose, center, &limits, gradient, rigid_body(center));
                RefinedPose::best_of((printed(pose), peak.score), Some((printed(&top), score)))
            }
        };
        progress.advance(1);
        placed
    };
    // Those that are refined come first, so long shares would leave some threads without any.
    let places = peaks.par_iter().zip(grid_poses).enumerate();
    places.with_max_len(CLIMBS_TOGETHER).map(place).collect()
}

/// Points of a molecule whose RMSD makes clusters, in Å: CA atoms, or all where fewer than three residues have one.
pub fn molecule_points(ligand: &Molecule) -> Vec<[f64; 3]> {
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
