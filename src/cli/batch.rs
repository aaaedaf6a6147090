//! `knotdock batch`: many pairs in one call, and one table of what came of them.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use knotdock::output::files::folder_lock::FolderLock;
use knotdock::output::files::whole_file::FileError;
use knotdock::output::tables::batch_results::{
    PairResult, RESULTS, RunSummary, is_ours, rows_of_others, write_results,
};
use knotdock::output::tables::report::counted;
use serde_json::{Value, json};

use crate::cli::arguments::program::is_of_program;
use crate::cli::dock::Dock;
use crate::cli::inputs::batch_pairs::{Pair, pairs};
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;
use crate::cli::messages::run_summary::summary_line;

/// Dock many pairs of a table, each into a directory of its own, and sum up what came of them.
///
/// A pair whose directory holds its run already, of the same inputs and options, is not docked again, so that a batch
/// which was stopped goes on where it was. A pair that fails is reported, and the others go on. DIR/results.csv has a
/// row a pair and is written anew after each.
#[derive(Args, Debug)]
pub struct Batch {
    /// Table of the pairs (CSV): columns `receptor` and `ligand` as for `knotdock dock`, perhaps `name`, and further
    /// columns named as options of `knotdock dock` that take a value (native, active_receptor, rotations ...). Files
    /// are looked for from the table's folder.
    #[arg(value_name = "PAIRS.CSV")]
    pairs: PathBuf,
    /// Directory of the batch, in which each pair's run has a directory of its name [default: knotdock_PAIRS].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Options of `knotdock dock` for all pairs, after `--`; with --force runs of other inputs or options are replaced.
    #[arg(last = true, value_name = "DOCK OPTIONS")]
    options: Vec<String>,
}

impl Batch {
    /// Docks the pairs; the exit code: 0 if all are done, 2 if what failed did so by its input, else 1.
    pub fn run(self, console: Console) -> Result<u8, Failure> {
        let directory = self.output.clone().unwrap_or_else(|| {
            let stem = self.pairs.file_stem().unwrap_or_default();
            PathBuf::from(format!("knotdock_{}", stem.to_string_lossy()))
        });
        if let Some(word) = self.options.iter().find(|word| is_of_program(word)) {
            return Err(
                Failure::input(format!("{word} after -- would be an option of each pair")).remedy(
                    format!("give {word} before --, where it is the whole batch's"),
                ),
            );
        }
        let pairs = pairs(&self.pairs, &directory, &self.options)?;
        let results = directory.join(RESULTS);
        let unwritable = |source| FileError::Unwritable {
            path: directory.clone(),
            source,
        };
        std::fs::create_dir_all(&directory).map_err(unwritable)?;
        // Two batches would each write the table without the other's rows.
        let lock = FolderLock::take(&directory).map_err(unwritable)?;
        let Some(_lock) = lock else {
            return Err(
                Failure::input("another batch is being written to the directory")
                    .at(&directory)
                    .remedy("wait for it to end, or choose another directory with -o"),
            );
        };
        self.run_locked(pairs, &directory, &results, console)
    }

    /// Docks the pairs into a directory that no other batch writes to.
    fn run_locked(
        &self,
        pairs: Vec<Pair>,
        directory: &Path,
        results: &Path,
        console: Console,
    ) -> Result<u8, Failure> {
        if !is_ours(results) {
            return Err(Failure::input("this is no table of a batch's results")
                .at(results)
                .remedy("choose another directory with -o"));
        }
        let count = pairs.len();
        console.say(format!(
            "{} of {} {} to {}",
            counted(count, "pair"),
            self.pairs.display(),
            if count == 1 { "goes" } else { "go" },
            directory.display()
        ));
        let mut entries: Vec<Value> = Vec::new();
        let (mut waiting, mut table): (Vec<Dock>, Vec<PairResult>) = (Vec::new(), Vec::new());
        for pair in pairs {
            waiting.push(pair.dock);
            table.push(PairResult {
                name: pair.name,
                receptor: pair.row.receptor,
                ligand: pair.row.ligand,
                outcome: None,
            });
        }
        let others = rows_of_others(results, &table).map_err(|error| {
            Failure::input(format!("the table of earlier results cannot be read: {error}"))
                .at(results)
                .remedy("move the file away: pairs that are done are not docked again, and get their rows anew")
        })?;
        let mut code = 0;
        for (index, dock) in waiting.into_iter().enumerate() {
            let name = table[index].name.clone();
            let head = format!("[{}/{count}] {name}", index + 1);
            let (entry, outcome) = dock_row(dock, &name, &directory.join(&name), &head, console);
            if let Err(failure) = &outcome {
                code = match (code, failure.exit_code()) {
                    (0 | 2, 2) => 2,
                    _ => 1,
                };
            }
            table[index].outcome = Some(outcome.map_err(|failure| failure.line_of_table()));
            entries.push(entry);
            write_results(results, &table, &others)?;
        }
        let done = table
            .iter()
            .filter(|pair| matches!(pair.outcome, Some(Ok(_))));
        console.say(format!(
            "{} of {count} done, results in {}{}",
            done.count(),
            results.display(),
            match others.len() {
                0 => String::new(),
                earlier => format!(", with {} of earlier batches", counted(earlier, "row")),
            }
        ));
        console.result(&json!({
            "directory": directory.display().to_string(),
            "results": results.display().to_string(),
            "pairs": entries,
        }))?;
        Ok(code)
    }
}

/// Docks the pair of one row and reports it; its JSON entry with what came of it.
fn dock_row(
    dock: Dock,
    name: &str,
    run: &Path,
    head: &str,
    console: Console,
) -> (Value, Result<RunSummary, Failure>) {
    let clock = Instant::now();
    let mut entry = json!({
        "name": name,
        "directory": run.display().to_string(),
        "status": "failed",
        "error": null,
        "best": null,
        "first_acceptable_rank": null,
    });
    let outcome = dock_pair(dock, console).and_then(|anew| Ok((RunSummary::of(run)?, anew)));
    let outcome = match outcome {
        Ok((summary, anew)) => {
            console.say(format!("{head}: {}", summary_line(&summary, anew, clock)));
            entry["status"] = if anew { "docked" } else { "kept" }.into();
            entry["best"] = summary.best.clone();
            entry["first_acceptable_rank"] = summary.first_acceptable.into();
            Ok(summary)
        }
        Err(failure) => {
            console.error(format!("{head} failed\n{}", failure.text()));
            entry["error"] = failure.json()["error"].clone();
            Err(failure)
        }
    };
    (entry, outcome)
}

/// Docks a pair into its directory; whether it had to be done.
fn dock_pair(dock: Dock, console: Console) -> Result<bool, Failure> {
    // A pair's own words would hide the batch's; its run.json has them.
    let silent = Console {
        quiet: true,
        ..Console::default()
    };
    dock.prepared(silent, |prepared| {
        if prepared.is_done(console) {
            return Ok(false);
        }
        if let Some(directory) = prepared.in_the_way() {
            return Err(Failure::input(
                "the directory holds a run of other inputs or options, or by another version, or only part of this one",
            )
            .at(directory)
            .remedy("pass `-- --force` to replace it, or choose another directory with -o"));
        }
        prepared.run(silent, console)?;
        Ok(true)
    })
}
