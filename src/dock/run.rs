//! The run: prepare, scan the rotations, refine the best peaks, check the fast path, rescore, cluster, score exactly.

use crate::dock::effect_costs::{components_by_effect, effect_costs, rank_of};
use crate::dock::outcome::{DockOutcome, MeasuredError, SharpOutcome, StageTime, error_scale};
use crate::dock::plan::DockPlan;
use crate::dock::stopwatch::Stopwatch;
use crate::error::no_pose;
use crate::options::Stopped;
use crate::pose_space::refine::{AscentLimits, RefinedPose, printed};
use crate::pose_space::rotations::RotationGroup;
use crate::progress::{NoProgress, Progress};
use crate::rank::candidates::{Candidate, candidates, clusters_of, deduplicated, merge};
use crate::rank::cluster::{RigidBody, figures};
use crate::rank::ranking::{PoseScorer, Ranking, report};
use crate::rank::sharp::{optima, settle};
use crate::rank::time_left::{poses_in_time, rescoring_seconds};
use crate::search::coarse_to_fine::{FineSearched, search_finer};
use crate::search::deadline::{Deadline, left};
use crate::search::scan::{Scanned, scan};
use crate::search::scan_engine::{Adapter, ScanEngine};
use crate::search::schedule::schedule;
use crate::threads;
use knotdock_scoring::engine::{ChosenRank, ReceptorSpectra};
use knotdock_scoring::exact::ScoreTerms;
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::peaks::Peak;
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::Rescorer;
use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;
use rayon::prelude::*;
use std::time::Instant;

/// Grid poses over which the fast path's error is measured.
const ERROR_POSES: usize = 100;
/// Refined poses closer than this share of the grid spacing (ligand RMSD) are one.
const MERGE_SPACINGS: f64 = 0.25;
/// Poses that a thread refines at once.
const REFINED_TOGETHER: usize = 4;

/// Docks as planned. Clusters are formed by the RMSD of `points` of the ligand in its own frame: [`molecule_points`]
/// of a molecule, the centres of the balls of a mesh.
///
/// Runs on [`DockPlan::in_flight`] threads: those of the caller's rayon pool if it has that many, else a new pool, and
/// never the global pool ([`threads::on`]). Planning and sampling run in the caller's pool.
///
/// # Errors
/// [`Error`] when threads cannot be had or no pose scores.
pub fn dock(
    plan: &DockPlan,
    points: &[[f64; 3]],
    progress: &dyn Progress,
) -> Result<DockOutcome, Error> {
    dock_until(plan, points, None, progress)
}

/// Docks as planned, with as many of the rotations as there is time for if the run must end at `deadline`.
///
/// The search stops when the time left is that of the rest of the run, by the time that poses and rotations were measured
/// to take. [`DockOutcome::stopped`] says how many rotations that were. A run planned with it as [`DockOptions::stopped`] and docked
/// without a deadline has the same outcome. Graphics processors search all rotations.
///
/// [`DockOptions::stopped`]: crate::options::DockOptions::stopped
///
/// # Errors
/// As [`dock`].
pub fn dock_until(
    plan: &DockPlan,
    points: &[[f64; 3]],
    deadline: Option<Instant>,
    progress: &dyn Progress,
) -> Result<DockOutcome, Error> {
    threads::on(plan.in_flight(), || {
        let mut searched = Searched::new(plan, points, deadline, progress)?;
        searched.refine(usize::MAX, progress)?;
        searched.ranked(deadline, progress)
    })?
}

/// A run after its search: poses that are not yet ranked.
pub(super) struct Searched<'a> {
    plan: &'a DockPlan,
    scorer: ExactSum,
    rescorer: Option<Rescorer>,
    body: RigidBody,
    found: SearchResult,
    /// Poses of the peaks.
    grid_poses: Vec<Pose>,
    /// What refines them; `None` if none is refined.
    field: Option<PotentialGrid>,
    /// The first poses, refined.
    refined: Vec<RefinedPose>,
    rank: usize,
    rank_error: f64,
    components: [f64; Effect::ALL.len()],
    adapter: Option<Adapter>,
    adapter_failure: Option<String>,
    clock: Stopwatch,
}

impl<'a> Searched<'a> {
    /// Searches, on the threads of the current pool.
    pub fn new(
        plan: &'a DockPlan,
        points: &[[f64; 3]],
        deadline: Option<Instant>,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let mut clock = Stopwatch::start();
        let (prepared, rescorer) =
            rayon::join(|| Prepared::new(plan, progress), || plan.rescorer());
        let Prepared {
            spectra,
            engine,
            scorer,
            rank_error,
            components,
        } = prepared?;
        let body = RigidBody::new(points).with_equivalents(plan.search.space.equivalents());
        let scorers = (&scorer, rescorer.as_ref());
        let search_end = deadline.map(|end| search_deadline(plan, &engine, end, scorers, &body));
        let search_end = search_end.transpose()?;
        // The rotations that are searched to measure are no part of the search's time.
        clock.lap("prepare");
        let found = find(plan, &engine, search_end.as_ref(), (progress, &mut clock))?;
        let grid_pose = |peak| engine.grid_pose(&plan.search, peak);
        let grid_poses: Vec<Pose> = found.peaks.iter().map(grid_pose).collect();
        // The engine goes before the potentials come, which may take ten times its memory.
        let rank = engine.cpu.rank();
        let (adapter, adapter_failure) = (engine.adapter(), engine.failure());
        drop(engine);
        let field =
            spectra.map(|spectra| PotentialGrid::new(&plan.search.engine, &spectra, &plan.ligand));
        Ok(Self {
            plan,
            scorer,
            rescorer,
            body,
            found,
            grid_poses,
            field,
            refined: Vec::new(),
            rank,
            rank_error,
            components,
            adapter,
            adapter_failure,
            clock,
        })
    }

    /// Refines the first `count` poses, or as many as the plan does, but for those that are refined already.
    pub fn refine(&mut self, count: usize, progress: &dyn Progress) -> Result<(), Error> {
        let (done, end) = (self.refined.len(), count.min(self.grid_poses.len()));
        let poses = (&self.found.peaks[done..end], &self.grid_poses[done..end]);
        let wanted = self.plan.refined().saturating_sub(done);
        let field = self.field.as_ref();
        let refined = refine(self.plan, field, (poses, wanted), &self.body, progress);
        self.refined.extend(refined);
        self.clock.lap("refine");
        Ok(progress.go_on()?)
    }

    /// The best refined pose by the fast path.
    pub fn best(&self) -> Option<&Pose> {
        let poses = self.refined.iter();
        let best = poses.max_by(|a, b| a.score.total_cmp(&b.score));
        best.map(|refined| &refined.pose)
    }

    /// Leaves the time since the search out of the stages.
    pub fn resume(&mut self) {
        self.clock.resume();
    }

    /// The stages so far.
    pub fn into_stages(self) -> Vec<StageTime> {
        self.clock.into_stages()
    }

    /// Checks the fast path, rescores, clusters and scores exactly, once all poses went through [`Self::refine`].
    pub fn ranked(
        self,
        deadline: Option<Instant>,
        progress: &dyn Progress,
    ) -> Result<DockOutcome, Error> {
        let Self {
            plan,
            scorer,
            rescorer,
            body,
            mut found,
            mut grid_poses,
            field,
            refined,
            rank,
            rank_error,
            components,
            adapter,
            adapter_failure,
            mut clock,
        } = self;
        let scorers = (&scorer, rescorer.as_ref());
        drop(field);
        grid_poses.truncate(ERROR_POSES);
        grid_poses.shrink_to_fit();
        let check = Check::new(&scorer, &grid_poses);
        clock.lap("check");

        let poses = (&found.peaks[..], &refined[..]);
        let kept = kept(plan, deadline, poses, rescorer.as_ref(), (&check, &body));
        let stopped = found.stopped(plan, kept);
        let poses = (&found.peaks[..kept], &refined[..kept]);
        let mut candidates = rescore(plan, poses, &check, rescorer.as_ref(), progress);
        progress.go_on()?;
        drop(refined);
        found.peaks.truncate(ERROR_POSES);
        found.peaks.shrink_to_fit();
        clock.lap("rescore");
        let sharp = sharpen(plan, &mut candidates, &body, scorers, progress);
        if sharp.is_some() {
            clock.lap("sharp");
        }
        progress.go_on()?;
        merge(&mut candidates, &body, MERGE_SPACINGS * plan.spacing);
        let clusters = clusters_of(&candidates, &body, plan.options.ranking.cluster_radius);
        // Poses closer than neighbouring samples of the search are one place to it.
        let step = body.step(plan.spacing, plan.search.rotation_step());
        let distinct = deduplicated(&candidates, &clusters, &body, step);
        clock.lap("cluster");

        let best_peak = found.peaks.first().map_or(0.0, |peak| peak.score);
        let on = Effect::ALL.map(|effect| plan.is_on(effect));
        let pose_scorer = PoseScorer {
            scorer: &scorer,
            rescorer: rescorer.as_ref(),
            on,
            space: &plan.search.space,
            cluster_temperature: plan.unit.cluster_temperature(),
            diagnostics: plan.options.output.diagnostics,
        };
        let ranking = report(
            pose_scorer,
            &candidates,
            (&clusters, &distinct),
            plan.row_choice(2.0 * plan.options.kernel.tolerance * best_peak.abs()),
            progress,
        );
        let scored = |place: usize| (candidates[place].pose, candidates[place].score);
        let figures = figures(&body, scored, &clusters, &ranking.clusters);
        let error = check.error(plan, &found.peaks, &ranking);
        clock.lap("score");
        let timing = clock.into_stages();
        let searched = (found.searched, adapter.is_some());

        Ok(DockOutcome {
            poses: ranking.poses,
            poses_kept: candidates.len(),
            clusters: figures,
            searched: found.searched,
            stopped,
            error,
            rank_error,
            rank,
            effects: effect_costs(plan, &components, searched, &timing),
            sharp,
            fine: found.fine,
            timing,
            adapter,
            adapter_failure,
        })
    }
}

/// Prepared engine, spectra and scorer of a run.
struct Prepared {
    /// The receptor's spectra, if poses are refined.
    spectra: Option<ReceptorSpectra>,
    engine: ScanEngine,
    scorer: ExactSum,
    /// Error of the compressed components at the probe rotations, relative to their best score.
    rank_error: f64,
    /// Components of the engine by effect.
    components: [f64; Effect::ALL.len()],
}

impl Prepared {
    /// Transforms the receptor and chooses the rank.
    fn new(plan: &DockPlan, progress: &dyn Progress) -> Result<Self, Error> {
        progress.stage("prepare", 1);
        let chosen = || {
            let spectra = ReceptorSpectra::new(
                &plan.search.engine,
                &plan.receptor,
                &plan.ligand,
                Quantity::Score,
                plan.options.search.precision.into(),
            );
            let chosen = rank_of(plan, &spectra);
            (spectra, chosen)
        };
        let ((spectra, chosen), scorer) = rayon::join(chosen, || plan.exact_scorer());
        let ChosenRank {
            engine,
            error: rank_error,
            shares,
        } = chosen;
        let components = components_by_effect(&spectra, &shares);
        let in_flight = plan.memory.in_flight_at(engine.rank());
        let mut scan_engine = ScanEngine::new(&plan.search, engine)?;
        scan_engine.in_flight = in_flight;
        let prepared = Self {
            engine: scan_engine,
            spectra: (plan.refined() > 0).then_some(spectra),
            scorer: scorer?,
            rank_error,
            components,
        };
        progress.advance(1);
        Ok(prepared)
    }
}

/// Peaks of a search, with its coverage and errors.
struct SearchResult {
    /// The best peaks, best first.
    peaks: Vec<Peak>,
    /// Rotations of the set that were searched.
    searched: usize,
    /// Coverage of a finer search.
    fine: Option<FineSearched>,
}

impl SearchResult {
    /// Place where the run stopped before its end, if it did: `kept` poses are carried on.
    fn stopped(&self, plan: &DockPlan, kept: usize) -> Option<Stopped> {
        (self.searched < plan.rotations || kept < self.peaks.len()).then_some(Stopped {
            rotations: self.searched,
            poses: kept,
        })
    }
}

/// Groups of rotations searched to measure the time of their poses after the search.
const PROBED: usize = 4;
/// Time of refining a pose in exact sums. As timed on the example pair (`--effects shape --refine 300`: 1.4 ms against
/// 0.8 ms).
const REFINING: f64 = 2.0;

/// The deadline of the search of a run that must end at `end`, by the time that poses of a few rotations take. Any pose
/// may be a row, and in short searches nearly all are.
fn search_deadline(
    plan: &DockPlan,
    engine: &ScanEngine,
    end: Instant,
    (scorer, rescorer): (&ExactSum, Option<&Rescorer>),
    body: &RigidBody,
) -> Result<Deadline, Error> {
    let search = &plan.search;
    let mut groups = schedule(search, true);
    groups.truncate(PROBED);
    let mut peaks = scan(search, engine, &groups, search.kept, None, &NoProgress)?.peaks;
    peaks.truncate(ERROR_POSES);
    let grid_poses = peaks.iter().map(|peak| engine.grid_pose(search, peak));
    let grid_poses: Vec<Pose> = grid_poses.collect();
    let placed = refine(plan, None, ((&peaks, &grid_poses), 0), body, &NoProgress);
    let rescoring = rescoring_seconds((&peaks, &placed), rescorer);
    let exact = match &grid_poses[..] {
        [] => 0.0,
        poses => Check::new(scorer, poses).seconds,
    };
    let refined = plan.refined().min(search.kept) as f64 / search.kept as f64;
    let options = &plan.options.search;
    let finer = options.fine_rotations.unwrap_or(0);
    Ok(Deadline {
        end,
        pose: rescoring + (1.0 + REFINING * refined) * exact,
        per_rotation: search.per_rotation,
        poses: search.kept,
        finer: options.fine_share * finer as f64,
    })
}

/// Searches the rotations, then the finer ones if the plan has any.
fn find(
    plan: &DockPlan,
    engine: &ScanEngine,
    deadline: Option<&Deadline>,
    (progress, clock): (&dyn Progress, &mut Stopwatch),
) -> Result<SearchResult, Error> {
    let search = &plan.search;
    let groups = schedule(search, deadline.is_some());
    let wanted: usize = groups.iter().map(RotationGroup::count).sum();
    progress.stage("search", wanted as u64);
    // Finer rotations are about as many of the best as their share takes, however few poses are kept.
    let kept = match search.rotations.fine.is_empty() {
        true => search.kept,
        false => usize::MAX,
    };
    let Scanned {
        mut peaks,
        rotations: searched,
    } = scan(search, engine, &groups, kept, deadline, progress)?;
    clock.lap("search");
    if peaks.is_empty() {
        let restraints = &plan.restraints.distances;
        return Err(if !restraints.list.is_empty() {
            Error::input(format!(
                "no pose that is searched can satisfy {} of the {} restraints",
                restraints.needed,
                restraints.list.len()
            ))
            .help(
                "accept fewer with --restraints-need, raise upper bounds, or check chains and numbers of residues",
            )
        } else if plan.restraints.membrane.is_some() {
            Error::input("every pose that is searched lies in the membrane")
                .help("check that the molecule that has the membrane reaches out of it")
        } else {
            no_pose()
        });
    }
    let mut fine = None;
    if !search.rotations.fine.is_empty() {
        let (finer, searched) = search_finer(search, engine, peaks, progress)?;
        (peaks, fine) = (finer, Some(searched));
        clock.lap("fine");
    }
    Ok(SearchResult {
        peaks,
        searched,
        fine,
    })
}

/// Refines the first `count` poses. Poses are rounded to their printed digits before they are scored, so that
/// the table's rows give back the same scores.
fn refine(
    plan: &DockPlan,
    field: Option<&PotentialGrid>,
    ((peaks, grid_poses), count): ((&[Peak], &[Pose]), usize),
    body: &RigidBody,
    progress: &dyn Progress,
) -> Vec<RefinedPose> {
    let count = count.min(peaks.len());
    progress.stage("refine", count as u64);
    let engine = &plan.search.engine;
    let limits = AscentLimits {
        evaluations: 40,
        distance: 3.0 * plan.spacing,
        angle: plan.search.rotation_step(),
        gyration: body.gyration(),
        angstrom: plan.angstrom,
    };
    let refined = |(index, (peak, pose)): (usize, (&Peak, &Pose))| {
        let grid = (pose, peak.score);
        let is_wanted = index < count && progress.go_on().is_ok();
        let Some(field) = field.filter(|_| is_wanted) else {
            return RefinedPose::best_of((printed(pose), peak.score), None);
        };
        let center = engine.ligand_center();
        let refined = plan.search.space.refined(field, center, grid, &limits);
        progress.advance(1);
        refined
    };
    // Those that are refined come first, so long shares would leave some threads without any.
    let poses = peaks.par_iter().zip(grid_poses).enumerate();
    poses.with_max_len(REFINED_TOGETHER).map(refined).collect()
}

/// Exact scores of the best grid poses, which the fast path is checked against.
struct Check {
    at_grid: Vec<ScoreTerms>,
    /// Their unfiltered scores.
    unfiltered: Vec<f64>,
    /// Seconds that one took.
    seconds: f64,
}

impl Check {
    fn new(scorer: &ExactSum, grid_poses: &[Pose]) -> Self {
        let started = Instant::now();
        let poses: Vec<Pose> = grid_poses.iter().map(printed).collect();
        let at_grid: Vec<ScoreTerms> = poses.par_iter().map(|pose| scorer.terms(pose)).collect();
        let seconds = started.elapsed().as_secs_f64() / at_grid.len() as f64;
        let unfiltered = poses.par_iter().map(|pose| scorer.unfiltered(pose));
        Self {
            unfiltered: unfiltered.collect(),
            at_grid,
            seconds,
        }
    }

    /// The exact scores of poses that are candidates unrefined; none for rings, since no ring is on the grid.
    fn at_start(&self, plan: &DockPlan) -> &[ScoreTerms] {
        if plan.search.space.is_on_grid() {
            &self.at_grid
        } else {
            &[]
        }
    }

    /// The fast path's error, relative to the best exact score.
    fn error(&self, plan: &DockPlan, peaks: &[Peak], ranking: &Ranking) -> MeasuredError {
        // Rows stand for clusters by their pose scores; the best score may be another pose's.
        let at_start = self.at_start(plan).iter().map(|exact| exact.score);
        let rows = ranking.poses.iter().filter_map(|row| row.search_score);
        let best = error_scale(rows.chain(at_start), 0.0);
        MeasuredError::over(peaks, (&self.at_grid, &self.unfiltered), best)
    }
}

/// Number of poses that are carried on: all, or as many as there is time for, or as the run had that is repeated.
fn kept(
    plan: &DockPlan,
    deadline: Option<Instant>,
    (peaks, refined): (&[Peak], &[RefinedPose]),
    rescorer: Option<&Rescorer>,
    (check, body): (&Check, &RigidBody),
) -> usize {
    match (deadline, plan.options.stopped) {
        (_, Some(stopped)) => stopped.poses.min(peaks.len()),
        (Some(deadline), None) => {
            let (poses, seconds) = ((peaks, refined), check.seconds);
            poses_in_time(
                left(deadline),
                poses,
                rescorer,
                seconds,
                body,
                &plan.options,
            )
        }
        (None, None) => peaks.len(),
    }
}

/// The poses with their further terms, best first.
fn rescore(
    plan: &DockPlan,
    (peaks, refined): (&[Peak], &[RefinedPose]),
    check: &Check,
    rescorer: Option<&Rescorer>,
    progress: &dyn Progress,
) -> Vec<Candidate> {
    if rescorer.is_some() {
        progress.stage("rescore", 1);
    }
    let candidates = candidates(peaks, refined, check.at_start(plan), rescorer);
    if rescorer.is_some() {
        progress.advance(1);
    }
    candidates
}

/// Fits the best candidates at atomic resolution, and ranks by these fits if one is far ahead; `None` if sharp fits
/// are off.
fn sharpen(
    plan: &DockPlan,
    candidates: &mut [Candidate],
    body: &RigidBody,
    scorers: (&ExactSum, Option<&Rescorer>),
    progress: &dyn Progress,
) -> Option<SharpOutcome> {
    let inputs = plan.sharp_inputs()?;
    progress.stage("sharp", 1);
    let optima = optima(
        &inputs,
        candidates,
        body,
        plan.rotations,
        plan.options.ranking.sharp,
    );
    let finding = settle(candidates, &optima, plan.options.ranking.sharp, scorers);
    progress.advance(1);
    Some(SharpOutcome {
        finding,
        evidence: optima.evidence,
        margin: optima.evidence.map(|evidence| evidence.margin()),
        poses: optima.of_candidates.iter().flatten().count(),
    })
}

/// Points of a molecule whose RMSD makes clusters, in Å: CA atoms, or all if fewer than three residues have one.
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

#[cfg(test)]
#[cfg(feature = "gpu")]
mod tests {
    use super::*;
    use crate::dock::plan::plan;
    use crate::options::{DockOptions, EngineChoice};
    use crate::priors::residue_roles::tests::peptide;
    use crate::search::plan::SearchPlan;
    use std::sync::atomic::{AtomicU64, Ordering};

    /// Counts rotations, and loses the card as the first are done.
    struct LosesCard<'a> {
        engine: &'a ScanEngine,
        counted: AtomicU64,
    }

    impl Progress for LosesCard<'_> {
        fn advance(&self, by: u64) {
            self.counted.fetch_add(by, Ordering::Relaxed);
            self.engine.gpu.as_ref().unwrap().lose_device();
        }
    }

    /// A card that is lost amid a search: with `auto` the cores search all rotations, and each counts once; with `gpu` it is
    /// an error, and so is the next search.
    #[test]
    fn cores_take_over_from_a_card_that_is_lost() {
        let options = DockOptions::default().changed(|options| {
            options.search.engine = EngineChoice::Gpu;
            options.search.rotations = 48;
            options.machine.threads = 1.into();
        });
        let mut plan = plan(&peptide(0.0), &peptide(4.0), &options).unwrap();
        if let Err(error) = Prepared::new(&plan, &NoProgress) {
            let needed = std::env::var_os("KNOTDOCK_NEEDS_GPU").is_some();
            assert!(!needed, "{error}");
            println!("not tried: {error}");
            return;
        }
        // Small batches, so that there are some after the first.
        plan.search.graphics_bytes = 1 << 16;
        while Prepared::new(&plan, &NoProgress).is_err() {
            plan.search.graphics_bytes *= 2;
        }
        let prepared = |plan: &DockPlan| Prepared::new(plan, &NoProgress).unwrap().engine;
        let groups = plan.search.rotations.groups();
        let by = |search: &SearchPlan, engine: &ScanEngine, progress: &dyn Progress| {
            scan(search, engine, &groups, 20, None, progress)
        };
        let losing = |engine| LosesCard {
            engine,
            counted: AtomicU64::new(0),
        };

        let engine = prepared(&plan);
        let in_flight = engine.adapter().unwrap().rotations_in_flight;
        assert!(in_flight <= 24, "{in_flight}");
        assert!(by(&plan.search, &engine, &NoProgress).is_ok());
        for progress in [&losing(&engine) as &dyn Progress, &NoProgress] {
            let error = by(&plan.search, &engine, progress).err().unwrap();
            assert!(error.to_string().contains("--engine gpu"), "{error}");
            assert!(engine.failure().is_none());
        }

        let engine = prepared(&plan);
        plan.search.device = EngineChoice::Auto;
        let progress = losing(&engine);
        let taken_over = by(&plan.search, &engine, &progress).unwrap();
        assert!(engine.failure().is_some() && engine.adapter().is_none());
        assert_eq!(progress.counted.into_inner(), 48);
        plan.search.device = EngineChoice::Cpu;
        let alone = by(&plan.search, &prepared(&plan), &NoProgress).unwrap();
        assert_eq!(taken_over.rotations, alone.rotations);
        assert_eq!(taken_over.peaks, alone.peaks);
        assert!(!alone.peaks.is_empty());
    }
}
