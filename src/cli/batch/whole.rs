//! A batch that keeps the whole run of each pair, in a directory of its own, and one table of all.

use std::path::{Path, PathBuf};

use crate::output::shards::record::Keep;
use crate::output::tables::batch_results::{
    PairResult, RESULTS, is_ours, rows_of_others, write_results,
};
use crate::output::tables::report::counted;
use csv::StringRecord;
use serde_json::{Value, json};

use crate::cli::batch::crew::{Job, Watch, dock_all};
use crate::cli::batch::limits::Limits;
use crate::cli::batch::pair::{DockedPair, PairWork};
use crate::cli::batch::plan::plan;
use crate::cli::batch::{ExitCode, lock};
use crate::cli::dock::Dock;
use crate::cli::inputs::batch_pairs::Pair;
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;
use crate::cli::report::write_listed;

/// Docks pairs into a directory, which holds a directory for each; the exit code.
pub fn dock_into(
    directory: &Path,
    pairs: Vec<Pair>,
    (threads, limits): (Option<usize>, Limits),
    console: Console,
) -> Result<ExitCode, Failure> {
    let _lock = lock(directory)?;
    let results = directory.join(RESULTS);
    if !is_ours(&results) {
        return Err(Failure::input("this is not a table of results of a batch")
            .at(&results)
            .remedy("choose another directory with -o"));
    }
    let count = pairs.len();
    let (turns, threads) = plan(&pairs, threads);
    let (mut waiting, mut table): (Vec<Option<Dock>>, Vec<PairResult>) = (Vec::new(), Vec::new());
    for pair in pairs {
        waiting.push(Some(pair.dock));
        table.push(PairResult {
            name: pair.name,
            receptor: pair.row.receptor,
            ligand: pair.row.ligand,
            outcome: None,
        });
    }
    let others = rows_of_others(&results, &table).map_err(|error| {
        Failure::input(format!(
            "the table of earlier results cannot be read: {error}"
        ))
        .at(&results)
        .remedy(
            "move the file away: finished pairs are not docked again, and their rows are written again",
        )
    })?;
    let jobs = turns.into_iter().filter_map(|turn| {
        let name = table[turn.pair].name.clone();
        let work = PairWork {
            dock: waiting[turn.pair].take()?,
            directory: directory.join(&name),
            head: format!("[{}/{count}] {name}", turn.pair + 1),
            name,
            keep: Keep::All,
            rows: 0,
            limits,
        };
        Some(Job { turn, work })
    });
    let jobs: Vec<Job<PairWork>> = jobs.collect();
    let mut watch = Results {
        path: results,
        table,
        others,
        entries: vec![Value::Null; count],
        code: ExitCode::default(),
        console,
    };
    console.begins("pairs", count);
    let dock = |work: PairWork, threads| work.dock(threads, console);
    dock_all(jobs, threads, dock, &mut watch)?;
    write_listed(directory, console)?;
    watch.report(directory)
}

/// The table of results, written anew after each pair.
struct Results<'a> {
    path: PathBuf,
    table: Vec<PairResult>,
    others: Vec<StringRecord>,
    entries: Vec<Value>,
    code: ExitCode,
    console: Console<'a>,
}

impl Watch<DockedPair> for Results<'_> {
    fn start(&mut self, _: usize) -> Result<(), Failure> {
        self.console.go_on()
    }

    fn done(&mut self, place: usize, pair: DockedPair) -> Result<(), Failure> {
        self.console.go_on()?;
        if let Err(failure) = &pair.outcome {
            self.code.add(failure);
        }
        let outcome = pair.outcome.map_err(|failure| failure.line_of_table());
        self.table[place].outcome = Some(outcome);
        self.entries[place] = pair.entry;
        self.console.advances();
        Ok(write_results(&self.path, &self.table, &self.others)?)
    }
}

impl Results<'_> {
    fn report(self, directory: &Path) -> Result<ExitCode, Failure> {
        let count = self.table.len();
        let is_done = |pair: &&PairResult| matches!(pair.outcome, Some(Ok(_)));
        let done = self.table.iter().filter(is_done).count();
        self.console.say(format!(
            "{done} of {count} done, results in {}{}",
            self.path.display(),
            match self.others.len() {
                0 => String::new(),
                earlier => format!(", with {} of earlier batches", counted(earlier, "row")),
            }
        ));
        self.console.result(&json!({
            "directory": directory.display().to_string(),
            "results": self.path.display().to_string(),
            "pairs": self.entries,
        }))?;
        Ok(self.code)
    }
}
