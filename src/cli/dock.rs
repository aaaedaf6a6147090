//! `knotdock dock`: from two structures to a ranked list of poses and complexes.

use std::path::PathBuf;

use clap::Args;
use knotdock::options::EngineChoice;
use knotdock::output::run_options::RunOptions;
use knotdock::tradeoff::choice::Wanted;
use knotdock_scoring::symmetry::Symmetry;

use crate::cli::arguments::machine::MachineArguments;
use crate::cli::arguments::native::NativeArguments;
use crate::cli::arguments::reading::ReadingArguments;
use crate::cli::arguments::search::{RANKING, SearchArguments, TRADE_OFFS};
use crate::cli::arguments::values::{above_zero, duration};
use crate::cli::docking::{Clock, Docking};
use crate::cli::inputs::bodies::Bodies;
use crate::cli::inputs::request::Request;
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;

/// Dock a ligand to a receptor and rank the poses: two molecules, or two meshes in one unit of length.
///
/// Writes poses.csv, top/rank_0001.pdb ... (of meshes .obj) and run.json into a directory of the run. The same input and options give the
/// same bytes for any number of threads.
#[derive(Args, Debug)]
pub struct Dock {
    /// What stays: a molecule (.pdb, .ent or .cif, each also .gz; FILE:H,L picks chains by the author's names, FILE:H:1-120,L
    /// residues too) or a mesh (.stl, .obj, .ply or .off).
    #[arg(required_unless_present = "rerun", value_name = "RECEPTOR")]
    receptor: Option<String>,
    /// What moves, likewise and of the same kind.
    #[arg(required_unless_present_any = ["rerun", "symmetry"], value_name = "LIGAND")]
    ligand: Option<String>,
    /// Dock copies of RECEPTOR, given without LIGAND, into a ring: C2, C3 ... for 2, 3 ... copies about an axis; or, where RECEPTOR is itself a ring of 2, 3 ...
    /// copies, two such rings face to face: D2, D3 ... --rotations then counts axes, and each pose is where the second copy or ring goes. Residues that
    /// --block-receptor and --active-receptor name are those of every copy, or of both rings.
    #[arg(long, value_name = "Cn|Dn", conflicts_with_all = NO_RING)]
    symmetry: Option<Symmetry>,
    /// Directory of the run [default: knotdock_RECEPTOR_LIGAND].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace the run in the directory, once the new one is done.
    #[arg(long)]
    force: bool,
    /// Repeat the run that wrote this run.json: its inputs, checked by SHA-256, and its options.
    #[arg(long, value_name = "RUN.JSON", conflicts_with_all = RECORDED)]
    rerun: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingArguments,
    #[command(flatten)]
    search: SearchArguments,
    /// Take the cheapest tolerance and spacing, and double precision where it needs that, whose error is expected to be within X: rms over the best
    /// grid poses, as a share of the best score.
    #[arg(long, value_name = "X", value_parser = above_zero, conflicts_with_all = ["tolerance", "spacing"], help_heading = TRADE_OFFS)]
    accuracy: Option<f64>,
    /// End within a time on the clock, such as 5s or 2min, reading and writing included. As many rotations are planned as are
    /// expected to fit, but no more than 56,250; where the machine is slower than expected the search stops earlier, and
    /// run.json records where, so that the run can be repeated. `knotdock calibrate` measures how fast this machine is.
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

/// What no ring can have.
const NO_RING: [&str; 6] = [
    "ligand",
    "angle",
    "accuracy",
    "budget",
    "block_ligand",
    "active_ligand",
];

/// What run.json records, so that none of it goes with --rerun.
const RECORDED: [&str; 59] = [
    "receptor",
    "ligand",
    "symmetry",
    "waters",
    "hetatm",
    "drop_residue",
    "hydrogens",
    "altloc",
    "model",
    "assembly",
    "min_plddt",
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
    "engine",
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
    "active_weight",
    "peptidase_weight",
    "unresolved_weight",
    "termini_weight",
    "active_receptor",
    "active_ligand",
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
    /// Whether options say where the run goes.
    pub fn names_its_run(&self) -> bool {
        self.output.is_some()
    }

    /// What the command line asks for.
    fn request(&self) -> Result<Request, Failure> {
        // Of a ring the ligand is another copy of the receptor.
        let ligand = self.ligand.as_ref().or(match self.symmetry {
            Some(_) => self.receptor.as_ref(),
            None => None,
        });
        let (Some(receptor), Some(ligand)) = (&self.receptor, ligand) else {
            return Err(Failure::input("a receptor and a ligand are needed"));
        };
        let reading = self.reading.options();
        Ok(Request {
            bodies: Bodies::read(receptor, ligand, &reading)?,
            native: self.native.read()?,
            options: RunOptions {
                reading,
                dock: match self.symmetry {
                    Some(symmetry) => self.search.ring_options(symmetry)?,
                    None => self.search.options()?,
                },
                write_top: self.write_top,
            },
            offset: self.search.offset(),
            given: self.search.given_lengths(),
        })
    }

    /// Reads and plans.
    pub fn prepare(self, console: Console) -> Result<Docking, Failure> {
        let clock = Clock::start();
        let mut request = match &self.rerun {
            Some(path) => Request::recorded(path, console)?,
            None => self.request()?,
        };
        self.machine.apply(&mut request.options.dock);
        let directory = self.output.unwrap_or_else(|| request.directory());
        let wanted = Wanted {
            accuracy: self.accuracy,
            budget: self.budget,
        };
        if wanted != Wanted::default() && request.options.dock.engine == EngineChoice::Gpu {
            let error =
                "--accuracy and --budget rest on what the CPU takes, and --engine gpu is asked for";
            return Err(Failure::input(error)
                .remedy("set --rotations, --tolerance and --spacing, or dock with --engine cpu"));
        }
        Docking::prepare(request, wanted, (directory, self.force), clock, console)
    }

    /// Docks.
    pub fn run(self, console: Console) -> Result<(), Failure> {
        let done = self.prepare(console)?.run(console)?;
        console.result(&done)?;
        Ok(())
    }
}
