//! `knotdock refine`: chosen poses of a finished run, refined at atomic resolution.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use serde_json::json;

use crate::arguments::machine::Threads;
use crate::arguments::output_file::{check_not_read, is_same};
use crate::arguments::ranks::Ranks;
use crate::inputs::bodies::Bodies;
use crate::inputs::molecules::Input;
use crate::inputs::native::{NativeArguments, NativeFiles};
use crate::messages::console::Console;
use crate::records::recorded_run::RecordedRun;
use crate::refining::{MatchedNative, Refining, Written, objects, write_table};
use crate::tables::report::counted;
use knotdock::options::values::{NOT_NEGATIVE, in_range};
use knotdock::output::files::added::Addition;
use knotdock::output::files::complexes::file_names;
use knotdock::output::files::staging::put_back;
use knotdock::output::tables::poses::{PoseRow, PoseTable};
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::refine::RefineOptions;
use knotdock::threads;
use knotdock_structures::Error;

/// Refine chosen poses of a run at atomic resolution: the ligand moves, and side chains of the interface are packed.
///
/// Writes one complex per rank and the table refined.csv into its own directory. The run stays as it is.
#[derive(Args, Debug)]
pub struct Refine {
    /// Directory of the run.
    #[arg(value_name = "DIR")]
    run: PathBuf,
    /// Ranks in poses.csv, such as 1-50 or 3,7.
    #[arg(long, alias = "rank", value_name = "RANKS")]
    ranks: Ranks,
    /// Farthest that the ligand may move, as the RMSD of its atoms, in Å; a lower energy farther away is another pose.
    #[arg(long, value_name = "ANGSTROM", default_value_t = 3.0, value_parser = in_range::<f64>(NOT_NEGATIVE))]
    max_move: f64,
    /// Leave the ligand where it is.
    #[arg(long, conflicts_with_all = ["no_side_chains", "max_move"])]
    no_move: bool,
    /// Leave the side chains as they are.
    #[arg(long)]
    no_side_chains: bool,
    /// Directory to write to [default: DIR/refined].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace files that are there and differ, even if someone has edited them.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    native: NativeArguments,
    #[command(flatten)]
    threads: Threads,
}

const TABLE: &str = "refined.csv";

impl Refine {
    pub fn run(self, console: Console) -> Result<(), Error> {
        threads::on(self.threads.count(), || self.refine(console))?
    }

    fn refine(self, console: Console) -> Result<(), Error> {
        let start = Instant::now();
        put_back(&self.run)?;
        let run_path = self.run.join("run.json");
        let run = RecordedRun::read(&run_path)?;
        refuse_ring(&run, &run_path)?;
        let table_path = self.run.join("poses.csv");
        let table = PoseTable::read(&table_path)?;
        let places = self.ranks.places(&table, &table_path)?.into_iter();
        let rows: Vec<PoseRow> = places.map(|place| table.rows()[place]).collect();
        let [receptor, ligand] = &*molecules(&run, &run_path)?;
        let native = match (self.native.read()?, &run.inputs.native) {
            (Some(files), _) => Some(files),
            (None, Some(record)) => Some(NativeFiles::recorded(record, &run_path)?),
            (None, None) => None,
        };
        let folder = self.folder()?;
        self.refuse_other_ranks(&folder, &rows)?;
        let natives = native.iter().flat_map(NativeFiles::inputs);
        let read: Vec<&Path> = [receptor, ligand]
            .into_iter()
            .chain(natives)
            .map(|input| input.record.path.as_path())
            .collect();
        let complexes = rows.iter().flat_map(|row| file_names(row.rank));
        for name in complexes.chain([TABLE.to_owned()]) {
            check_not_read(&folder.join(name), read.iter().copied())?;
        }
        let pair = [&receptor.molecule, &ligand.molecule];
        let known = native.and_then(|files| MatchedNative::new(files, pair, console));
        let options = RefineOptions {
            moves: !self.no_move,
            max_move: self.max_move,
            side_chains: !self.no_side_chains,
            ph: run.options.terms.ph,
        };
        let export = Addition::open(&folder, Some(&self.run))?;
        console.warn_leftovers(&export.leftovers);
        let refining = Refining::new(pair, options, known.as_ref(), export.stage().folder())?;
        let written = refining.all(&rows, console)?;
        let table = |file: &mut dyn Write| write_table(file, &written.table);
        export.stage().write(TABLE, table)?;
        export.place(self.force)?;
        let seconds = start.elapsed().as_secs_f64();
        report(&written, known.as_ref(), &folder, seconds, console)
    }

    /// Refuses a directory with poses of other ranks, before anything is refined: its table would not have them.
    fn refuse_other_ranks(&self, folder: &Path, rows: &[PoseRow]) -> Result<(), Error> {
        let path = folder.join(TABLE);
        // A pipe there would be waited for; it is refused when the table is written.
        let table = path.is_file().then(|| PoseTable::read(&path).ok());
        let Some(table) = table.flatten() else {
            return Ok(());
        };
        let ranks = |rows: &[PoseRow]| rows.iter().map(|row| row.rank).collect::<Vec<_>>();
        if self.force || ranks(table.rows()) == ranks(rows) {
            return Ok(());
        }
        Err(held(folder, "of other ranks"))
    }

    /// The directory to write to: not the run's own, whose complexes are those of its ranking.
    fn folder(&self) -> Result<PathBuf, Error> {
        let own = self.run.join("refined");
        let folder = self.output.clone().unwrap_or(own);
        let of_run = [self.run.clone(), self.run.join("top")];
        if of_run.iter().any(|own| is_same(own, &folder)) {
            return Err(Error::input(
                "that directory holds the run itself, and refined complexes have the same names",
            )
            .at(&folder)
            .help("choose another directory with -o"));
        }
        Ok(folder)
    }
}

/// The refusal of a directory with refined poses that differ from those to write, as `at` shows: `how` says in what.
fn held(at: &Path, how: &str) -> Error {
    Error::input(format!("the directory holds poses refined {how}"))
        .at(at)
        .help("choose another directory with -o, or pass --force to replace them")
}

/// Refuses the run of a ring, whose copies would each need their own move and side chains.
fn refuse_ring(run: &RecordedRun, run_path: &Path) -> Result<(), Error> {
    let arrangement = Arrangement::from(run.options.search.symmetry);
    if !arrangement.is_ring() {
        return Ok(());
    }
    Err(Error::input(format!(
        "the run is{}, and rings are not refined: a copy that moves by itself leaves the ring, and packed side chains \
         would differ from copy to copy",
        arrangement.suffix()
    ))
    .at(run_path)
    .help("refine a run of two molecules; `knotdock export` writes complexes of rings"))
}

fn molecules(run: &RecordedRun, run_path: &Path) -> Result<Box<[Input; 2]>, Error> {
    match Bodies::recorded(run.inputs.pair(), run_path, &run.options)? {
        Bodies::Molecules(inputs) => Ok(inputs),
        Bodies::Meshes(_) => Err(Error::input(
            "this is a run of meshes, which have no atoms to refine",
        )
        .at(run_path)
        .help("refine a run of two molecules; `knotdock export` writes assemblies of meshes")),
    }
}

/// Reports the written files and their cost in seconds of wall time.
fn report(
    written: &Written,
    known: Option<&MatchedNative>,
    folder: &Path,
    seconds: f64,
    console: Console,
) -> Result<(), Error> {
    let path = |name: &str| folder.join(name).display().to_string();
    let cpu = written.cpu_seconds_per_pose;
    let cost = cpu.map(|cpu| format!(", {cpu:.2} s of a processor each,"));
    console.say(format!("\n{}\n", written.listing()));
    console.say(format!(
        "{} refined in {seconds:.1} s{} in {}",
        counted(written.table.len(), "pose"),
        cost.unwrap_or_default(),
        folder.display()
    ));
    let rows = objects(&written.table).into_iter();
    let poses = rows.zip(&written.table).map(|(mut row, written)| {
        row.insert("path".to_owned(), json!(path(&written.file)));
        row.insert("held".to_owned(), json!(written.refined.held));
        row
    });
    console.result(&json!({
        "directory": folder.display().to_string(),
        "table": path(TABLE),
        "poses": poses.collect::<Vec<_>>(),
        "chains": written.chains,
        "match": known.map(|known| known.evaluator.report()),
        "seconds": seconds,
        "cpu_seconds_per_pose": cpu,
    }))
}
