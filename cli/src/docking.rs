//! A docking run: planned, described, carried out and written.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::records::recorded_run::RecordedRun;
use crate::tradeoff::choice::{RunTarget, choose};
use knotdock::dock::pair::{PreparedPair, Preparer};
use knotdock::options::{DockOptions, Precision, SharpChoice};
use knotdock::output::files::staging::put_back;
use knotdock::output::records::manifest::Chosen;
use knotdock::output::run_folder::Clock;

use crate::inputs::native::NativeFiles;
use crate::inputs::request::{KnownComplex, Request};
use crate::messages::console::Console;
use crate::messages::dock::{assumed, closer_gap_text, expected_text, regions_text, score_text};
use knotdock_structures::Error;

/// A run that is ready to go.
pub struct Docking {
    pub(super) request: Request,
    pub(super) directory: PathBuf,
    /// What its report calls the directory.
    pub(super) shown: PathBuf,
    /// Whether another run there is replaced.
    pub(super) force: bool,
    pub(super) known: Option<KnownComplex>,
    pub(super) prepared: PreparedPair,
    /// The closer gap, if the gap between meshes is searched.
    pub(super) closer: Option<(DockOptions, PreparedPair)>,
    pub(super) chosen: Option<Chosen>,
    /// End of the budget, if the run has one.
    pub(super) deadline: Option<Instant>,
    pub(super) clock: Clock,
}

impl Docking {
    /// Plans the requested run. It is written into `directory`, and replaces a run there only if `force` is true.
    pub fn prepare(
        mut request: Request,
        wanted: RunTarget,
        (directory, force): (PathBuf, bool),
        clock: Clock,
        console: Console,
    ) -> Result<Self, Error> {
        let arrangement = request.arrangement();
        if !arrangement.is_ring() {
            request.bodies.note_shared_chains();
        }
        request.bodies.describe(arrangement, console);
        let known = request.known(console)?;
        let (mut prepared, chosen, deadline) = if wanted == RunTarget::default() {
            (request.plan(console)?, None, None)
        } else {
            let (prepared, chosen) = plan_within(wanted, &mut request, console)?;
            let end = wanted.budget.and_then(|budget| clock.after(budget));
            (prepared, Some(chosen), end)
        };
        let mut closer = request.closer_gap(&mut prepared)?;
        if let Some((_, closer)) = &mut closer {
            prepared.plan.count_beside(&closer.plan);
            closer.plan.count_beside(&prepared.plan);
        }
        let plan = &prepared.plan;
        let sides = arrangement.sides();
        console.detail(format!("\n{plan}"));
        for (side, count) in sides.iter().zip(plan.unresolved()) {
            if count > 0 {
                console.warn(format!(
                    "{count} balls of the {side} are too small for a resolution of {} {}: less than a tenth of their overlap is left",
                    request.options.kernel.resolution, plan.unit
                ));
            }
        }
        for text in regions_text(sides, &plan.regions) {
            console.detail(text);
        }
        for (side, labels) in sides.iter().zip(&plan.labels) {
            if let Some(text) = assumed(side, labels, plan) {
                console.detail(text);
            }
        }
        console.say(score_text(plan, sides));
        console.say(expected_text(plan, chosen.as_ref(), request.is_angle));
        if let Some((options, _)) = &closer {
            console.say(closer_gap_text(options.kernel.offset));
        }
        Ok(Self {
            request,
            shown: directory.clone(),
            directory,
            force,
            known,
            prepared,
            closer,
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
    pub fn expected_seconds(&self) -> f64 {
        let closer = self.closer.iter().map(|(_, closer)| closer);
        let plans = closer.chain([&self.prepared]).map(|pair| &pair.plan);
        plans.map(|plan| plan.search_seconds(plan.rotations)).sum()
    }

    /// The directory of the run, if it holds another run that is not to be replaced.
    pub fn in_the_way(&self) -> Option<&Path> {
        let run = !self.force && self.directory.join("run.json").exists();
        run.then_some(self.directory.as_path())
    }

    /// Whether the directory holds this very run already: of this program, with inputs of the same content and the
    /// same options.
    pub fn is_done(&self) -> bool {
        if put_back(&self.directory).is_err() {
            return false;
        }
        let Ok(run) = RecordedRun::read(&self.directory.join("run.json")) else {
            return false;
        };
        let native = self.request.native.as_ref().map(NativeFiles::record);
        let mut options = self.request.options.clone();
        if self.deadline.is_some() {
            // This run would stop where its own time ends.
            options.stopped = run.options.stopped;
        }
        let inputs = self.request.bodies.records();
        let closer = self.closer.iter().map(|(options, _)| options);
        self.directory.join("poses.csv").is_file()
            && run.is_of_this_program()
            && (closer.chain([&options]))
                .any(|options| run.is_same_request(inputs, native.as_ref(), options))
    }
}

/// The refusal of a directory that holds something else, which `force` would replace.
pub fn held_by_another(directory: &Path, force: &str) -> Error {
    Error::input(
        "the directory holds another run: of other inputs or options, by another version, or unfinished",
    )
    .at(directory)
    .help(format!("pass {force} to replace it, or choose another directory with -o"))
}

/// Plans by the accuracy and time wanted, and fills the choice into the request's options.
fn plan_within(
    wanted: RunTarget,
    request: &mut Request,
    console: Console,
) -> Result<(PreparedPair, Chosen), Error> {
    // Nothing is known of the time that sharp fits take before there are poses.
    if wanted.budget.is_some() && request.options.ranking.sharp == SharpChoice::Auto {
        request.options.ranking.sharp = SharpChoice::Off;
    }
    let rotations = request.options.search.rotations;
    // A first plan fills in the defaults of meshes; its rotations are not used.
    request.options.search.rotations = 4;
    // A budget is for the search.
    request.options.output.raw |= wanted.budget.is_some();
    // The clock ends the search of an even set.
    request.given.defaults.rotations |= wanted.budget.is_some();
    request.given.fixes_gap |= wanted.budget.is_some();
    let first = request.plan(console)?;
    request.options.search.rotations = rotations;
    let options = &mut request.options;
    let mut preparer = Preparer::new(request.bodies.pair(), options, &first);
    let chosen = choose(wanted, options, &mut preparer)?;
    let prepared = PreparedPair {
        closer: first.closer,
        ..preparer.prepare(options)?
    };
    let error = chosen
        .predicted_error
        .map(|error| format!(" and an error of {error:.1e} of the best score"));
    console.detail(format!(
        "\nChosen: --rotations {} --tolerance {}{} at a spacing of {:.4}{}",
        options.search.rotations,
        options.kernel.tolerance,
        match options.search.precision {
            Precision::Single => "",
            Precision::Double => " --precision double",
        },
        prepared.plan.spacing,
        error.unwrap_or_default()
    ));
    Ok((prepared, chosen))
}
