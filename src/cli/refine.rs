//! `knotdock refine`: chosen poses of a finished run, refined at atomic resolution.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use knotdock::evaluate::{Evaluator, PoseQuality};
use knotdock::options::Threads;
use knotdock::output::files::complexes::{file_names, write_complexes};
use knotdock::output::files::exported::ExportFolder;
use knotdock::output::files::whole_file::write_whole;
use knotdock::output::records::recorded_run::RecordedRun;
use knotdock::output::tables::poses::PoseRow;
use knotdock::output::tables::refined::{self, RefinedRow};
use knotdock::output::tables::report;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::progress::Progress;
use knotdock::refine::{RefineOptions, Refined, Refiner};
use knotdock::threads;
use knotdock_scoring::sharp::PairList;
use knotdock_structures::knots::KnotsError;
use knotdock_structures::molecule::{ChainMap, Molecule};
use rayon::prelude::*;
use serde_json::json;

use crate::cli::arguments::native::{NativeArguments, NativeFiles, announce};
use crate::cli::arguments::output_file::{check_not_read, is_same};
use crate::cli::arguments::ranks::Ranks;
use crate::cli::inputs::bodies::Bodies;
use crate::cli::inputs::molecules::Input;
use crate::cli::inputs::ranked_rows::ranked_rows;
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;
use crate::cli::messages::set_aside::finish_before_reading;

/// Refine chosen poses of a run at atomic resolution: the ligand moves, and side chains of the interface are packed.
///
/// Writes a complex a rank and the table refined.csv into a directory of its own. The run stays as it is.
#[derive(Args, Debug)]
pub struct Refine {
    /// Directory of the run.
    #[arg(value_name = "DIR")]
    run: PathBuf,
    /// Ranks in poses.csv, such as 1-50 or 3,7.
    #[arg(long, value_name = "RANKS")]
    ranks: Ranks,
    /// Leave the ligand where it is.
    #[arg(long, conflicts_with = "no_side_chains")]
    no_move: bool,
    /// Leave the side chains as they are.
    #[arg(long)]
    no_side_chains: bool,
    /// Directory to write to [default: DIR/refined].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace files that are there and differ, be it that someone has edited them.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    native: NativeArguments,
    #[command(flatten)]
    threads: Threads,
}

/// Name of the table.
const TABLE: &str = "refined.csv";

/// What was written of a pose.
struct Written {
    row: RefinedRow,
    /// Name of the complex.
    name: String,
    chains: ChainMap,
    /// Time of one thread.
    seconds: f64,
}

/// A known complex, matched with the molecules as docked.
struct Known {
    files: NativeFiles,
    evaluator: Evaluator,
}

impl Refine {
    /// Refines.
    pub fn run(self, console: Console) -> Result<(), Failure> {
        threads::on(self.threads.count(), || self.refine(console))?
    }

    /// Refines on the threads of the caller.
    fn refine(self, console: Console) -> Result<(), Failure> {
        let start = Instant::now();
        finish_before_reading(&self.run, console)?;
        let run_path = self.run.join("run.json");
        let run = RecordedRun::read(&run_path)?;
        refuse_ring(&run, &run_path)?;
        let rows = ranked_rows(&self.run.join("poses.csv"), &self.ranks)?;
        let [receptor, ligand] = &*molecules(&run, &run_path)?;
        let native = match (self.native.read()?, &run.native) {
            (Some(files), _) => Some(files),
            (None, Some(record)) => Some(NativeFiles::recorded(record, &run_path)?),
            (None, None) => None,
        };
        let folder = self.folder()?;
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
        let known = native.map(|files| Known::new(files, pair)).transpose()?;
        if let Some(known) = &known {
            announce(&known.evaluator, console);
        }
        let options = RefineOptions {
            moves: !self.no_move,
            side_chains: !self.no_side_chains,
            ph: run.options.terms.ph,
        };
        let export = ExportFolder::open(&folder, &self.run)?;
        let task = Task {
            refiner: Refiner::new(pair, options).map_err(|error| unusable(&error))?,
            pair,
            known: known.as_ref(),
            staged: export.staged(),
        };
        let written = task.all(&rows, console)?;
        let seconds = written.iter().map(|written| written.seconds).sum::<f64>();
        let mut chains = None;
        let (mut table, mut names) = (Vec::new(), Vec::new());
        for written in written {
            table.push(written.row);
            names.push(written.name);
            chains = Some(written.chains);
        }
        write_whole(&export.staged().join(TABLE), |file| {
            refined::write_to(file, &table)
        })?;
        export.place(self.force)?;

        let per_pose = seconds / table.len().max(1) as f64;
        let wall = start.elapsed().as_secs_f64();
        let path = |name: &str| folder.join(name).display().to_string();
        console.say(format!("{}\n", listing(&table)));
        console.say(format!(
            "{} refined in {wall:.1} s, {per_pose:.2} s of a thread each, in {}",
            report::counted(table.len(), "pose"),
            folder.display()
        ));
        let poses = refined::objects(&table).into_iter().zip(&names);
        let poses = poses.map(|(mut row, name)| {
            row.insert("path".to_owned(), json!(path(name)));
            row
        });
        console.result(&json!({
            "directory": folder.display().to_string(),
            "table": path(TABLE),
            "poses": poses.collect::<Vec<_>>(),
            "chains": chains,
            "match": known.as_ref().map(|known| known.evaluator.report()),
            "seconds": wall,
            "seconds_per_pose": per_pose,
        }))
    }

    /// The directory to write to: not the run's own, whose complexes are those of its ranking.
    fn folder(&self) -> Result<PathBuf, Failure> {
        let own = self.run.join("refined");
        let folder = self.output.clone().unwrap_or(own);
        let of_run = [self.run.clone(), self.run.join("top")];
        if of_run.iter().any(|own| is_same(own, &folder)) {
            return Err(Failure::input(
                "that directory holds the run itself, and refined complexes have the same names",
            )
            .at(&folder)
            .remedy("choose another directory with -o"));
        }
        Ok(folder)
    }
}

/// Refuses the run of a ring, whose copies would each need a move and side chains of their own.
fn refuse_ring(run: &RecordedRun, run_path: &Path) -> Result<(), Failure> {
    let arrangement = Arrangement::from(run.options.search.symmetry);
    if !arrangement.is_ring() {
        return Ok(());
    }
    Err(Failure::input(format!(
        "the run is{}, and rings are not refined: a copy that moves by itself leaves the ring, and packed side chains \
         would differ from copy to copy",
        arrangement.suffix()
    ))
    .at(run_path)
    .remedy("refine a run of two molecules; `knotdock export` writes complexes of rings"))
}

/// The two molecules of a run.
fn molecules(run: &RecordedRun, run_path: &Path) -> Result<Box<[Input; 2]>, Failure> {
    match Bodies::recorded([&run.receptor, &run.ligand], run_path, &run.options)? {
        Bodies::Molecules(inputs) => Ok(inputs),
        Bodies::Meshes(_) => Err(Failure::input(
            "this is a run of meshes, which have no atoms to refine",
        )
        .at(run_path)
        .remedy("refine a run of two molecules; `knotdock export` writes assemblies of meshes")),
    }
}

fn unusable(error: &KnotsError) -> Failure {
    Failure::input(error).remedy("dock the molecules again, which names the fault")
}

impl Known {
    fn new(files: NativeFiles, [receptor, ligand]: [&Molecule; 2]) -> Result<Self, Failure> {
        let evaluator = files.evaluator(receptor, ligand)?;
        Ok(Self { files, evaluator })
    }

    /// Qualities of a pose and of what it was refined to.
    fn qualities(&self, row: &PoseRow, refined: &Refined) -> Result<[PoseQuality; 2], Failure> {
        let after = match &refined.packed {
            None => self.evaluator.evaluate(&refined.pose),
            // Contacts are of all heavy atoms, so packed molecules are matched anew.
            Some([receptor, ligand]) => self
                .files
                .evaluator(receptor, ligand)?
                .evaluate(&refined.pose),
        };
        Ok([self.evaluator.evaluate(&row.pose), after])
    }
}

/// What all poses are refined with.
struct Task<'a> {
    refiner: Refiner<'a>,
    pair: [&'a Molecule; 2],
    known: Option<&'a Known>,
    /// Folder that complexes are written into.
    staged: &'a Path,
}

impl Task<'_> {
    /// Refines and writes the poses of some rows, in their order.
    fn all(&self, rows: &[PoseRow], console: Console) -> Result<Vec<Written>, Failure> {
        let progress = console.progress();
        progress.stage("refining", rows.len() as u64);
        let one = |list: &mut PairList, row: &PoseRow| {
            let written = self.one(row, list);
            progress.advance(1);
            written
        };
        rows.par_iter().map_init(PairList::default, one).collect()
    }

    /// Refines and writes a pose. Its packed molecules are dropped: those of many poses may not fit into the memory.
    fn one(&self, row: &PoseRow, list: &mut PairList) -> Result<Written, Failure> {
        let start = Instant::now();
        let mut refined = self
            .refiner
            .refine(&row.pose, list)
            .map_err(|error| unusable(&error))?;
        let seconds = start.elapsed().as_secs_f64();
        let quality = self.known.map(|known| known.qualities(row, &refined));
        let quality = quality.transpose()?;
        let packed = refined.packed.take();
        let molecules = packed
            .as_ref()
            .map_or(self.pair, |[receptor, ligand]| [receptor, ligand]);
        let placed = PoseRow {
            rank: row.rank,
            pose: refined.pose,
        };
        let mut written =
            write_complexes(molecules, Arrangement::from(None), &[placed], self.staged)?;
        Ok(Written {
            row: RefinedRow {
                rank: row.rank,
                refined,
                quality,
            },
            name: written.names.pop().unwrap_or_default(),
            chains: written.chains,
            seconds,
        })
    }
}

/// The poses as a table for the terminal.
fn listing(rows: &[RefinedRow]) -> String {
    let has_native = rows.iter().any(|row| row.quality.is_some());
    let mut header = vec!["rank", "moved", "energy", "clashes", "side chains"];
    if has_native {
        header.extend(["irmsd", "dockq"]);
    }
    let mut lines = vec![header.into_iter().map(str::to_owned).collect()];
    for row in rows {
        let Refined { before, after, .. } = &row.refined;
        let packing = row.refined.packing.as_ref();
        let mut line = vec![
            row.rank.to_string(),
            format!("{:.2}", row.refined.rmsd_moved),
            format!("{:.1} -> {:.1}", before.total(), after.total()),
            format!("{} -> {}", before.clashes, after.clashes),
            packing.map_or(String::new(), |packing| packing.moved.to_string()),
        ];
        if let Some([before, after]) = &row.quality {
            line.push(format!("{:.2} -> {:.2}", before.irmsd, after.irmsd));
            line.push(format!("{:.3} -> {:.3}", before.dockq, after.dockq));
        }
        lines.push(line);
    }
    report::align(&lines)
}
