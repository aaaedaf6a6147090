//! `knotdock export`: further complexes from a finished run.

use std::path::PathBuf;

use clap::Args;
use knotdock::options::Threads;
use knotdock::output::files::complexes::file_names;
use knotdock::output::files::exported::ExportFolder;
use knotdock::output::records::recorded_run::RecordedRun;
use knotdock::output::tables::poses::PoseRow;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::threads;
use serde_json::json;

use crate::cli::arguments::output_file::check_not_read;
use crate::cli::arguments::ranks::Ranks;
use crate::cli::inputs::bodies::Bodies;
use crate::cli::inputs::ranked_rows::ranked_rows;
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
        let run_path = self.run.join("run.json");
        let run = RecordedRun::read(&run_path)?;
        let table_path = self.run.join("poses.csv");
        let rows = ranked_rows(&table_path, &self.rank)?;
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
        let own = self.run.join("top");
        let folder = self.output.unwrap_or(own);
        for name in rows.iter().flat_map(|row| file_names(row.rank)) {
            let read = bodies.records().map(|record| record.path.as_path());
            check_not_read(&folder.join(name), read)?;
        }
        let export = ExportFolder::open(&folder, &self.run)?;
        let written = bodies.write(&rows, arrangement, export.staged())?;
        export.place(self.force)?;
        let paths: Vec<String> = written
            .names
            .iter()
            .map(|name| folder.join(name).display().to_string())
            .collect();
        console.say(paths.join("\n"));
        let files = rows.iter().zip(&paths);
        console.result(&json!({
            "files": files.map(|(row, path)| json!({ "rank": row.rank, "path": path })).collect::<Vec<_>>(),
            "chains": written.chains,
        }))?;
        Ok(())
    }
}
