//! The loop of a batch or a shard: pairs that are not done are docked, and each is added to the batch's files.

use knotdock::output::files::file_error;
use std::path::PathBuf;

use crate::shards::part::Part;
use crate::shards::record::{BatchRecord, Keep};
use crate::shards::scratch::Scratch;
use crate::shards::{POSES, SHARDS};
use crate::tables::batch_results::{PairResult, RESULTS};
use crate::tables::report::counted;
use knotdock::output::files::whole_file::is_link;
use serde_json::{Value, json};

use crate::commands::batch::ExitCode;
use crate::commands::batch::batch_pairs::Pair;
use crate::commands::batch::crew::{Job, Watch, dock_all};
use crate::commands::batch::limits::Limits;
use crate::commands::batch::pair::{DockedPair, PairWork};
use crate::commands::batch::plan::plan;
use crate::commands::report::write_listed;
use crate::messages::console::Console;
use crate::messages::leftovers::warn_leftovers;
use knotdock_structures::Error;

/// So often a pair may be under way when its process ends before it is given up.
const KILLS: usize = 10;

/// What is done with the pairs of a batch or a shard.
pub struct BatchRun {
    /// The directory of the batch.
    pub directory: PathBuf,
    /// Where the growing files are while pairs are docked; in their place where none is given.
    pub scratch: Option<PathBuf>,
    /// Which pairs, which options, and what is kept.
    pub record: BatchRecord,
    /// Threads, where they are given.
    pub threads: Option<usize>,
    /// What a pair may take.
    pub limits: Limits,
    /// Whether pairs that failed are docked again.
    pub retry_failed: bool,
    /// Whether it is a shard, with a folder in the directory.
    pub is_shard: bool,
}

impl BatchRun {
    /// Docks those of the pairs that are not done; the exit code.
    pub fn dock(self, pairs: Vec<Pair>, console: Console) -> Result<ExitCode, Error> {
        let place = self.place()?;
        let (_lock, leftovers) = self.record.take(&place)?;
        warn_leftovers(&leftovers, console);
        let scratch = self.scratch.as_deref();
        let scratch = scratch.map(|scratch| Scratch::open(scratch, &place, &self.record));
        let scratch = scratch.transpose()?;
        let folder = scratch
            .as_ref()
            .map_or(place.as_path(), Scratch::folder)
            .to_owned();
        let mut watch = ResultFiles {
            part: Part::open(&folder, &self.record)?,
            pairs: Vec::new(),
            entries: vec![Value::Null; pairs.len()],
            code: ExitCode::default(),
            console,
        };
        let docked = self.dock_all(pairs, &mut watch);
        let ResultFiles {
            part,
            entries,
            code,
            ..
        } = watch;
        let [done, failed] = part.counts();
        let docked = docked.and_then(|()| Ok(part.finish(&self.record)?));
        // What is done is not lost with this machine, though not all is.
        scratch.map_or(Ok(()), Scratch::copy_out)?;
        docked?;
        let is_whole = !self.is_shard && self.record.keep == Keep::All;
        if is_whole {
            write_listed(&self.directory, console)?;
        }
        let again = match failed {
            0 => "",
            _ if is_whole => "; the same call docks those again that failed",
            _ => "; --retry-failed docks those again that failed",
        };
        let results = place.join(RESULTS);
        console.say(format!(
            "{done} of {} done, {failed} failed, in {}{again}",
            self.record.own.len(),
            results.display()
        ));
        let poses = self
            .record
            .keep
            .has_poses()
            .then(|| place.join(POSES).display().to_string());
        console.result(&match is_whole {
            true => json!({
                "directory": self.directory.display().to_string(),
                "results": results.display().to_string(),
                "pairs": entries,
            }),
            false => json!({
                "directory": self.directory.display().to_string(),
                "shard": self.record.shard.to_string(),
                "folder": place.display().to_string(),
                "pairs": self.record.own.len(),
                "done": done,
                "failed": failed,
                "results": results.display().to_string(),
                "poses": poses,
            }),
        })?;
        Ok(code.of_failed(failed))
    }

    /// The folder of the batch's or the shard's files.
    fn place(&self) -> Result<PathBuf, Error> {
        if !self.is_shard {
            return Ok(self.directory.clone());
        }
        let shards = self.directory.join(SHARDS);
        for folder in [&self.directory, &shards] {
            if is_link(folder) {
                return Err(file_error::link(folder).into());
            }
        }
        let mut entries = std::fs::read_dir(&self.directory).into_iter().flatten();
        if !shards.is_dir() && entries.next().is_some() {
            let message = "the directory is not empty and holds no shards of knotdock";
            return Err(Error::input(message)
                .at(&self.directory)
                .help("choose another directory with -o"));
        }
        Ok(shards.join(self.record.shard.folder()))
    }

    /// Docks the pairs that wait.
    fn dock_all(&self, pairs: Vec<Pair>, watch: &mut ResultFiles) -> Result<(), Error> {
        let console = watch.console;
        let (lost, count) = (watch.part.lost, pairs.len());
        if lost > 0 {
            console.warn(format!(
                "{} had incomplete poses and are docked again",
                counted(lost, "pair")
            ));
        }
        let (fresh, stopped) = self.waiting(pairs, &mut watch.part)?;
        let waiting = fresh.len() + stopped.len();
        if waiting < count {
            console.say(format!(
                "{} were done before",
                counted(count - waiting, "pair")
            ));
        }
        console.begins("pairs", waiting);
        // A pair that was under way when the process ended may end it again: it comes by itself, after all others.
        let alone = stopped.into_iter().map(|pair| vec![pair]);
        for pairs in std::iter::once(fresh).chain(alone) {
            watch.pairs = pairs
                .iter()
                .map(|pair| (pair.index, result(pair)))
                .collect();
            let (turns, threads) = plan(&pairs, self.threads);
            let mut left: Vec<Option<Pair>> = pairs.into_iter().map(Some).collect();
            let jobs = turns.into_iter().filter_map(|turn| {
                let work = self.work(left[turn.pair].take()?);
                Some(Job { turn, work })
            });
            let jobs: Vec<Job<PairWork>> = jobs.collect();
            let dock = |work: PairWork, threads| work.dock(threads, console);
            dock_all(jobs, threads, dock, watch)?;
        }
        Ok(())
    }

    /// The pairs that have to be docked: those that were never started, and those that were under way when the process
    /// ended. What ended the process too often is noted as failed. Whole runs are all looked at.
    fn waiting(&self, pairs: Vec<Pair>, part: &mut Part) -> Result<(Vec<Pair>, Vec<Pair>), Error> {
        let (mut fresh, mut stopped) = (Vec::new(), Vec::new());
        let is_again = |is_done: bool| match self.record.keep {
            Keep::All => true,
            _ => self.retry_failed && !is_done,
        };
        for pair in pairs {
            match (part.is_done(&pair.name), part.attempts(&pair.name)) {
                (Some(is_done), _) if !is_again(is_done) => {}
                (Some(_), _) | (None, 0) => fresh.push(pair),
                (None, kills) if kills >= KILLS => {
                    let failure = format!(
                        "the program ended {kills} times while this pair was docked, perhaps for lack of memory"
                    );
                    let outcome = Err(failure);
                    part.add(
                        &PairResult {
                            outcome,
                            ..result(&pair)
                        },
                        None,
                    )?;
                }
                (None, _) => stopped.push(pair),
            }
        }
        Ok((fresh, stopped))
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

/// The row of a pair before it is docked.
fn result(pair: &Pair) -> PairResult {
    PairResult {
        name: pair.name.clone(),
        receptor: pair.row.receptor.clone(),
        ligand: pair.row.ligand.clone(),
        outcome: Err(String::new()),
    }
}

/// The files of the batch, to which each pair is added.
struct ResultFiles<'a> {
    part: Part,
    /// Row in the table and result of the pairs that are docked now, by their turns.
    pairs: Vec<(usize, PairResult)>,
    /// What is said of each pair in JSON.
    entries: Vec<Value>,
    code: ExitCode,
    console: Console<'a>,
}

impl Watch<DockedPair> for ResultFiles<'_> {
    fn start(&mut self, place: usize) -> Result<(), Error> {
        self.console.go_on()?;
        Ok(self.part.start(&self.pairs[place].1.name)?)
    }

    fn done(&mut self, place: usize, pair: DockedPair) -> Result<(), Error> {
        // What was interrupted has not failed.
        self.console.go_on()?;
        if let Err(failure) = &pair.outcome {
            self.code.add(failure);
        }
        let (row, result) = &mut self.pairs[place];
        let outcome = pair.outcome.map_err(|failure| failure.in_one_line());
        result.outcome = outcome;
        self.part.add(result, pair.poses.as_ref())?;
        // What is in the files is not held.
        result.outcome = Err(String::new());
        if let Some(entry) = self.entries.get_mut(*row - 1) {
            *entry = pair.entry;
        }
        self.console.advances();
        Ok(())
    }
}
