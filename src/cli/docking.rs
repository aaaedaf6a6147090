//! A docking run: planned, described, carried out and written.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use knotdock::dock::memory::process;
use knotdock::dock::outcome::DockOutcome;
use knotdock::dock::pair::{PreparedPair, Preparer};
use knotdock::dock::run::dock_until;
use knotdock::error::SearchError;
use knotdock::evaluate::Evaluator;
use knotdock::options::{Precision, SharpChoice};
use knotdock::output::files::seal::REPORT;
use knotdock::output::files::staging::Staging;
use knotdock::output::files::viewers::{
    CHIMERAX, PYMOL, ViewedComplex, write_chimerax, write_pymol,
};
use knotdock::output::records::manifest::{
    EffectTime, Machine, Manifest, ManifestParts, Results, Timing,
};
use knotdock::output::records::recorded_run::RecordedRun;
use knotdock::output::tables::fields::Column;
use knotdock::output::tables::interface_shares::{INTERFACE, write_shares};
use knotdock::output::tables::quality;
use knotdock::output::tables::report::{BEST, best_clusters, counted, firsts};
use knotdock::output::tables::restraints;
use knotdock::output::tables::run_table::{RunTable, pose_rows};
use knotdock::report::{MAX_ROWS, RunReport, Viewer};
use knotdock::search::deadline::Deadline;
use knotdock::tradeoff::choice::{Chosen, Wanted, choose, deadline};
use knotdock::tradeoff::cost_model::{CostModel, Workload};
use serde_json::{Value, json};

use crate::cli::arguments::machine::machine;
use crate::cli::arguments::native::{NativeFiles, announce, measure};
use crate::cli::calibrate::cost_model;
use crate::cli::inputs::request::Request;
use crate::cli::messages::console::Console;
use crate::cli::messages::dock::{
    assumed, error_warning, few_rotations_warning, known_text, outcome_text, regions_text,
};
use crate::cli::messages::failure::Failure;
use crate::cli::messages::set_aside::{finish_before_reading, warn_set_aside};
use crate::cli::messages::timings::timings_text;

/// A run that is ready to go.
pub struct Docking {
    request: Request,
    directory: PathBuf,
    /// Whether another run there is replaced.
    force: bool,
    evaluator: Option<Evaluator>,
    prepared: PreparedPair,
    chosen: Option<Chosen>,
    /// Where the run has a budget.
    deadline: Option<Deadline>,
    clock: Clock,
}

impl Docking {
    /// Plans the requested run. It is written into `directory`, and replaces a run there only if `force` is true.
    pub fn prepare(
        mut request: Request,
        wanted: Wanted,
        (directory, force): (PathBuf, bool),
        clock: Clock,
        console: Console,
    ) -> Result<Self, Failure> {
        let arrangement = request.arrangement();
        if !arrangement.is_ring() {
            request.bodies.note_shared_chains();
        }
        request.bodies.describe(arrangement, console);
        let evaluator = request.evaluator()?;
        if let Some(evaluator) = &evaluator {
            announce(evaluator, console);
        }
        let (prepared, chosen, deadline) = if wanted == Wanted::default() {
            (request.plan(console)?, None, None)
        } else {
            let (model, source) = cost_model(console);
            let (prepared, chosen) = plan_within(wanted, (&model, &source), &mut request, console)?;
            let end = wanted
                .budget
                .and_then(|budget| Duration::try_from_secs_f64(budget).ok())
                .and_then(|budget| clock.monotonic.checked_add(budget));
            let deadline = end.map(|end| deadline(&model, &prepared.plan, end));
            (prepared, Some(chosen), deadline)
        };
        let plan = &prepared.plan;
        console.say(format!("\n{plan}"));
        let sides = arrangement.sides();
        for (side, count) in sides.iter().zip(plan.unresolved()) {
            if count > 0 {
                console.warn(format!(
                    "{count} balls of the {side} are too small for a resolution of {} {}, which leaves less than a tenth of their overlap",
                    request.options.kernel.resolution, plan.unit
                ));
            }
        }
        for text in known_text(sides, &plan.restraints) {
            console.say(text);
        }
        for text in regions_text(sides, &plan.regions) {
            console.say(text);
        }
        for (side, labels) in sides.iter().zip(&plan.labels) {
            if let Some(text) = assumed(side, labels, plan) {
                console.say(text);
            }
        }
        Ok(Self {
            request,
            directory,
            force,
            evaluator,
            prepared,
            chosen,
            deadline,
            clock,
        })
    }

    /// Memory that the run is expected to take, in bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.prepared.plan.memory_bytes()
    }

    /// Seconds that the search is expected to take on this machine.
    pub fn expected_seconds(&self, model: &CostModel) -> f64 {
        let plan = &self.prepared.plan;
        model.seconds(&Workload::of(plan), plan.rotations, plan.in_flight())
    }

    /// The directory of the run, if it holds another run that is not to be replaced.
    pub fn in_the_way(&self) -> Option<&Path> {
        let run = !self.force && self.directory.join("run.json").exists();
        run.then_some(self.directory.as_path())
    }

    /// Whether the directory holds this very run already: of this program, with inputs of the same content and the
    /// same options.
    pub fn is_done(&self, console: Console) -> bool {
        if finish_before_reading(&self.directory, console).is_err() {
            return false;
        }
        let Ok(run) = RecordedRun::read(&self.directory.join("run.json")) else {
            return false;
        };
        let native = self.request.native.as_ref().map(NativeFiles::record);
        let mut options = self.request.options.clone();
        if self.deadline.is_some() {
            // Where that run stopped is what this one's time would say.
            options.stopped = run.options.stopped;
        }
        let inputs = self.request.bodies.records();
        self.directory.join("poses.csv").is_file()
            && run.is_of_this_program()
            && run.is_same_request(inputs, native.as_ref(), &options)
    }

    /// Docks, and writes the run; its JSON object. What became of files of the user's is said on `notices`, for a batch
    /// says that and nothing else of its pairs.
    pub fn run(mut self, console: Console, notices: Console) -> Result<Value, Failure> {
        let staging = Staging::open(&self.directory, self.force)?;
        let progress = console.progress();
        let PreparedPair { plan, points, .. } = &self.prepared;
        let outcome = dock_until(plan, points, self.deadline.as_ref(), &progress).map_err(
            |error| match error {
                SearchError::NoAllowedPose { .. } | SearchError::AllInMembrane => {
                    Failure::input(&error).remedy(error.remedy())
                }
                error => Failure::other(&error).remedy(error.remedy()),
            },
        )?;
        drop(progress);
        // The record says where the search stopped, so that it can be repeated.
        self.request.options.stopped = outcome.stopped;
        let written = self.write(&outcome, &staging)?;
        warn_set_aside(&staging.commit()?, notices);
        self.report(&outcome, &written.quality, console);
        let Self { directory, .. } = &self;
        let top = directory.join("top");
        let complexes = written.complexes.iter().map(|name| top.join(name));
        Ok(json!({
            "directory": directory.display().to_string(),
            "poses": directory.join("poses.csv").display().to_string(),
            "report": written.report.then(|| directory.join(REPORT).display().to_string()),
            "complexes": complexes.map(|path| path.display().to_string()).collect::<Vec<_>>(),
            "best": written.best,
            "run": written.manifest,
        }))
    }

    /// Writes the table, the complexes and the record of a run into its staging folder.
    fn write(&self, outcome: &DockOutcome, staging: &Staging) -> Result<Written, Failure> {
        let Self {
            request, evaluator, ..
        } = self;
        let output = &request.options.output;
        let rows = pose_rows(&outcome.poses);
        let plan = &self.prepared.plan;
        let mut quality: Vec<Column> = restraints::met(plan, &outcome.poses).into_iter().collect();
        if let Some(evaluator) = evaluator {
            quality.extend(quality::columns(&measure(evaluator, &rows)));
        }
        if !plan.restraints.is_empty() {
            staging.write("restraints.csv", |file| {
                restraints::write_to(plan, &outcome.poses, file)
            })?;
        }
        let columns = (self.prepared.plan.sharp(), output.diagnostics);
        let table = RunTable::new(&outcome.poses, columns, &quality);
        staging.write("poses.csv", |file| table.write_to(file))?;
        let best = table.objects(firsts(&outcome.poses).into_iter().take(BEST));
        let top = rows.get(..output.write_top).unwrap_or(&rows);
        let written = request.bodies.write(
            top,
            request.arrangement(),
            (&staging.folder().join("top"), None),
        )?;
        if let Some(chains) = &written.chains {
            let names = written.names.iter().zip(top);
            let viewed: Vec<ViewedComplex> = names
                .map(|(name, row)| ViewedComplex::new(row.rank, name, chains))
                .collect();
            write_scripts(staging, &viewed)?;
        }
        let shown = table.first(MAX_ROWS);
        let contacts = request.bodies.contacts(&shown, &request.options);
        if let Some(contacts) = &contacts {
            let [receptor, ligand] = contacts.shares();
            let sides = [("receptor", &receptor[..]), ("ligand", &ligand[..])];
            staging.write(INTERFACE, |file| write_shares(sides, file))?;
        }
        let inputs = request.inputs(self.prepared.sampling.as_deref())?;
        let manifest = Manifest::new(ManifestParts {
            inputs: &inputs,
            options: &request.options,
            plan: &self.prepared.plan,
            outcome,
            results: Results {
                poses: outcome.poses_kept,
                clusters: outcome.clusters,
                rows: outcome.poses.len(),
                rotations: outcome.searched,
            },
            files: staging.checksums()?,
            chains: written.chains.as_ref(),
            matching: evaluator.as_ref().map(|evaluator| evaluator.report()),
            timing: self.clock.timing(outcome),
            machine: Machine {
                chosen: self.chosen.clone(),
                adapter: outcome.adapter.clone(),
                ..machine(&self.prepared.plan)
            },
        })
        .map_err(Failure::other)?;
        staging.write("run.json", |file| manifest.write_to(file))?;
        let record = serde_json::to_value(&manifest).map_err(Failure::other)?;
        if !output.no_report {
            let report = RunReport {
                record: &record,
                options: &request.options,
                table: &shown,
                bodies: request.bodies.shown(contacts.as_ref()),
                directory: &self.directory.display().to_string(),
            };
            let text = report.text(Viewer::embedded());
            staging.write(REPORT, |file| file.write_all(text.as_bytes()))?;
        }
        Ok(Written {
            manifest: record,
            report: !output.no_report,
            complexes: written.names,
            best,
            quality,
        })
    }

    /// Reports the run: effects, errors, times and the best clusters.
    fn report(&self, outcome: &DockOutcome, quality: &[Column], console: Console) {
        let plan = &self.prepared.plan;
        console.say(format!("\n{}", outcome_text(plan, outcome)));
        console.detail(format!("\n{}", timings_text(outcome)));
        if let Some(warning) = error_warning(plan, outcome) {
            console.warn(warning);
        }
        if let Some(warning) = few_rotations_warning(outcome, self.deadline.is_some()) {
            console.warn(warning);
        }
        if let Some(chosen) = &self.chosen {
            let stages = outcome.timing.iter();
            console.say(format!(
                "The search was expected to take {:.1} s, and took {:.1} s",
                chosen.predicted_seconds,
                stages.map(|stage| stage.wall_seconds).sum::<f64>()
            ));
            if let Some(budget) = chosen.budget_seconds {
                console.say(format!(
                    "The whole run took {:.1} s of {budget} s",
                    self.clock.seconds()
                ));
            }
        }
        console.say(format!("\n{}", best_clusters(&outcome.poses, quality)));
        console.say(format!(
            "\n{} in {}",
            counted(outcome.poses.len(), "row"),
            self.directory.join("poses.csv").display()
        ));
        if !self.request.options.output.no_report {
            let report = self.directory.join(REPORT);
            console.say(format!("To look at them: {}", report.display()));
        }
    }
}

/// The refusal of a directory that holds something else, which `force` would replace.
pub fn held_by_another(directory: &Path, force: &str) -> Failure {
    Failure::input(
        "the directory holds a run of other inputs or options, or by another version, or only part of this one",
    )
    .at(directory)
    .remedy(format!("pass {force} to replace it, or choose another directory with -o"))
}

/// Writes the scripts that show complexes in other programs, if there are any.
pub fn write_scripts(staging: &Staging, complexes: &[ViewedComplex]) -> Result<(), Failure> {
    if !complexes.is_empty() {
        staging.write(PYMOL, |file| write_pymol(file, complexes))?;
        staging.write(CHIMERAX, |file| write_chimerax(file, complexes))?;
    }
    Ok(())
}

/// What a run wrote.
struct Written {
    /// Rows of the best clusters, as JSON.
    best: Vec<Value>,
    /// Columns of the table that a known complex added.
    quality: Vec<Column>,
    /// Whether there is a report.
    report: bool,
    /// Names of the complexes in `top/`.
    complexes: Vec<String>,
    /// run.json.
    manifest: Value,
}

/// Plans by what is wanted of accuracy and time, and fills the choice into the request's options.
fn plan_within(
    wanted: Wanted,
    (model, source): (&CostModel, &str),
    request: &mut Request,
    console: Console,
) -> Result<(PreparedPair, Chosen), Failure> {
    // Nothing is known of the time that sharp fits take before there are poses.
    if wanted.budget.is_some() && request.options.ranking.sharp == SharpChoice::Auto {
        request.options.ranking.sharp = SharpChoice::Off;
    }
    let rotations = request.options.search.rotations;
    // A first plan fills in the lengths of meshes; its rotations are not used.
    request.options.search.rotations = 4;
    let first = request.plan(console)?;
    request.options.search.rotations = rotations;
    let options = &mut request.options;
    let mut preparer = Preparer::new(request.bodies.pair(), options, &first);
    let chosen = choose(wanted, (model, source), options, &mut preparer)
        .map_err(|error| Failure::input(&error).remedy(error.remedy()))?;
    let prepared = preparer
        .prepare(options)
        .map_err(|error| Failure::input(&error).remedy(error.remedy()))?;
    let error = chosen
        .predicted_error
        .map(|error| format!(" and an error of {error:.1e} of the best score"));
    console.say(format!(
        "\nChosen: --rotations {} --tolerance {}{} at a spacing of {:.4}; expected, by the {} cost model, are {:.1} s{}",
        options.search.rotations,
        options.kernel.tolerance,
        match options.search.precision {
            Precision::Single => "",
            Precision::Double => " --precision double",
        },
        prepared.plan.spacing,
        if source == "built-in" { "built-in" } else { "calibrated" },
        chosen.predicted_seconds,
        error.unwrap_or_default()
    ));
    Ok((prepared, chosen))
}

/// When the run began.
pub struct Clock {
    wall: SystemTime,
    monotonic: Instant,
}

impl Clock {
    /// Now.
    pub fn start() -> Self {
        Self {
            wall: SystemTime::now(),
            monotonic: Instant::now(),
        }
    }

    /// Seconds since then.
    pub fn seconds(&self) -> f64 {
        self.monotonic.elapsed().as_secs_f64()
    }

    fn timing(&self, outcome: &DockOutcome) -> Timing {
        Timing {
            // A clock set before 1970 says nothing.
            started_unix_seconds: self
                .wall
                .duration_since(UNIX_EPOCH)
                .map_or(0, |since| since.as_secs()),
            wall_seconds: self.seconds(),
            stages: outcome.timing.clone(),
            effects: EffectTime::of(&outcome.effects),
            peak_memory_bytes: process::peak(),
        }
    }
}
