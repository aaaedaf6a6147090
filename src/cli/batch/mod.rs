//! `knotdock batch`: many pairs in one call, and one table of what came of them.

mod crew;
mod row;
mod schedule;

use std::path::{Path, PathBuf};

use clap::Args;
use knotdock::options::Threads;
use knotdock::options::values::at_least_one;
use knotdock::output::files::folder_lock::FolderLock;
use knotdock::output::files::whole_file::FileError;
use knotdock::output::tables::batch_results::{
    PairResult, RESULTS, is_ours, rows_of_others, write_results,
};
use knotdock::output::tables::report::counted;
use serde_json::{Value, json};

use crate::cli::arguments::program::is_of_program;
use crate::cli::batch::crew::{Job, dock_all};
use crate::cli::batch::row::DockedRow;
use crate::cli::batch::schedule::{Own, turns};
use crate::cli::dock::Dock;
use crate::cli::inputs::batch_pairs::{Pair, pairs};
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;
use crate::cli::report::write_listed;

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
    /// Threads of the whole batch. Small pairs are docked at the same time on one thread each, large ones by themselves
    /// on all. A pair whose own options name a number of threads has that [default: all hardware threads].
    #[arg(short = 'j', long, value_name = "N", value_parser = at_least_one)]
    threads: Option<usize>,
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
        // A file of options that cannot be read is a failure of its pair alone.
        let own = pairs.iter().map(|pair| pair.dock.own_threads());
        let own: Vec<(Option<usize>, bool)> = own.map(Result::unwrap_or_default).collect();
        let threads = self.threads(&own);
        // Threads that all pairs agree on are those of the batch.
        let own: Vec<Own> = own
            .into_iter()
            .map(|(own, is_alone)| Own {
                threads: own.filter(|&own| own != threads),
                is_alone,
            })
            .collect();
        let costs: Vec<f64> = pairs.iter().map(|pair| pair.cost).collect();
        let turns = turns(&costs, &own, threads);
        let (mut waiting, mut table): (Vec<Option<Dock>>, Vec<PairResult>) =
            (Vec::new(), Vec::new());
        for pair in pairs {
            waiting.push(Some(pair.dock));
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
        let jobs = turns.into_iter().filter_map(|turn| {
            let name = table[turn.pair].name.clone();
            Some(Job {
                turn,
                dock: waiting[turn.pair].take()?,
                run: directory.join(&name),
                head: format!("[{}/{count}] {name}", turn.pair + 1),
                name,
            })
        });
        let jobs: Vec<Job> = jobs.collect();
        let (mut code, mut entries) = (0, vec![Value::Null; count]);
        dock_all(
            jobs,
            threads,
            console,
            |pair, DockedRow { entry, outcome }| {
                if let Err(failure) = &outcome {
                    code = match (code, failure.exit_code()) {
                        (0 | 2, 2) => 2,
                        _ => 1,
                    };
                }
                table[pair].outcome = Some(outcome.map_err(|failure| failure.line_of_table()));
                entries[pair] = entry;
                Ok(write_results(results, &table, &others)?)
            },
        )?;
        write_listed(directory, console)?;
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

    /// Threads of the batch: those given, or else those that all pairs' own options agree on.
    fn threads(&self, own: &[(Option<usize>, bool)]) -> usize {
        let agreed = match own {
            [(Some(first), _), rest @ ..] if rest.iter().all(|(own, _)| *own == Some(*first)) => {
                Some(*first)
            }
            _ => None,
        };
        let threads = self.threads.or(agreed);
        threads.unwrap_or_else(|| Threads::default().count())
    }
}
