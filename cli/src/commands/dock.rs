//! `knotdock dock`: from two structures to a ranked list of poses and complexes.

use std::path::{Path, PathBuf};

use clap::{Arg, Args, Command, Id, ValueHint};
use serde_json::Value;

use crate::arguments::conformations::ConformationArguments;
use crate::arguments::machine::settled;
use crate::arguments::options::{GivenOptions, OfDock, OptionArguments};
use crate::docking::Docking;
use crate::ensemble::{Ensemble, EnsembleRequest};
use crate::inputs::bodies::Bodies;
use crate::inputs::conformations::{Conformation, conformations};
use crate::inputs::molecules::label;
use crate::inputs::native::NativeArguments;
use crate::inputs::request::Request;
use crate::messages::console::Console;
use crate::tradeoff::choice::RunTarget;
use knotdock::dock::memory::process;
use knotdock::options::values::{ABOVE_ZERO, duration, in_range};
use knotdock::options::{DockOptions, EngineChoice, option_named};
use knotdock::output::run_folder::Clock;
use knotdock::threads;
use knotdock_structures::Error;

/// Dock a ligand to a receptor and rank the poses.
///
/// Both are molecules, or both are meshes in one unit of length, in which all lengths are then given. The directory of
/// the run gets report.html to look at, poses.csv, top/rank_0001.pdb and on (.obj of meshes) and run.json. The same
/// input and options give the same bytes for any number of threads, except with --budget.
#[derive(Args, Clone, Debug)]
pub struct Dock {
    /// The fixed molecule (.pdb, .cif, also .gz; FILE:H,L picks chains) or mesh (.stl, .obj).
    ///
    /// Molecules: .pdb, .ent or .cif, each also .gz. FILE:H,L picks chains by the author's names, FILE:H:1-120,L
    /// residues too. Meshes: .stl, .obj, .ply or .off.
    #[arg(required_unless_present_any = ["rerun", "from_model"], value_name = "RECEPTOR")]
    receptor: Option<String>,
    /// The molecule or mesh that is moved.
    #[arg(
        required_unless_present_any = ["rerun", "symmetry", "config", "from_model"],
        value_name = "LIGAND"
    )]
    ligand: Option<String>,
    /// Directory of the run [default: knotdock_RECEPTOR_LIGAND].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace the run in the directory, once the new one is done.
    #[arg(long)]
    force: bool,
    /// Repeat the run that wrote this run.json.
    ///
    /// Its inputs are checked by SHA-256, and its options are taken.
    #[arg(long, value_name = "RUN.JSON")]
    rerun: Option<PathBuf>,
    /// Dock the two sides of a predicted complex again, and say whether docking agrees with it.
    ///
    /// MODEL is a file of two chains, the receptor first; of more, the chains of both sides follow, as in model.cif H,L A.
    /// The search starts from nothing that the prediction says, and each pose is measured against it. The predicted pose
    /// and the first ten clusters are moved to their local optima, whose scores compare.
    #[arg(long, value_name = "MODEL [CHAINS CHAINS]", num_args = 1..=3, value_hint = ValueHint::FilePath)]
    #[arg(conflicts_with_all = NOT_FROM_MODEL)]
    from_model: Vec<String>,
    #[command(flatten)]
    options: OptionArguments<OfDock>,
    /// Choose tolerance, spacing and precision for an error within this share of the best score.
    ///
    /// The cheapest setting is taken whose error is expected to be within it: rms over the best poses of the grid.
    #[arg(long, value_name = "SHARE", value_parser = in_range::<f64>(ABOVE_ZERO), help_heading = WITHIN)]
    #[arg(conflicts_with_all = ["tolerance", "spacing"], conflicts_with = "symmetry")]
    accuracy: Option<f64>,
    /// End within a time on the clock, such as 5s or 2min.
    ///
    /// Reading and writing are included. The search covers all orientations evenly at any time, and stops when what
    /// follows it just fits, by the pace measured so far; at most 56,250 rotations are searched. The same call need not
    /// give the same bytes. run.json records where it stopped: `--rerun` of it gives the same bytes.
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with_all = ["rotations", "symmetry"], help_heading = WITHIN)]
    budget: Option<f64>,
    #[command(flatten)]
    conformations: ConformationArguments,
    #[command(flatten)]
    native: NativeArguments,
}

/// Arguments that `--from-model` excludes: it names both molecules and the complex to measure by, and its answer is of a
/// whole search of one conformation.
const NOT_FROM_MODEL: [&str; 10] = [
    "receptor",
    "ligand",
    "budget",
    "native",
    "native_receptor",
    "native_ligand",
    "receptor_models",
    "ligand_models",
    "receptor_also",
    "ligand_also",
];

/// Arguments that `knotdock dock -h` shows; `--help` shows all.
const IN_BRIEF: [&str; 10] = [
    "receptor",
    "ligand",
    "output",
    "preset",
    "active_receptor",
    "active_ligand",
    "restraints",
    "symmetry",
    "threads",
    "native",
];

/// What stands below the options of `knotdock dock`.
const EXAMPLES: &str = "\
Examples:
  knotdock dock receptor.pdb ligand.cif.gz
  knotdock dock antibody.pdb:H,L antigen.pdb:A -o run
  knotdock dock enzyme.pdb inhibitor.pdb --active-receptor A:57,189-195
  knotdock dock subunit.pdb --symmetry C3
  knotdock dock --from-model model.cif H,L A
  knotdock dock block.stl peg.stl";

/// A command whose `-h` shows of the options of a run only those that most people need.
pub fn in_brief(command: Command) -> Command {
    let is_dock = command.get_name() == "dock";
    let command = command.mut_args(|argument| {
        let name = argument.get_id().as_str();
        let is_option = is_dock || option_named(name).is_some();
        let shown = IN_BRIEF.contains(&name) || !is_option;
        argument.hide_short_help(!shown)
    });
    if is_dock {
        let more = "`knotdock dock --help` lists all options, in groups.";
        command
            .after_help(format!("{EXAMPLES}\n\n{more}"))
            .after_long_help(EXAMPLES)
    } else {
        command
    }
}

pub enum Prepared {
    Run(Box<Docking>),
    /// A run for each pair of conformations.
    Ensemble(Box<Ensemble>),
}

impl Prepared {
    /// The directory that holds something else, which is not to be replaced.
    pub fn in_the_way(&self) -> Option<&Path> {
        match self {
            Self::Run(docking) => docking.in_the_way(),
            Self::Ensemble(ensemble) => ensemble.in_the_way(),
        }
    }

    pub fn is_done(&self, console: Console) -> bool {
        match self {
            Self::Run(docking) => docking.is_done(),
            Self::Ensemble(ensemble) => ensemble.is_done(console),
        }
    }

    /// Docks, and writes what comes of it; the JSON object. What ended commands left there is said on `notices`.
    pub fn run(self, console: Console, notices: Console) -> Result<Value, Error> {
        match self {
            Self::Run(docking) => docking.run(console, notices),
            Self::Ensemble(ensemble) => ensemble.run(console, notices),
        }
    }
}

/// Heading of the options that choose others.
const WITHIN: &str = "Within an error or a time";

/// Arguments on the place of a run: these and options of the machine alone go with `--rerun`; a batch sets them.
pub const PLACE: [&str; 3] = ["rerun", "output", "force"];

/// The command of [`Dock`] in which `--rerun` goes with nothing that the run.json records.
pub fn refusing_recorded(command: Command) -> Command {
    let of_machine = |name: &str| option_named(name).is_some_and(|one| one.subject() == "machine");
    let recorded: Vec<Id> = command
        .get_arguments()
        .map(Arg::get_id)
        .filter(|id| !PLACE.contains(&id.as_str()) && !of_machine(id.as_str()))
        .cloned()
        .collect();
    command.mut_arg("rerun", |rerun| rerun.conflicts_with_all(recorded))
}

impl Dock {
    pub fn names_its_run(&self) -> bool {
        self.output.is_some()
    }

    /// Refuses a file of options that cannot be read.
    pub fn check_config(&self) -> Result<(), Error> {
        self.options.given().map(drop)
    }

    /// Threads that the options name, and whether the run is docked alone: with a time limit or a graphics processor.
    pub fn own_threads(&self) -> Result<(Option<usize>, bool), Error> {
        let options = self.options.given()?.options;
        let is_alone = self.budget.is_some() || options.engine() != EngineChoice::Cpu;
        Ok((options.machine.threads, is_alone))
    }

    fn request(&self, given: GivenOptions) -> Result<Request, Error> {
        if !self.from_model.is_empty() {
            return Request::from_model(&self.from_model, given);
        }
        let given = given.of_rings()?;
        let symmetry = given.options.search.symmetry;
        // Of a ring the ligand is another copy of the receptor.
        let ligand = match symmetry {
            Some(_) if self.ligand.is_some() => {
                return Err(Error::input(
                    "--symmetry docks copies of RECEPTOR, and LIGAND is given too",
                )
                .help("leave LIGAND out, or remove `symmetry` from the file of options"));
            }
            Some(_) => self.receptor.as_ref(),
            None => self.ligand.as_ref(),
        };
        let (Some(receptor), Some(ligand)) = (&self.receptor, ligand) else {
            return Err(Error::input("a receptor and a ligand are needed").help(
                "give both files, or one with --symmetry C2 (C3, D2 ...) for a ring of its copies",
            ));
        };
        let native = self.native.read()?;
        let bodies = Bodies::read(receptor, ligand, &given.options)?;
        Ok(Request::of(bodies, native, given))
    }

    /// Reads, plans and hands the docking on to `then`, on `count` threads or those that the options name.
    pub fn prepared<T: Send>(
        self,
        console: Console,
        count: Option<usize>,
        then: impl FnOnce(Prepared) -> Result<T, Error> + Send,
    ) -> Result<T, Error> {
        let clock = Clock::start();
        process::begin();
        let mut given = self.options.given()?;
        if let Some(count) = count {
            given.options.machine.threads = count.into();
        }
        // Known before anything is read, for reading takes memory, too.
        given.options.machine = settled(&given.options.machine);
        threads::on(given.options.machine.thread_count(), || {
            then(self.prepare(given, clock, console)?)
        })?
    }

    /// The conformations of both sides, where options name any.
    fn sides(&self) -> Result<Option<[Vec<Conformation>; 2]>, Error> {
        let ConformationArguments {
            receptor_models,
            ligand_models,
            receptor_also,
            ligand_also,
        } = &self.conformations;
        let (Some(receptor), Some(ligand), true) =
            (&self.receptor, &self.ligand, self.conformations.are_given())
        else {
            return Ok(None);
        };
        Ok(Some([
            conformations(receptor, receptor_also, receptor_models.as_ref())?,
            conformations(ligand, ligand_also, ligand_models.as_ref())?,
        ]))
    }

    fn prepare(
        self,
        given: GivenOptions,
        clock: Clock,
        console: Console,
    ) -> Result<Prepared, Error> {
        let wanted = RunTarget {
            accuracy: self.accuracy,
            budget: self.budget,
        };
        let request = match (&self.rerun, self.sides()?) {
            (Some(path), _) => Request::recorded(path, given.options.machine, console)?,
            (None, None) => self.request(given)?,
            (None, Some([receptors, ligands])) => {
                let native = self.native.read()?;
                if let ([receptor], [ligand]) = (receptors.as_slice(), ligands.as_slice()) {
                    let specs = [receptor.spec.clone(), ligand.spec.clone()];
                    Request::of(Bodies::of(specs, &given.options)?, native, given)
                } else {
                    check_wanted(wanted, &given.options)?;
                    let sides = [receptors, ligands];
                    let directory = self.output.unwrap_or_else(|| named_after(&sides));
                    let request = EnsembleRequest {
                        given,
                        native,
                        wanted,
                        directory,
                        force: self.force,
                    };
                    let ensemble = Ensemble::prepare(&sides, request, clock, console)?;
                    return Ok(Prepared::Ensemble(Box::new(ensemble)));
                }
            }
        };
        let directory = self.output.unwrap_or_else(|| request.directory());
        check_wanted(wanted, &request.options)?;
        let docking = Docking::prepare(request, wanted, (directory, self.force), clock, console)?;
        Ok(Prepared::Run(Box::new(docking)))
    }

    pub fn run(self, console: Console) -> Result<(), Error> {
        let done = self.prepared(console, None, |prepared| prepared.run(console, console))?;
        console.result(&done)?;
        Ok(())
    }
}

/// The directory of an ensemble that names none: that of the run of its first conformations.
fn named_after(sides: &[Vec<Conformation>; 2]) -> PathBuf {
    let [receptor, ligand] = sides.each_ref().map(|side| {
        let spec = &side[0].spec;
        label(&spec.path, spec.chains.as_deref())
    });
    PathBuf::from(format!("knotdock_{receptor}_{ligand}"))
}

/// Refuses options for which nothing can be chosen by an error or a time.
fn check_wanted(wanted: RunTarget, options: &DockOptions) -> Result<(), Error> {
    if wanted == RunTarget::default() {
        return Ok(());
    }
    if options.search.engine != EngineChoice::Cpu {
        let error =
            "--accuracy and --budget use the times of the CPU, and the engine is gpu or auto";
        return Err(Error::input(error)
            .help("set --rotations, --tolerance and --spacing, or dock with --engine cpu"));
    }
    if options.search.symmetry.is_some() {
        return Err(
            Error::input("--accuracy and --budget do not work with --symmetry")
                .help("set --rotations, --tolerance and --spacing"),
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock::options::definition::Form;
    use knotdock::options::definitions;

    /// Each option that run.json records is refused beside `--rerun`, and so are the names of the inputs; options of
    /// the machine are not.
    #[test]
    fn rerun_goes_with_nothing_that_is_recorded() {
        let run = |word: &str| {
            let command = refusing_recorded(Dock::augment_args(Command::new("dock")));
            let words = ["dock", "--rerun=run.json", "-o", "out", "--force", word];
            command.try_get_matches_from(words).map(drop)
        };
        for option in definitions().iter().filter(|one| !one.is_of_files()) {
            let value = match option.name() {
                "sample_weights" => "unit",
                "sampler" => "bi",
                "precision" => "double",
                "antibody" => "whole",
                "waters" | "hetatm" | "hydrogens" => "keep",
                "effects" => "shape",
                "symmetry" => "C3",
                "fine_share" => "0.5",
                "engine" => "gpu",
                "sample_grid" => "2^12",
                _ => "1",
            };
            let word = match option.form() {
                Form::Flag => format!("--{}", option.long()),
                _ => format!("--{}={value}", option.long()),
            };
            let refused = run(&word).is_err();
            assert_eq!(refused, option.subject() != "machine", "{word}");
        }
        for word in [
            "receptor.pdb",
            "--native=a.pdb",
            "--budget=5s",
            "--config=a.toml",
        ] {
            assert!(run(word).is_err(), "{word}");
        }
    }
}
