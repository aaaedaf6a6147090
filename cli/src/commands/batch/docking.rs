//! The loop of a batch or a shard: pairs that are not done are docked, and each is added to the batch's files.

use std::path::PathBuf;
use std::sync::mpsc::channel;
use std::thread::{Builder, scope};

use serde_json::{Value, json};

use crate::commands::batch::batch_pairs::Pair;
use crate::commands::batch::pair::{DockedPair, Limits, PairWork};
use crate::commands::batch::schedule::{Slot, schedule};
use crate::commands::report::write_batch_report;
use crate::messages::console::Console;
use crate::shards::part::Part;
use crate::shards::record::{BatchRecord, Keep};
use crate::shards::scratch::Scratch;
use crate::shards::{POSES, SHARDS};
use crate::tables::batch_results::{PairResult, RESULTS};
use crate::tables::report::counted;
use knotdock::dock::shared_process::share_process;
use knotdock::output::files::file_error;
use knotdock::output::files::whole_file::is_link;
use knotdock_structures::Error;

/// Times that the process may end during a pair before the pair is given up.
const KILLS: usize = 10;

pub struct BatchRun {
    pub directory: PathBuf,
    /// Folder of the growing files while pairs are docked; their final one if `None`.
    pub scratch: Option<PathBuf>,
    /// The pairs, their options, and the parts that are kept.
    pub record: BatchRecord,
    /// Threads, if they are given.
    pub threads: Option<usize>,
    pub limits: Limits,
    pub retry_failed: bool,
    /// Whether it is a shard, with a folder in the directory.
    pub is_shard: bool,
}

impl BatchRun {
    /// Docks pairs that are not done; the exit code: 0 if all are done, 2 if all failures are of inputs, else 1.
    pub fn dock(self, pairs: Vec<Pair>, console: Console) -> Result<u8, Error> {
        let place = self.place()?;
        let (_lock, leftovers) = self.record.take(&place)?;
        console.warn_leftovers(&leftovers);
        let scratch = self.scratch.as_deref();
        let scratch = scratch.map(|scratch| Scratch::open(scratch, &place, &self.record));
        let scratch = scratch.transpose()?;
        let folder = scratch
            .as_ref()
            .map_or(place.as_path(), Scratch::folder)
            .to_owned();
        let mut progress = BatchProgress {
            part: Part::open(&folder, &self.record)?,
            pairs: Vec::new(),
            entries: vec![Value::Null; pairs.len()],
            code: 0,
            console,
        };
        let docked = self.dock_all(pairs, &mut progress);
        let BatchProgress {
            part,
            entries,
            code,
            ..
        } = progress;
        let [done, failed] = part.counts();
        let docked = docked.and_then(|()| part.finish(&self.record));
        // A batch that ended early keeps its pairs too.
        scratch.map_or(Ok(()), Scratch::copy_out)?;
        docked?;
        let is_whole = !self.is_shard && self.record.keep == Keep::All;
        if is_whole {
            write_batch_report(&self.directory, console)?;
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
        // Pairs may have failed in earlier calls alone.
        Ok(if code == 0 && failed > 0 { 2 } else { code })
    }

    fn place(&self) -> Result<PathBuf, Error> {
        if !self.is_shard {
            return Ok(self.directory.clone());
        }
        let shards = self.directory.join(SHARDS);
        for folder in [&self.directory, &shards] {
            if is_link(folder) {
                return Err(file_error::link(folder));
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

    fn dock_all(&self, pairs: Vec<Pair>, progress: &mut BatchProgress) -> Result<(), Error> {
        let console = progress.console;
        let (lost, count) = (progress.part.lost, pairs.len());
        if lost > 0 {
            console.warn(format!(
                "{} had incomplete poses and are docked again",
                counted(lost, "pair")
            ));
        }
        let (fresh, stopped) = self.waiting(pairs, &mut progress.part)?;
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
            let results = pairs.iter().map(|pair| (pair.index, result(pair)));
            progress.pairs = results.collect();
            let (slots, threads) = schedule(&pairs, self.threads);
            let mut left: Vec<Option<Pair>> = pairs.into_iter().map(Some).collect();
            let work = slots.into_iter().filter_map(|slot| {
                let pair = left[slot.pair].take()?;
                Some((slot, PairWork { pair, batch: self }))
            });
            progress.dock_all(work.collect(), threads)?;
        }
        Ok(())
    }

    /// Pairs that were never started, and pairs during which the process ended; pairs that ended it too often fail.
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
                    let mut failed = result(&pair);
                    failed.outcome = Err(format!(
                        "the program ended {kills} times while this pair was docked, perhaps for lack of memory"
                    ));
                    part.add(&failed, None)?;
                }
                (None, _) => stopped.push(pair),
            }
        }
        Ok((fresh, stopped))
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

struct BatchProgress<'a> {
    /// The files, to which each pair is added.
    part: Part,
    /// Row in the table and result of the pairs that are docked now, by their slots.
    pairs: Vec<(usize, PairResult)>,
    entries: Vec<Value>,
    code: u8,
    console: Console<'a>,
}

impl BatchProgress<'_> {
    /// Docks pairs in order, as many at once as `threads` allow; none starts after a failure to write.
    fn dock_all(&mut self, work: Vec<(Slot, PairWork)>, threads: usize) -> Result<(), Error> {
        let console = self.console;
        let (sender, receiver) = channel();
        let mut waiting = work.into_iter().peekable();
        let (mut free, mut running) = (threads, 0usize);
        scope(|scope| {
            let mut failed = None;
            loop {
                let fits = |(slot, _): &(Slot, PairWork)| {
                    let has_room = !slot.is_alone && slot.threads <= free;
                    failed.is_none() && (running == 0 || has_room)
                };
                if let Some((slot, work)) = waiting.next_if(fits) {
                    failed = self.start(slot.pair).err();
                    if failed.is_some() {
                        continue;
                    }
                    if slot.is_alone {
                        let docked = work.dock(slot.threads, console);
                        failed = self.add(slot.pair, docked).err();
                        continue;
                    }
                    share_process();
                    let sender = sender.clone();
                    let work = move || {
                        // The receiver outlives the threads.
                        let _ = sender.send((slot, work.dock(slot.threads, console)));
                    };
                    if let Err(error) = Builder::new().spawn_scoped(scope, work) {
                        let message = format!("the system could not start a thread: {error}");
                        failed = Some(Error::machine(message).help("use fewer threads (-j)"));
                        continue;
                    }
                    free = free.saturating_sub(slot.threads);
                    running += 1;
                } else if running > 0 {
                    // The sender is held here, so that receiving cannot fail.
                    if let Ok((slot, docked)) = receiver.recv() {
                        free += slot.threads;
                        running -= 1;
                        let next = self.add(slot.pair, docked).err();
                        failed = failed.or(next);
                    }
                } else {
                    return failed.map_or(Ok(()), Err);
                }
            }
        })
    }

    /// Notes that a pair is about to be docked.
    fn start(&mut self, place: usize) -> Result<(), Error> {
        self.console.go_on()?;
        self.part.start(&self.pairs[place].1.name)
    }

    fn add(&mut self, place: usize, pair: DockedPair) -> Result<(), Error> {
        // A pair that was interrupted has not failed.
        self.console.go_on()?;
        if let Err(failure) = &pair.outcome {
            self.code = match (self.code, failure.exit_code()) {
                (0 | 2, 2) => 2,
                _ => 1,
            };
        }
        let (row, result) = &mut self.pairs[place];
        result.outcome = pair.outcome.map_err(|failure| failure.in_one_line());
        self.part.add(result, pair.poses.as_ref())?;
        // The files have it now; memory does not keep it.
        result.outcome = Err(String::new());
        if let Some(entry) = self.entries.get_mut(*row - 1) {
            *entry = pair.entry;
        }
        self.console.advances();
        Ok(())
    }
}
