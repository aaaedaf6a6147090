//! `knotdock dock`: from two structures to a ranked list of poses and complexes.

use std::path::PathBuf;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use clap::Args;
use knotdock::output::manifest::{EffectTime, Machine, Manifest, ManifestParts, Results, Timing};
use knotdock::output::poses::PoseTable;
use knotdock::output::quality;
use knotdock::output::report::{BEST, best_clusters, firsts};
use knotdock::output::run_options::RunOptions;
use knotdock::output::staging::Staging;
use knotdock::search::options::Precision;
use knotdock::search::{self, DockOutcome};
use knotdock::tradeoff::choice::{Chosen, Wanted, choose};
use knotdock::tradeoff::pair::{Prepared, Preparer};
use serde_json::json;

use super::arguments::{above_zero, duration};
use super::bodies::Bodies;
use super::calibrate::cost_model;
use super::console::Console;
use super::dock_report::{assumed, chance_told, told};
use super::failure::Failure;
use super::machine_arguments::{MachineArguments, machine};
use super::memory;
use super::native::{NativeArguments, match_text, measure};
use super::reading_arguments::ReadingArguments;
use super::request::Request;
use super::search_arguments::{RANKING, SearchArguments, TRADE_OFFS};

/// Dock a ligand to a receptor and rank the poses: two molecules, or two meshes in one unit of length.
///
/// Writes poses.csv, top/rank_0001.pdb ... (of meshes .obj) and run.json into a directory of the run. The same input and options give the
/// same bytes for any number of threads.
#[derive(Args, Debug)]
pub struct Dock {
    /// What stays: a molecule (.pdb, .ent or .cif, each also .gz; FILE:H,L picks chains by the author's names) or a mesh (.stl, .obj,
    /// .ply or .off).
    #[arg(required_unless_present = "from", value_name = "RECEPTOR")]
    receptor: Option<String>,
    /// What moves, likewise and of the same kind.
    #[arg(required_unless_present = "from", value_name = "LIGAND")]
    ligand: Option<String>,
    /// Directory of the run [default: knotdock_RECEPTOR_LIGAND].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace the run in the directory, once the new one is done.
    #[arg(long)]
    force: bool,
    /// Repeat the run that wrote this run.json: its inputs, checked by SHA-256, and its options.
    #[arg(long, value_name = "RUN.JSON", conflicts_with_all = RECORDED)]
    from: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingArguments,
    #[command(flatten)]
    search: SearchArguments,
    /// Take the cheapest tolerance and spacing, and double precision where it needs that, whose error is expected to be within X: rms over the best
    /// grid poses, as a share of the best score.
    #[arg(long, value_name = "X", value_parser = above_zero, conflicts_with_all = ["tolerance", "spacing"], help_heading = TRADE_OFFS)]
    accuracy: Option<f64>,
    /// Take as many rotations as are expected to fit into a time, such as 5s or 2min; `knotdock calibrate` tells how fast this machine is.
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with_all = ["rotations", "angle"], help_heading = TRADE_OFFS)]
    budget: Option<f64>,
    /// Complexes to write to top/.
    #[arg(long, value_name = "N", default_value_t = 10, help_heading = RANKING)]
    write_top: usize,
    #[command(flatten)]
    native: NativeArguments,
    #[command(flatten)]
    machine: MachineArguments,
}

/// What run.json records, so that none of it goes with --from.
const RECORDED: [&str; 51] = [
    "receptor",
    "ligand",
    "waters",
    "hetatm",
    "hydrogens",
    "altloc",
    "model",
    "rotations",
    "angle",
    "fine_rotations",
    "fine_angle",
    "fine_share",
    "resolution",
    "pass_length",
    "spacing",
    "lambda",
    "offset",
    "alpha",
    "core_weight",
    "sample_grid",
    "sample_weights",
    "tolerance",
    "precision",
    "effects",
    "electrostatics_weight",
    "contact_weight",
    "contact_potential",
    "fine_contact_weight",
    "fine_contact_potential",
    "atom_pair_weight",
    "relaxed_weight",
    "atom_pair_potential",
    "restraint_weight",
    "antibody",
    "block_receptor",
    "block_ligand",
    "attraction_weight",
    "attract_receptor",
    "attract_ligand",
    "ph",
    "per_rotation",
    "poses",
    "refine",
    "cluster_radius",
    "no_cluster",
    "write_top",
    "native",
    "native_receptor",
    "native_ligand",
    "accuracy",
    "budget",
];

impl Dock {
    /// What the command line asks for.
    fn request(&self) -> Result<Request, Failure> {
        let (Some(receptor), Some(ligand)) = (&self.receptor, &self.ligand) else {
            return Err(Failure::input("a receptor and a ligand are needed"));
        };
        let reading = self.reading.options();
        Ok(Request {
            bodies: Bodies::read(receptor, ligand, &reading)?,
            native: self.native.read()?,
            options: RunOptions {
                reading,
                dock: self.search.options()?,
                write_top: self.write_top,
            },
            offset: self.search.offset(),
            given: self.search.given_lengths(),
        })
    }

    /// Docks.
    pub fn run(self, console: Console) -> Result<(), Failure> {
        let clock = Clock::start();
        let mut request = match &self.from {
            Some(path) => Request::recorded(path, console)?,
            None => self.request()?,
        };
        self.machine.apply(&mut request.options.dock);
        let directory = self.output.unwrap_or_else(|| request.directory());
        request.bodies.describe(console);
        let evaluator = request.evaluator()?;
        if let Some(evaluator) = &evaluator {
            console.say(match_text(evaluator));
        }
        let wanted = Wanted {
            accuracy: self.accuracy,
            budget: self.budget,
        };
        let (prepared, chosen) = if wanted == Wanted::default() {
            (request.plan(console)?, None)
        } else {
            let (prepared, chosen) = plan_within(wanted, &mut request, console)?;
            (prepared, Some(chosen))
        };
        let Prepared {
            plan,
            points,
            sampling,
            ..
        } = prepared;
        console.say(format!("\n{plan}"));
        for (side, count) in ["receptor", "ligand"].into_iter().zip(plan.unresolved()) {
            if count > 0 {
                console.warn(format!(
                    "{count} balls of the {side} are too small for a resolution of {} {}, which leaves less than a tenth of their overlap",
                    request.options.dock.resolution, plan.unit
                ));
            }
        }
        for (side, labels) in ["receptor", "ligand"].into_iter().zip(&plan.labels) {
            if let Some(text) = assumed(side, labels, &plan) {
                console.say(text);
            }
        }
        let staging = Staging::open(&directory, self.force)?;
        let progress = console.progress();
        let outcome = search::dock(&plan, &points, &progress)
            .map_err(|error| Failure::other(&error).remedy(error.remedy()))?;
        drop(progress);

        let mut table = PoseTable::new(&outcome.poses);
        let quality = match &evaluator {
            Some(evaluator) => quality::columns(&measure(evaluator, table.rows())),
            None => Vec::new(),
        };
        for column in &quality {
            table.set_column(column);
        }
        table.write(&staging.folder().join("poses.csv"))?;
        let top = table
            .rows()
            .get(..request.options.write_top)
            .unwrap_or(table.rows());
        let written = request.bodies.write(top, &staging.folder().join("top"))?;
        let inputs = request.inputs(sampling.as_deref())?;
        let manifest = Manifest::new(ManifestParts {
            inputs: &inputs,
            options: &request.options,
            plan: &plan,
            outcome: &outcome,
            results: Results {
                poses: outcome.poses_kept,
                clusters: outcome.clusters,
                rows: outcome.poses.len(),
                chance_acceptable_in_10: outcome.chance,
            },
            chains: written.chains.as_ref(),
            matching: evaluator.as_ref().map(|evaluator| evaluator.report()),
            timing: clock.timing(&outcome),
            machine: Machine {
                chosen: chosen.clone(),
                ..machine(&plan)
            },
        })
        .map_err(Failure::other)?;
        manifest.write(&staging.folder().join("run.json"))?;
        staging.commit()?;

        console.say(format!("\n{}", told(&outcome)));
        if let Some(chosen) = &chosen {
            let stages = outcome.timing.iter();
            console.say(format!(
                "The search was expected to take {:.1} s, and took {:.1} s",
                chosen.predicted_seconds,
                stages.map(|stage| stage.wall_seconds).sum::<f64>()
            ));
        }
        console.say(format!("\n{}", best_clusters(&outcome.poses, &quality)));
        if let Some(chance) = outcome.chance {
            console.say(format!("\n{}", chance_told(chance)));
        }
        console.say(format!(
            "\n{} rows in {}",
            outcome.poses.len(),
            directory.join("poses.csv").display()
        ));
        let complexes = written
            .names
            .iter()
            .map(|name| directory.join("top").join(name));
        console.result(&json!({
            "directory": directory.display().to_string(),
            "poses": directory.join("poses.csv").display().to_string(),
            "complexes": complexes.map(|path| path.display().to_string()).collect::<Vec<_>>(),
            "best": table.objects(firsts(&outcome.poses).into_iter().take(BEST)),
            "run": serde_json::to_value(&manifest).map_err(Failure::other)?,
        }));
        Ok(())
    }
}

/// Plans by what is wanted of accuracy and time, and fills the choice into the request's options.
fn plan_within(
    wanted: Wanted,
    request: &mut Request,
    console: Console,
) -> Result<(Prepared, Chosen), Failure> {
    let (model, source) = cost_model(console);
    let rotations = request.options.dock.rotations;
    // A first plan fills in the lengths of meshes; its rotations are not used.
    request.options.dock.rotations = 4;
    let first = request.plan(console)?;
    request.options.dock.rotations = rotations;
    let options = &mut request.options.dock;
    let mut preparer = Preparer::new(request.bodies.pair(), options, &first);
    let chosen = choose(wanted, (&model, &source), options, &mut preparer)
        .map_err(|error| Failure::input(&error).remedy(error.remedy()))?;
    let prepared = preparer
        .prepare(options)
        .map_err(|error| Failure::input(&error).remedy(error.remedy()))?;
    let error = chosen
        .predicted_error
        .map(|error| format!(" and an error of {error:.1e} of the best score"));
    console.say(format!(
        "\nChosen: --rotations {} --tolerance {}{} at a spacing of {:.4}; expected, by the {} cost model, are {:.1} s{}",
        options.rotations,
        options.tolerance,
        match options.precision {
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
struct Clock {
    wall: SystemTime,
    monotonic: Instant,
}

impl Clock {
    fn start() -> Self {
        Self {
            wall: SystemTime::now(),
            monotonic: Instant::now(),
        }
    }

    fn timing(&self, outcome: &DockOutcome) -> Timing {
        Timing {
            // A clock set before 1970 says nothing.
            started_unix_seconds: self
                .wall
                .duration_since(UNIX_EPOCH)
                .map_or(0, |since| since.as_secs()),
            wall_seconds: self.monotonic.elapsed().as_secs_f64(),
            stages: outcome.timing.clone(),
            effects: EffectTime::of(&outcome.effects),
            peak_memory_bytes: memory::peak(),
        }
    }
}
