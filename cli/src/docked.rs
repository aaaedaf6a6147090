//! A run that is docked: its table and its files.

use std::path::Path;

use serde_json::{Value, json};

use crate::docking::Docking;
use crate::inputs::native::measure;
use crate::inputs::request::KnownComplex;
use crate::messages::console::Console;
use crate::messages::dock::{
    cost_text, error_warning, gaps_text, next_text, outcome_text, redocking_text,
    restraints_warning, timings_text,
};
use crate::report::{MAX_ROWS, RunReport, Viewer, figures};
use crate::shards::WIDE_COLUMNS;
use crate::tables::batch_results::RunSummary;
use crate::tables::report::{BEST, best_clusters, counted, firsts};
use crate::tradeoff::choice::MIN_ROTATIONS;
use knotdock::dock::gaps::dock_at_gaps;
use knotdock::dock::outcome::DockOutcome;
use knotdock::dock::pair::{Pair, PreparedPair};
use knotdock::dock::run::dock_until;
use knotdock::dock::stopwatch::timed;
use knotdock::evaluate::PoseQuality;
use knotdock::options::DockOptions;
use knotdock::output::files::added::Addition;
use knotdock::output::files::own_files::RUN;
use knotdock::output::files::seal::REPORT;
use knotdock::output::files::staging::{Stage, Staging};
use knotdock::output::run_folder::FinishedRun;
use knotdock::output::tables::fields::{Column, number};
use knotdock::output::tables::run_table::{RunTable, pose_rows};
use knotdock::output::tables::{quality, restraints};
use knotdock::output::top_complexes::TopComplexes;
use knotdock::redock::{Redocking, redock};
use knotdock_structures::Error;
use rayon::prelude::*;

impl Docking {
    /// Docks and writes the run; its JSON object. Leftovers of ended commands are reported on `notices`.
    pub fn run(self, console: Console, notices: Console) -> Result<Value, Error> {
        let staging = Staging::open(RUN, &self.directory, self.force)?;
        notices.warn_leftovers(&staging.leftovers);
        self.dock(console)?.save(staging, console)
    }

    /// Docks, and writes nothing.
    pub fn dock(mut self, console: Console) -> Result<Docked, Error> {
        let progress = console.progress();
        let outcome = match self.closer.take() {
            Some(closer) => self.dock_at_gaps(closer, console)?,
            None => {
                let PreparedPair { plan, points, .. } = &self.prepared;
                dock_until(plan, points, self.deadline, &progress)?
            }
        };
        // The record says where the search stopped, so that it can be repeated.
        self.request.options.stopped = outcome.stopped;
        Docked::new(self, outcome)
    }

    /// Docks solids at this gap and the closer one, and keeps the better one.
    fn dock_at_gaps(
        &mut self,
        (options, closer): (DockOptions, PreparedPair),
        console: Console,
    ) -> Result<DockOutcome, Error> {
        let Some(solids) = self.request.bodies.solids() else {
            return Err(
                Error::input("the gap between files of balls is not searched")
                    .help("give the gap as --offset"),
            );
        };
        let pairs = [&self.prepared, &closer];
        let docked = dock_at_gaps(pairs, solids, &console.progress())?;
        if docked.gap == 1 {
            self.request.options = options;
            self.prepared = closer;
        }
        console.say(gaps_text(&docked));
        self.chosen.get_or_insert_default().gaps = Some(docked.gaps);
        Ok(docked.outcome)
    }
}

/// A run that is docked and not written.
pub struct Docked {
    docking: Docking,
    outcome: DockOutcome,
    redocking: Option<Redocking>,
    /// The complexes of the first rows.
    top: TopComplexes,
    /// Columns that restraints, a known complex and the complexes add to the table.
    quality: Vec<Column>,
    /// The same as one of the columns that any run may have each.
    wide: Vec<Column>,
}

impl Docked {
    /// What a docking came to.
    pub fn new(docking: Docking, mut outcome: DockOutcome) -> Result<Self, Error> {
        let mut redocking = None;
        let mut quality: Vec<Column> = restraints::met(&docking.prepared.plan, &outcome.poses)
            .into_iter()
            .collect();
        if let Some(known) = &docking.known {
            let rows = pose_rows(&outcome.poses);
            let measured = known.evaluator().map(|evaluator| measure(evaluator, &rows));
            let measured = measured.unwrap_or_default().into_iter();
            let measured: Vec<PoseQuality> = measured.map(|(quality, _)| quality).collect();
            if docking.request.is_from_model {
                let PreparedPair { plan, points, .. } = &docking.prepared;
                let (found, timing) = timed("redock", || redock(plan, points, &outcome, &measured));
                outcome.timing.push(timing);
                redocking = Some(found?);
            }
            let mut found: Vec<_> = measured.into_iter().map(Some).collect();
            found.resize(rows.len(), None);
            quality.extend(quality::columns(&found));
        }
        let (bodies, options) = (docking.request.bodies.placed(), &docking.request.options);
        let rows = pose_rows(&outcome.poses);
        let first = options.output.top(&rows);
        let (top, timing) = timed("complexes", || TopComplexes::new(bodies, first, options));
        let top = top?;
        outcome.timing.push(timing);
        quality.extend(top.clashes());
        quality.extend(complex_irmsd(&docking, &top)?);
        let wide = WIDE_COLUMNS.map(|name| {
            let found = quality.iter().find(|column| column.name == name);
            found.cloned().unwrap_or_else(|| Column {
                name: name.to_owned(),
                fields: Vec::new(),
            })
        });
        Ok(Self {
            docking,
            outcome,
            redocking,
            top,
            quality,
            wide: wide.into(),
        })
    }

    pub fn table(&self) -> RunTable<'_> {
        let docking = &self.docking;
        let diagnostics = docking.request.options.output.diagnostics;
        let columns = (docking.prepared.plan.sharp(), diagnostics);
        RunTable::new(&self.outcome.poses, columns, &self.quality)
    }

    /// Its table of poses with the columns that any run may have.
    pub fn wide_table(&self) -> RunTable<'_> {
        RunTable::wide(&self.outcome.poses, &self.wide)
    }

    pub fn summary(&self) -> RunSummary {
        let table = self.table();
        let counts = [self.outcome.poses_kept, self.outcome.clusters.len()];
        let counts = counts.map(|count| u64::try_from(count).ok());
        RunSummary::of_rows(counts, table.objects(0..self.outcome.poses.len()))
    }

    /// Writes the complexes of the best poses into a folder, which may hold the same ones.
    pub fn export_top(&self, folder: &Path) -> Result<(), Error> {
        let request = &self.docking.request;
        let rows = pose_rows(&self.outcome.poses);
        let top = request.options.output.top(&rows);
        let addition = Addition::open(folder, None)?;
        let place = (addition.stage().folder(), None);
        let placed = request.bodies.placed();
        let complexes = (top, self.top.refined());
        placed.write(complexes, request.arrangement(), place)?;
        addition.place(false)
    }

    pub fn save(&self, staging: Staging, console: Console) -> Result<Value, Error> {
        let object = self.write(staging.stage())?;
        staging.commit()?;
        self.report(console);
        Ok(object)
    }

    /// Writes the table, the complexes and the record of a run into its staging folder; its JSON object.
    fn write(&self, staging: &Stage) -> Result<Value, Error> {
        let (docking, outcome) = (&self.docking, &self.outcome);
        let Docking {
            request,
            known,
            prepared,
            directory,
            ..
        } = docking;
        let table = self.table();
        let shown = table.first(MAX_ROWS);
        let contacts = request.bodies.contacts(&shown, &request.options);
        let inputs = request.inputs(prepared.sampling.as_deref())?;
        let staged = FinishedRun {
            bodies: request.bodies.placed(),
            inputs: &inputs,
            options: &request.options,
            plan: &prepared.plan,
            outcome,
            top: &self.top,
            further: &self.quality,
            contacts: contacts.as_ref(),
            matching: known.as_ref().map(KnownComplex::entry).transpose()?,
            redocking: self.redocking.as_ref(),
            chosen: docking.chosen.as_ref(),
            clock: &docking.clock,
        }
        .stage(staging)?;
        let has_report = !request.options.output.no_report;
        if has_report {
            let report = RunReport {
                record: &staged.record,
                options: &request.options,
                table: &shown,
                bodies: request.bodies.placed(),
                refined: self.top.refined(),
                contacts: contacts.as_ref(),
                known: known.as_ref().map(KnownComplex::matched),
                clusters: figures(&outcome.clusters, &shown),
                directory: &docking.shown.display().to_string(),
            };
            let text = report.text(Viewer::embedded());
            staging.write(REPORT, |file| file.write_all(text.as_bytes()))?;
        }
        let path = |name: &str| directory.join(name).display().to_string();
        let top = directory.join("top");
        let complexes = staged.complexes.iter().map(|name| top.join(name));
        Ok(json!({
            "directory": directory.display().to_string(),
            "poses": path("poses.csv"),
            "report": has_report.then(|| path(REPORT)),
            "complexes": complexes.map(|path| path.display().to_string()).collect::<Vec<_>>(),
            "best": table.objects(firsts(&outcome.poses).into_iter().take(BEST)),
            "run": staged.record,
        }))
    }

    /// Reports best clusters, cost and next steps; with details, effects, errors and times before them.
    fn report(&self, console: Console) {
        let (docking, outcome) = (&self.docking, &self.outcome);
        let plan = &docking.prepared.plan;
        console.detail(format!("\n{}", outcome_text(outcome)));
        console.detail(format!("\n{}", timings_text(outcome)));
        console.say(format!(
            "\n{}\n",
            best_clusters(&outcome.poses, &self.quality)
        ));
        if let Some(redocking) = &self.redocking {
            console.say(format!("{}\n", redocking_text(redocking)));
        }
        if let Some(reason) = &outcome.adapter_failure {
            console.warn(format!(
                "the cores searched, as no graphics processor could: {reason}"
            ));
        }
        if let Some(warning) = error_warning(plan, outcome) {
            console.warn(warning);
        }
        if let Some(warning) = restraints_warning(plan, &outcome.poses) {
            console.warn(warning);
        }
        if let Some(warning) = few_rotations_warning(outcome, docking.deadline.is_some()) {
            console.warn(warning);
        }
        console.say(cost_text(plan, outcome, docking.clock.seconds()));
        let output = &docking.request.options.output;
        console.say(next_text(
            &docking.directory,
            outcome,
            output.write_top,
            !output.no_report,
        ));
    }
}

/// The column `complex_irmsd`: interface RMSD in Å of each complex that is written, if the known one can be matched.
fn complex_irmsd(docking: &Docking, top: &TopComplexes) -> Result<Option<Column>, Error> {
    let evaluator = docking.known.as_ref().and_then(KnownComplex::evaluator);
    let (Some(_), Some(native), Pair::Molecules(pair), [_, ..]) = (
        evaluator,
        &docking.request.native,
        docking.request.bodies.pair(),
        top.refined(),
    ) else {
        return Ok(None);
    };
    let irmsd = top.refined().par_iter().map(|refined| {
        let quality = native.quality(pair, refined)?;
        Ok(number(quality.irmsd))
    });
    Ok(Some(Column {
        name: quality::OF_COMPLEXES[1].to_owned(),
        fields: irmsd.collect::<Result<_, Error>>()?,
    }))
}

/// Warning that a deadline left time for too few rotations.
fn few_rotations_warning(outcome: &DockOutcome, has_deadline: bool) -> Option<String> {
    let few = has_deadline && outcome.searched < MIN_ROTATIONS;
    few.then(|| {
        format!(
            "the budget left time for {} only, and fewer than {MIN_ROTATIONS} find little: allow more time, or leave \
             more of the machine to the run",
            counted(outcome.searched, "rotation")
        )
    })
}
