//! A batch, or a shard of it, that keeps one table of results and one file of poses for all its pairs.

use std::collections::VecDeque;
use std::path::PathBuf;

use crate::output::files::workplace::Workplace;
use crate::output::shards::SHARDS;
use crate::output::shards::journal::Journal;
use crate::output::shards::merge::{check_places, merge};
use crate::output::shards::record::ShardRecord;
use crate::output::tables::batch_results::{PairResult, RESULTS};
use crate::output::tables::report::counted;
use serde_json::json;

use crate::cli::batch::crew::{Job, Watch, dock_all};
use crate::cli::batch::limits::Limits;
use crate::cli::batch::pair::{DockedPair, PairWork};
use crate::cli::batch::plan::plan;
use crate::cli::batch::{ExitCode, lock};
use crate::cli::inputs::batch_pairs::Pair;
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;

/// So often a pair may be under way when its process ends before it is given up.
const KILLS: usize = 10;

/// What is done with the pairs of a shard.
pub struct Sharding {
    /// The directory of the batch.
    pub directory: PathBuf,
    /// Where the shard's files are while it is docked; in the directory itself where none is given.
    pub scratch: Option<PathBuf>,
    /// Which pairs, which options, and what is kept.
    pub record: ShardRecord,
    /// Threads, where they are given.
    pub threads: Option<usize>,
    /// What a pair may take.
    pub limits: Limits,
    /// Whether pairs that failed are docked again.
    pub retry_failed: bool,
    /// Whether the shard is all there is, and is put in the order of the table.
    pub is_whole: bool,
}

impl Sharding {
    /// Docks those of the pairs that are not done; the exit code.
    pub fn dock(self, pairs: Vec<Pair>, console: Console) -> Result<ExitCode, Failure> {
        let shard = self.record.shard;
        if self.is_whole {
            // Known before anything is docked.
            check_places(&self.directory, self.record.keep.has_poses(), None)?;
        }
        let final_place = self.directory.join(SHARDS).join(shard.folder());
        let workplace = Workplace::open(&final_place, self.scratch.as_deref(), RESULTS)?;
        let held = lock(workplace.folder())?;
        let mut journal = Journal::open(workplace.folder(), &self.record)?;
        if journal.lost() > 0 {
            console.warn(format!(
                "{} in {} had incomplete poses and are docked again",
                counted(journal.lost(), "pair"),
                workplace.folder().display()
            ));
        }
        let count = pairs.len();
        let waiting = self.waiting(pairs, &mut journal)?;
        if waiting.len() < count {
            console.say(format!(
                "{} were done before",
                counted(count - waiting.len(), "pair")
            ));
        }
        let mut watch = Shards {
            journal,
            pairs: Vec::new(),
            code: ExitCode::default(),
            console,
        };
        console.begins("pairs", waiting.len());
        // A pair that was under way when the process ended may end it again: it comes after all others.
        for pairs in waiting.into_groups() {
            watch.pairs = pairs
                .iter()
                .map(|pair| (pair.index, result(pair)))
                .collect();
            let (turns, threads) = plan(&pairs, self.threads);
            let mut left: Vec<Option<Pair>> = pairs.into_iter().map(Some).collect();
            let jobs = turns.into_iter().filter_map(|turn| {
                let pair = left[turn.pair].take()?;
                let work = self.work(pair);
                Some(Job { turn, work })
            });
            let jobs: Vec<Job<PairWork>> = jobs.collect();
            let dock = |work: PairWork, threads| work.dock(threads, console);
            dock_all(jobs, threads, dock, &mut watch)?;
        }
        let [done, failed] = watch.journal.counts();
        let code = watch.code;
        drop(watch);
        drop(held);
        workplace.place()?;
        let mut object = json!({
            "directory": self.directory.display().to_string(),
            "shard": shard.to_string(),
            "folder": final_place.display().to_string(),
            "pairs": count,
            "done": done,
            "failed": failed,
            "results": null,
            "poses": null,
        });
        let place = if self.is_whole {
            let merged = merge(
                std::slice::from_ref(&self.directory),
                &self.directory,
                false,
            )?;
            object["results"] = merged.results.display().to_string().into();
            object["poses"] = merged.poses.map(|path| path.display().to_string()).into();
            merged.results
        } else {
            final_place
        };
        let again = match failed {
            0 => "",
            _ => "; --retry-failed docks those again that failed",
        };
        console.say(format!(
            "{done} of {count} done, {failed} failed, in {}{again}",
            place.display()
        ));
        console.result(&object)?;
        Ok(code.of_failed(failed))
    }

    /// The pairs that have to be docked: those that were never started, and those that were under way when the process
    /// ended. What ended the process too often is noted as failed.
    fn waiting(&self, pairs: Vec<Pair>, journal: &mut Journal) -> Result<Waiting, Failure> {
        let mut waiting = Waiting::default();
        for pair in pairs {
            let row = pair.index;
            let is_again = self.retry_failed && journal.has_failed(row);
            if journal.is_done(row) || (journal.has_failed(row) && !is_again) {
                continue;
            }
            match journal.attempts(row) {
                0 => waiting.fresh.push(pair),
                _ if is_again => waiting.fresh.push(pair),
                kills if kills >= KILLS => {
                    let failure = format!(
                        "the program ended {kills} times while this pair was docked, perhaps for lack of memory"
                    );
                    let mut result = result(&pair);
                    result.outcome = Some(Err(failure));
                    journal.add(row, &result, None)?;
                }
                _ => waiting.stopped.push_back(pair),
            }
        }
        Ok(waiting)
    }

    fn work(&self, pair: Pair) -> PairWork {
        PairWork {
            dock: pair.dock,
            directory: self.directory.join(&pair.name),
            head: format!("[{}/{}] {}", pair.index, self.record.pairs, pair.name),
            name: pair.name,
            keep: self.record.keep,
            rows: self.record.rows.unwrap_or(usize::MAX),
            limits: self.limits,
        }
    }
}

/// Pairs that wait.
#[derive(Default)]
struct Waiting {
    fresh: Vec<Pair>,
    stopped: VecDeque<Pair>,
}

impl Waiting {
    fn len(&self) -> usize {
        self.fresh.len() + self.stopped.len()
    }

    /// Those that are docked side by side: all fresh ones, then each of the others by itself.
    fn into_groups(self) -> impl Iterator<Item = Vec<Pair>> {
        let stopped = self.stopped.into_iter().map(|pair| vec![pair]);
        std::iter::once(self.fresh).chain(stopped)
    }
}

fn result(pair: &Pair) -> PairResult {
    PairResult {
        name: pair.name.clone(),
        receptor: pair.row.receptor.clone(),
        ligand: pair.row.ligand.clone(),
        outcome: None,
    }
}

/// The files of the shard, to which each pair is added.
struct Shards<'a> {
    journal: Journal,
    /// Row and result of the pairs that are docked now, by their places.
    pairs: Vec<(usize, PairResult)>,
    code: ExitCode,
    console: Console<'a>,
}

impl Watch<DockedPair> for Shards<'_> {
    fn start(&mut self, place: usize) -> Result<(), Failure> {
        self.console.go_on()?;
        Ok(self.journal.start(self.pairs[place].0)?)
    }

    fn done(&mut self, place: usize, pair: DockedPair) -> Result<(), Failure> {
        // What was interrupted has not failed.
        self.console.go_on()?;
        if let Err(failure) = &pair.outcome {
            self.code.add(failure);
        }
        let (row, result) = &mut self.pairs[place];
        result.outcome = Some(pair.outcome.map_err(|failure| failure.line_of_table()));
        self.journal.add(*row, result, pair.poses.as_ref())?;
        // What is in the journal is not held.
        result.outcome = None;
        self.console.advances();
        Ok(())
    }
}
