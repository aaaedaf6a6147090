//! `knotdock report`: a page on which results are looked at.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use crate::arguments::machine::Threads;
use crate::inputs::bodies::Bodies;
use crate::inputs::request::KnownComplex;
use crate::messages::console::Console;
use crate::records::recorded_run::{RecordedRun, read_record};
use crate::report::{DirectoryKind, RunReport, Viewer, ViewerArguments, figures_of};
use knotdock::dock::pair::Pair;
use knotdock::output::files::added::Addition;
use knotdock::output::files::own_files::is_run;
use knotdock::output::files::seal::{REPORT, is_sealed};
use knotdock::output::files::staging::put_back;
use knotdock::output::tables::poses::PoseTable;
use knotdock::output::top_complexes::TopComplexes;
use knotdock::threads;
use knotdock_structures::Error;

/// Write report.html of runs, batches, ensembles and sweeps: results as a table, in three dimensions and in charts.
///
/// It opens in any browser, offline. `knotdock dock` writes it by itself; this writes it again, as after `knotdock
/// evaluate`, or with the view where the program was built without it.
#[derive(Args, Debug)]
pub struct Report {
    /// Directories that `dock`, `batch` or `tradeoff` wrote.
    #[arg(value_name = "DIR", required = true)]
    runs: Vec<PathBuf>,
    #[command(flatten)]
    viewer: ViewerArguments,
    /// Replace reports that someone has changed.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    threads: Threads,
}

impl Report {
    pub fn run(self, console: Console) -> Result<(), Error> {
        threads::on(self.threads.count(), || self.write(console))?
    }

    fn write(self, console: Console) -> Result<(), Error> {
        let viewer = self.viewer.read()?;
        let mut written: Vec<String> = Vec::new();
        for run in &self.runs {
            put_back(run)?;
            let path = run.join(REPORT);
            if path.symlink_metadata().is_ok() && !is_sealed(&path) && !self.force {
                return Err(
                    Error::input("the report there was changed since it was written")
                        .at(&path)
                        .help("keep it under another name, or pass --force to replace it"),
                );
            }
            let text = page(run, viewer.as_ref())?;
            console.warn_leftovers(&place(run, &text, self.force)?);
            console.say(path.display().to_string());
            written.push(path.display().to_string());
        }
        console.result(&json!({ "reports": written }))
    }
}

/// Writes the report of a batch into its directory. One that someone has changed stays.
pub fn write_batch_report(directory: &Path, console: Console) -> Result<(), Error> {
    let path = directory.join(REPORT);
    if path.symlink_metadata().is_ok() && !is_sealed(&path) {
        console.warn(format!(
            "{} was changed since it was written and is left unchanged; `knotdock report --force` replaces it",
            path.display()
        ));
        return Ok(());
    }
    console.warn_leftovers(&place(directory, &page(directory, None)?, true)?);
    Ok(())
}

/// Writes a report into a directory; what ended commands left there.
fn place(directory: &Path, text: &str, force: bool) -> Result<Vec<PathBuf>, Error> {
    let addition = Addition::open(directory, is_run(directory).then_some(directory))?;
    let leftovers = addition.leftovers.clone();
    let stage = addition.stage();
    stage.write(REPORT, |file| file.write_all(text.as_bytes()))?;
    addition.place(force)?;
    Ok(leftovers)
}

fn page(directory: &Path, viewer: Option<&Viewer>) -> Result<String, Error> {
    let name = directory.display().to_string();
    if let Some(kind) = DirectoryKind::of(directory) {
        return kind.report(directory, directory, &name);
    }
    let record_path = directory.join("run.json");
    let run = RecordedRun::read(&record_path)?;
    let record = serde_json::from_slice(&read_record(&record_path)?)
        .map_err(|error| Error::input(error).at(&record_path))?;
    let table = PoseTable::read(&directory.join("poses.csv"))?;
    let bodies = Bodies::recorded(run.inputs.pair(), &record_path, &run.options)?;
    let contacts = bodies.contacts(&table, &run.options);
    let top = TopComplexes::new(
        bodies.placed(),
        run.options.output.top(table.rows()),
        &run.options,
    )?;
    let known = match (bodies.pair(), &run.inputs.native) {
        (Pair::Molecules(pair), Some(native)) => {
            Some(KnownComplex::recorded(native, &record_path, pair, &table))
        }
        _ => None,
    };
    let report = RunReport {
        record: &record,
        options: &run.options,
        table: &table,
        bodies: bodies.placed(),
        refined: top.refined(),
        contacts: contacts.as_ref(),
        known: known.as_ref().map(KnownComplex::matched),
        clusters: figures_of(&directory.join(REPORT), &table),
        directory: &name,
    };
    Ok(report.text(viewer))
}
