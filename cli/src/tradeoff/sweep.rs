//! Runs and measures each setting of a sweep ([`super::measured`]).

use rayon::prelude::*;

use crate::messages::console::Console;
use crate::tradeoff::measured::{
    FIRST, Measured, NativeRanks, Tradeoff, agreement, compare, front,
};
use crate::tradeoff::settings::{Parameter, Planned, Refused, Setting, settings};
use knotdock::dock::outcome::DockOutcome;
use knotdock::dock::pair::{Pair, PreparedPair, Preparer};
use knotdock::dock::plan::DockPlan;
use knotdock::dock::run::dock;
use knotdock::evaluate::{Criterion, Evaluator};
use knotdock::options::{DockOptions, Precision};
use knotdock::progress::Progress;
use knotdock::rank::cluster::RigidBody;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;

/// Sweeps `parameters` around `default`, which `first` is prepared with.
pub fn sweep(
    pair: Pair,
    first: PreparedPair,
    default: &DockOptions,
    parameters: &[Parameter],
    evaluator: Option<&Evaluator>,
    console: Console,
) -> Result<Tradeoff, Error> {
    let mut preparer = Preparer::new(pair, default, &first);
    let body = RigidBody::new(&first.points);
    let progress = console.progress();
    let mut refused: Vec<Refused> = Vec::new();
    let mut refuse = |left_out: Refused| {
        progress.clear();
        console.warn(format!(
            "{} is left out: {}",
            left_out.setting, left_out.reason
        ));
        refused.push(left_out);
    };
    let say = |text: String| {
        progress.clear();
        console.say(text);
    };
    let ready = ready(first, default, parameters, &mut preparer, &mut refuse)?;
    // Nothing is searched with it, so it needs no memory for that.
    let exact = preparer.prepare(&default.changed(|options| {
        let tolerance = &mut options.kernel.tolerance;
        *tolerance = tolerance.min(Precision::Single.finest_tolerance());
        options.machine.memory = None;
    }))?;
    let mut reference: Option<Reference> = None;
    let mut runs: Vec<Run> = Vec::new();
    for (index, (setting, prepared)) in ready.iter().enumerate() {
        say(format!("{}: {}", index + 1, setting.description()));
        let (measured, poses) = match run(setting, prepared, evaluator, &progress) {
            Ok(run) => run,
            Err(error) if setting.is_needed() => return Err(error),
            Err(error) => {
                refuse(Refused::new(&setting.name, error));
                continue;
            }
        };
        match setting.parameter {
            Parameter::Default => say(format!(
                "{} settings, in about {:.0} s all together",
                ready.len(),
                estimate(&measured, &ready)
            )),
            Parameter::Reference => {
                reference = Some(Reference {
                    scores: exact_scores(&exact.plan, &poses)?,
                    poses: poses.clone(),
                });
            }
            _ => {}
        }
        runs.push(Run {
            measured,
            poses,
            plan: &prepared.plan,
        });
        let Some(reference) = &reference else {
            continue;
        };
        // The default ran before there was a reference to compare it with.
        let new = if setting.parameter == Parameter::Reference {
            0
        } else {
            runs.len() - 1
        };
        for run in &mut runs[new..] {
            run.set_against(reference, &body, default.ranking.cluster_radius)?;
            let measured = &run.measured;
            say(format!(
                "   {}: {:.1} s, error {:.1e}, agreement {:.2}",
                measured.setting.name,
                measured.wall_seconds(),
                measured.error.rms,
                measured.agreement
            ));
        }
    }
    let mut measured: Vec<Measured> = runs.into_iter().map(|run| run.measured).collect();
    mark_fronts(&mut measured, default);
    Ok(Tradeoff {
        measured,
        refused,
        radius: default.ranking.cluster_radius,
        with_native: evaluator.is_some(),
    })
}

/// The settings that can be run, each prepared; the others go to `refuse`.
fn ready(
    first: PreparedPair,
    default: &DockOptions,
    parameters: &[Parameter],
    preparer: &mut Preparer,
    refuse: &mut dyn FnMut(Refused),
) -> Result<Vec<(Setting, PreparedPair)>, Error> {
    let planned = Planned {
        spacing: first.plan.spacing,
        refined: first.plan.refined(),
    };
    let (settings, out_of_range) = settings(default, planned, parameters)?;
    out_of_range.into_iter().for_each(&mut *refuse);
    let mut settings = settings.into_iter();
    let mut ready = Vec::new();
    ready.extend(settings.next().map(|default| (default, first)));
    for setting in settings {
        match preparer.prepare(&setting.options) {
            Ok(prepared) => ready.push((setting, prepared)),
            Err(error) if setting.parameter == Parameter::Reference => return Err(error),
            Err(error) => refuse(Refused::new(&setting.name, error)),
        }
    }
    Ok(ready)
}

/// What the reference ranks first, and the reference score of each.
struct Reference {
    poses: Vec<Pose>,
    scores: Vec<f64>,
}

/// A setting that has run, with its first poses.
struct Run<'a> {
    measured: Measured,
    poses: Vec<Pose>,
    plan: &'a DockPlan,
}

impl Run<'_> {
    fn set_against(
        &mut self,
        reference: &Reference,
        body: &RigidBody,
        radius: f64,
    ) -> Result<(), Error> {
        let scores = exact_scores(self.plan, &reference.poses)?;
        let compared = compare(&scores, &reference.scores);
        self.measured.definition_rms = compared.rms;
        self.measured.definition_correlation = compared.correlation;
        self.measured.agreement = agreement(body, &reference.poses, &self.poses, radius);
        Ok(())
    }
}

/// Runs a setting; what needs the reference is left at zero. With it the first poses of its table.
fn run(
    setting: &Setting,
    prepared: &PreparedPair,
    evaluator: Option<&Evaluator>,
    progress: &dyn Progress,
) -> Result<(Measured, Vec<Pose>), Error> {
    let plan = &prepared.plan;
    let outcome = dock(plan, &prepared.points, progress)?;
    if !outcome.error.worst.is_finite() {
        return Err(
            Error::input("no pose scores anything, so errors have no scale")
                .help("use a finer --spacing or --resolution"),
        );
    }
    let native = evaluator.map(|evaluator| native_ranks(evaluator, &outcome));
    let first = outcome.poses.iter().take(FIRST);
    let poses = first.map(|row| row.pose).collect();
    let mut timing = prepared.timing.clone();
    timing.extend(&outcome.timing);
    let measured = Measured {
        setting: setting.clone(),
        grid: plan.grid,
        spacing: plan.spacing,
        modes: plan.modes,
        rank: outcome.rank,
        spreading_width: plan.spreading_width,
        refined: plan.refined(),
        timing,
        error: outcome.error,
        definition_rms: 0.0,
        definition_correlation: None,
        agreement: 0.0,
        native,
        front_error: false,
        front_agreement: false,
    };
    Ok((measured, poses))
}

fn exact_scores(plan: &DockPlan, poses: &[Pose]) -> Result<Vec<f64>, Error> {
    let scorer = plan.exact_scorer()?;
    Ok(poses
        .par_iter()
        .map(|pose| scorer.score_only(pose))
        .collect())
}

fn native_ranks(evaluator: &Evaluator, outcome: &DockOutcome) -> NativeRanks {
    let poses = outcome.poses.par_iter();
    let qualities: Vec<_> = poses.map(|row| evaluator.evaluate(&row.pose)).collect();
    let met = |criterion: Criterion| {
        qualities
            .iter()
            .map(move |quality| criterion.is_met(quality))
    };
    let rank = |criterion| met(criterion).position(|met| met).map(|place| place + 1);
    let count = |criterion| met(criterion).take(FIRST).filter(|met| *met).count();
    NativeRanks {
        first_acceptable: rank(Criterion::Acceptable),
        first_near_native: rank(Criterion::NearNative),
        acceptable: count(Criterion::Acceptable),
        near_native: count(Criterion::NearNative),
    }
}

/// Estimated seconds of all settings by those of the default: transforms grow as the grid, exact sums stay.
fn estimate(default: &Measured, ready: &[(Setting, PreparedPair)]) -> f64 {
    let work = |plan: &DockPlan| {
        let points = plan.grid.iter().product::<usize>() as f64;
        points * points.log2()
    };
    let stage = |name: &str| {
        let of_name = default.timing.iter().filter(|stage| stage.name == name);
        of_name.map(|stage| stage.wall_seconds).sum::<f64>()
    };
    let (prepare, search) = (stage("prepare"), stage("search"));
    let rest = default.wall_seconds() - prepare - search;
    let Some((_, first)) = ready.first() else {
        return 0.0;
    };
    let seconds = ready.iter().map(|(_, prepared)| {
        let grid = work(&prepared.plan) / work(&first.plan);
        let rotations = prepared.plan.rotations as f64 / first.plan.rotations as f64;
        prepare * grid + search * grid * rotations + rest
    });
    seconds.sum()
}

/// Marks the fronts of time and error, among settings of the default's score, and of time and agreement. The reference
/// and repeats are on neither and beat nothing.
fn mark_fronts(measured: &mut [Measured], default: &DockOptions) {
    let other = |run: &Measured| run.setting.parameter.is_choice();
    let errors: Vec<(f64, Option<f64>)> = measured
        .iter()
        .map(|run| {
            let counts = other(run) && run.same_score(default);
            (run.cost(), counts.then_some(run.error.rms))
        })
        .collect();
    let losses: Vec<(f64, Option<f64>)> = measured
        .iter()
        .map(|run| (run.cost(), other(run).then_some(1.0 - run.agreement)))
        .collect();
    let fronts = front(&errors).into_iter().zip(front(&losses));
    for (run, (error, agreement)) in measured.iter_mut().zip(fronts) {
        run.front_error = error;
        run.front_agreement = agreement;
    }
}
