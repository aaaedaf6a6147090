//! `knotdock dock`: from two structures to a ranked list of poses and complexes.

use std::path::PathBuf;

use clap::{Arg, Args, Command, Id};
use knotdock::dock::memory::process;
use knotdock::options::values::{above_zero, duration};
use knotdock::options::{DockOptions, EngineChoice, option_named};
use knotdock::threads;
use knotdock::tradeoff::choice::Wanted;

use crate::cli::arguments::machine::settled;
use crate::cli::arguments::native::NativeArguments;
use crate::cli::arguments::options::{GivenOptions, OfDock, OptionArguments};
use crate::cli::docking::{Clock, Docking};
use crate::cli::inputs::request::Request;
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;

/// Dock a ligand to a receptor and rank the poses: two molecules, or two meshes in one unit of length.
///
/// Writes poses.csv, top/rank_0001.pdb ... (of meshes .obj) and run.json into a directory of the run. The same input
/// and options give the same bytes for any number of threads, except with --budget.
#[derive(Args, Debug)]
pub struct Dock {
    /// What stays: a molecule (.pdb, .ent or .cif, each also .gz; FILE:H,L picks chains by the author's names,
    /// FILE:H:1-120,L residues too) or a mesh (.stl, .obj, .ply or .off).
    #[arg(required_unless_present = "rerun", value_name = "RECEPTOR")]
    receptor: Option<String>,
    /// What moves, likewise and of the same kind.
    #[arg(
        required_unless_present_any = ["rerun", "symmetry", "config"],
        conflicts_with = "symmetry",
        value_name = "LIGAND"
    )]
    ligand: Option<String>,
    /// Directory of the run [default: knotdock_RECEPTOR_LIGAND].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace the run in the directory, once the new one is done.
    #[arg(long)]
    force: bool,
    /// Repeat the run that wrote this run.json: its inputs, checked by SHA-256, and its options.
    #[arg(long, value_name = "RUN.JSON")]
    rerun: Option<PathBuf>,
    #[command(flatten)]
    options: OptionArguments<OfDock>,
    /// Take the cheapest tolerance and spacing, and double precision where it needs that, whose error is expected to
    /// be within X: rms over the best grid poses, as a share of the best score.
    #[arg(long, value_name = "X", value_parser = above_zero, help_heading = WITHIN)]
    #[arg(conflicts_with_all = ["tolerance", "spacing"], conflicts_with = "symmetry")]
    accuracy: Option<f64>,
    /// End within a time on the clock, such as 5s or 2min, reading and writing included. As many rotations are
    /// planned as are expected to fit, but no more than 56,250. Where the machine is slower than expected the search
    /// stops earlier, so that the same call need not give the same bytes. run.json records where: `--rerun` of it gives the
    /// same bytes. `knotdock calibrate` measures how fast
    /// this machine is.
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with_all = ["rotations", "symmetry"], help_heading = WITHIN)]
    budget: Option<f64>,
    #[command(flatten)]
    native: NativeArguments,
}

/// Heading of the options that choose others.
const WITHIN: &str = "Within an error or a time";

/// Arguments that say where a run is and where it goes. Beside options of the machine, only these go with `--rerun`,
/// and a batch sets them for its pairs.
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
    /// Whether options say where the run goes.
    pub fn names_its_run(&self) -> bool {
        self.output.is_some()
    }

    /// Refuses a file of options that cannot be read.
    pub fn check_config(&self) -> Result<(), Failure> {
        self.options.given().map(drop)
    }

    /// The run that the command line describes.
    fn request(&self, given: GivenOptions) -> Result<Request, Failure> {
        let given = given.of_rings()?;
        let symmetry = given.options.search.symmetry;
        // Of a ring the ligand is another copy of the receptor.
        let ligand = match symmetry {
            Some(_) if self.ligand.is_some() => {
                return Err(Failure::input("a ring is made of copies of one molecule")
                    .remedy("leave LIGAND out, or `symmetry` of the file of options"));
            }
            Some(_) => self.receptor.as_ref(),
            None => self.ligand.as_ref(),
        };
        let (Some(receptor), Some(ligand)) = (&self.receptor, ligand) else {
            return Err(Failure::input("a receptor and a ligand are needed"));
        };
        Request::read([receptor, ligand], self.native.read()?, given)
    }

    /// Reads and plans, and hands the docking on to `then`: all on the threads that the options name.
    pub fn prepared<T: Send>(
        self,
        console: Console,
        then: impl FnOnce(Docking) -> Result<T, Failure> + Send,
    ) -> Result<T, Failure> {
        let clock = Clock::start();
        process::begin();
        let mut given = self.options.given()?;
        // Known before anything is read, for reading takes memory, too.
        given.options.machine = settled(&given.options.machine);
        threads::on(given.options.machine.threads.count(), || {
            then(self.prepare(given, clock, console)?)
        })?
    }

    /// Reads and plans.
    fn prepare(
        self,
        given: GivenOptions,
        clock: Clock,
        console: Console,
    ) -> Result<Docking, Failure> {
        let request = match &self.rerun {
            Some(path) => Request::recorded(path, given.options.machine, console)?,
            None => self.request(given)?,
        };
        let directory = self.output.unwrap_or_else(|| request.directory());
        let wanted = Wanted {
            accuracy: self.accuracy,
            budget: self.budget,
        };
        if wanted != Wanted::default() {
            check_wanted(&request.options)?;
        }
        Docking::prepare(request, wanted, (directory, self.force), clock, console)
    }

    /// Docks.
    pub fn run(self, console: Console) -> Result<(), Failure> {
        let done = self.prepared(console, |docking| docking.run(console, console))?;
        console.result(&done)?;
        Ok(())
    }
}

/// Refuses options for which nothing can be chosen by an error or a time.
fn check_wanted(options: &DockOptions) -> Result<(), Failure> {
    if options.search.engine == EngineChoice::Gpu {
        let error = "--accuracy and --budget rest on what the CPU takes, and --engine gpu is given";
        return Err(Failure::input(error)
            .remedy("set --rotations, --tolerance and --spacing, or dock with --engine cpu"));
    }
    if options.search.symmetry.is_some() {
        return Err(
            Failure::input("--accuracy and --budget know nothing of rings")
                .remedy("set --rotations, --tolerance and --spacing"),
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock::options::definitions;

    /// Each option that run.json records is refused beside `--rerun`, and so is what names the inputs; options of the
    /// machine are not.
    #[test]
    fn rerun_goes_with_nothing_that_is_recorded() {
        let run = |word: &str| {
            let command = refusing_recorded(Dock::augment_args(Command::new("dock")));
            let words = ["dock", "--rerun=run.json", "-o", "out", "--force", word];
            command.try_get_matches_from(words).map(drop)
        };
        for option in definitions() {
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
            let word = if option.is_flag() {
                format!("--{}", option.long())
            } else if option.names_file() {
                continue;
            } else {
                option.word(value)
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
