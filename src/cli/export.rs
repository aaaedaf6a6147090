//! `knotdock export`: further complexes from a finished run.

use std::path::{Path, PathBuf};

use clap::Args;
use knotdock::options::Threads;
use knotdock::output::files::complexes::file_names;
use knotdock::output::files::exported::ExportFolder;
use knotdock::output::records::recorded_run::RecordedRun;
use knotdock::output::tables::poses::{PoseRow, PoseTable};
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::threads;
use knotdock_structures::molecule::ChainMap;
use serde_json::json;

use crate::cli::arguments::output_file::check_not_read;
use crate::cli::arguments::ranks::Ranks;
use crate::cli::ensemble::finished::{RunRows, runs};
use crate::cli::inputs::bodies::Bodies;
use crate::cli::inputs::ranked_rows::ranked_places;
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;
use crate::cli::messages::set_aside::finish_before_reading;

/// Write complexes (or assemblies of meshes) of chosen ranks of a run, receptor and placed ligand in one file.
#[derive(Args, Debug)]
pub struct Export {
    /// Directory of the run.
    #[arg(value_name = "DIR")]
    run: PathBuf,
    /// Ranks in poses.csv, such as 37,40-45.
    #[arg(long, value_name = "RANKS")]
    rank: Ranks,
    /// Directory to write to [default: DIR/top].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace complexes that are there and differ, be it that someone has edited them.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    threads: Threads,
}

impl Export {
    /// Writes the complexes.
    pub fn run(self, console: Console) -> Result<(), Failure> {
        threads::on(self.threads.count(), || self.export(console))?
    }

    /// Writes them on the threads of the caller.
    fn export(self, console: Console) -> Result<(), Failure> {
        finish_before_reading(&self.run, console)?;
        let own = self.run.join("top");
        let folder = self.output.clone().unwrap_or(own);
        let exports = self.exports(&folder)?;
        let export = ExportFolder::open(&folder, &self.run)?;
        let mut written: Vec<(usize, String, Option<ChainMap>)> = Vec::new();
        for Placed {
            rows,
            bodies,
            arrangement,
        } in &exports
        {
            let of_run = bodies.write(rows, *arrangement, export.staged())?;
            let names = rows.iter().zip(of_run.names);
            written.extend(names.map(|(row, name)| (row.rank, name, of_run.chains.clone())));
        }
        export.place(self.force)?;
        // As the user lists the ranks, whichever runs they are of.
        let place = |rank: usize| self.rank.0.iter().position(|listed| *listed == rank);
        written.sort_by_key(|(rank, _, _)| place(*rank));
        let path = |name: &str| folder.join(name).display().to_string();
        let paths: Vec<String> = written.iter().map(|(_, name, _)| path(name)).collect();
        console.say(paths.join("\n"));
        let is_one = exports.len() == 1;
        let chains = written.last().and_then(|(_, _, chains)| chains.clone());
        let files = written
            .iter()
            .zip(&paths)
            .map(|((rank, _, chains), path)| match is_one {
                true => json!({ "rank": rank, "path": path }),
                false => json!({ "rank": rank, "path": path, "chains": chains }),
            });
        console.result(&json!({
            "files": files.collect::<Vec<_>>(),
            "chains": chains.filter(|_| is_one),
        }))?;
        Ok(())
    }

    /// What is written: of an ensemble the rows of each member.
    fn exports(&self, folder: &Path) -> Result<Vec<Placed>, Failure> {
        let table_path = self.run.join("poses.csv");
        let table = PoseTable::read(&table_path)?;
        let places = ranked_places(&table, &table_path, &self.rank)?;
        let runs = runs(&self.run, &table, &places)?.into_iter();
        let exports = runs.map(|RunRows { run: run_path, rows }| {
            let run = RecordedRun::read(&run_path)?;
            let rows: Vec<PoseRow> = rows.into_iter().map(|place| table.rows()[place]).collect();
            let arrangement = Arrangement::from(run.options.search.symmetry);
            let is_no_ring = |row: &&PoseRow| arrangement.images(&row.pose).is_none();
            if let Some(PoseRow { rank, .. }) = rows.iter().find(is_no_ring) {
                let suffix = arrangement.suffix();
                return Err(Failure::input(format!(
                    "the pose of rank {rank} forms no ring{suffix}"
                ))
                .at(&table_path)
                .remedy("take the table as the run wrote it; `knotdock dock --rerun` makes it again"));
            }
            let bodies = Bodies::recorded([&run.receptor, &run.ligand], &run_path, &run.options)?;
            for name in rows.iter().flat_map(|row| file_names(row.rank)) {
                let read = bodies.records().map(|record| record.path.as_path());
                check_not_read(&folder.join(name), read)?;
            }
            Ok(Placed {
                rows,
                bodies,
                arrangement,
            })
        });
        exports.collect()
    }
}

/// Poses of a run, and what is placed by them.
struct Placed {
    rows: Vec<PoseRow>,
    bodies: Bodies,
    arrangement: Arrangement,
}
