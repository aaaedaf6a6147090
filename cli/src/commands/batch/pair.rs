//! One pair of a batch: docked unless its run is there, within a time and with retries, and reported.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};

use clap::Args;
use serde_json::{Value, json};

use crate::commands::batch::batch_pairs::Pair;
use crate::commands::batch::docking::BatchRun;
use crate::commands::dock::Prepared;
use crate::docking::{Docking, held_by_another};
use crate::messages::console::{Console, Listener, failure_json, failure_text};
use crate::shards::PosesOfPair;
use crate::shards::record::Keep;
use crate::tables::batch_results::RunSummary;
use knotdock::options::values::duration;
use knotdock::progress::{Interruption, Progress};
use knotdock_structures::Error;

/// Seconds before a pair is docked again.
const PAUSE: Duration = Duration::from_secs(1);

/// How long and how often a pair is docked.
#[derive(Args, Clone, Copy, Debug)]
pub struct Limits {
    /// Time for each pair, such as 10min: one that takes longer fails. `-- --memory 4G` limits its memory.
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub time_limit: Option<f64>,
    /// How often a pair is docked again that failed by no fault of its input, such as by a disk that did not answer.
    #[arg(long, value_name = "COUNT", default_value_t = 2)]
    pub retries: usize,
}

#[derive(Debug)]
pub struct PairTime<'a> {
    limit: Option<(Instant, f64)>,
    outer: Option<&'a dyn Listener>,
}

impl<'a> PairTime<'a> {
    /// The time of a pair that begins now.
    pub fn new(limits: Limits, console: Console<'a>) -> Self {
        let limit = limits.time_limit.and_then(|seconds| {
            let limit = Duration::try_from_secs_f64(seconds).ok()?;
            Some((Instant::now().checked_add(limit)?, seconds))
        });
        Self {
            limit,
            outer: console.listener,
        }
    }
}

impl Listener for PairTime<'_> {}

impl Progress for PairTime<'_> {
    fn stage(&self, _: &str, _: u64) {}

    fn advance(&self, _: u64) {}

    fn go_on(&self) -> Result<(), Interruption> {
        if let Some(outer) = self.outer {
            outer.go_on()?;
        }
        match self.limit {
            Some((end, seconds)) if Instant::now() >= end => Err(Interruption::TimeLimit(seconds)),
            _ => Ok(()),
        }
    }
}

/// A pair of a batch, to be docked.
pub struct PairWork<'a> {
    pub pair: Pair,
    pub batch: &'a BatchRun,
}

pub struct DockedPair {
    pub entry: Value,
    pub outcome: Result<RunSummary, Error>,
    /// Its poses, if they are kept in one file with those of other pairs.
    pub poses: Option<PosesOfPair>,
}

/// A pair that did not fail.
struct DonePair {
    is_new: bool,
    summary: RunSummary,
    /// Its poses, if they are kept in one file with those of other pairs.
    poses: Option<PosesOfPair>,
}

impl PairWork<'_> {
    /// Docks the pair on some threads, and reports it.
    pub fn dock(self, threads: usize, console: Console) -> DockedPair {
        let clock = Instant::now();
        let mut entry = json!({
            "name": self.pair.name,
            "directory": self.has_directory().then(|| self.directory().display().to_string()),
            "status": "failed",
            "error": null,
            "best": null,
            "first_acceptable_rank": null,
        });
        let pairs = self.batch.record.pairs;
        let head = format!("[{}/{pairs}] {}", self.pair.index, self.pair.name);
        match self.attempts(threads, console) {
            Ok(DonePair {
                is_new,
                summary,
                poses,
            }) => {
                let seconds = is_new.then(|| clock.elapsed().as_secs_f64());
                console.say(format!("{head}: {}", summary.line(seconds)));
                entry["status"] = if is_new { "docked" } else { "kept" }.into();
                entry["best"] = summary.best.clone();
                entry["first_acceptable_rank"] = summary.first_acceptable.into();
                DockedPair {
                    entry,
                    outcome: Ok(summary),
                    poses,
                }
            }
            Err(failure) => {
                console.error(format!("{head} failed\n{}", failure_text(&failure)));
                entry["error"] = failure_json(&failure)["error"].clone();
                DockedPair {
                    entry,
                    outcome: Err(failure),
                    poses: None,
                }
            }
        }
    }

    /// Whether it has a directory in the end.
    fn has_directory(&self) -> bool {
        matches!(self.keep(), Keep::Top | Keep::All)
    }

    /// The directory of its run, or of its complexes.
    fn directory(&self) -> PathBuf {
        self.batch.directory.join(&self.pair.name)
    }

    fn keep(&self) -> Keep {
        self.batch.record.keep
    }

    /// Docks it, and again where that may help.
    fn attempts(&self, threads: usize, console: Console) -> Result<DonePair, Error> {
        let mut retries = self.batch.limits.retries;
        loop {
            let time = PairTime::new(self.batch.limits, console);
            // A pair's own words would hide the batch's; its run.json has them.
            let silent = Console {
                listener: Some(&time),
                ..console.silent()
            };
            // A fault of the program costs no other pair, either.
            let docked = catch_unwind(AssertUnwindSafe(|| self.once(threads, silent, console)));
            let docked = docked.unwrap_or_else(|_| {
                Err(
                    Error::lasting("knotdock failed on this pair: this is a bug")
                        .help("report it with the files of the pair; the other pairs go on"),
                )
            });
            match docked {
                Err(failure) if failure.may_pass() && retries > 0 => {
                    retries -= 1;
                    sleep(PAUSE);
                }
                docked => return docked,
            }
        }
    }

    fn once(&self, threads: usize, silent: Console, console: Console) -> Result<DonePair, Error> {
        let dock = self.pair.dock.clone();
        dock.prepared(silent, Some(threads), |prepared| match (self.keep(), prepared) {
            (Keep::All, prepared) => {
                let is_new = self.run(prepared, silent, console)?;
                let summary = RunSummary::of(&self.directory())?;
                Ok(DonePair { is_new, summary, poses: None })
            }
            (_, Prepared::Run(docking)) => {
                self.poses(*docking, silent)
            }
            (_, Prepared::Ensemble(_)) => Err(Error::input(
                "this pair has several conformations, each of which is docked in its own run, and only --keep all keeps runs",
            )
            .help("dock such pairs with --keep all")),
        })
    }

    /// Docks the pair into its directory; whether it had to be done.
    fn run(&self, prepared: Prepared, silent: Console, console: Console) -> Result<bool, Error> {
        if prepared.is_done(console) {
            return Ok(false);
        }
        if let Some(directory) = prepared.in_the_way() {
            return Err(held_by_another(directory, "`-- --force`"));
        }
        prepared.run(silent, console)?;
        Ok(true)
    }

    /// Docks the pair without a directory of a run.
    fn poses(&self, docking: Docking, silent: Console) -> Result<DonePair, Error> {
        let docked = docking.dock(silent)?;
        let rows = self.batch.record.rows.unwrap_or(usize::MAX);
        let of_pair = || PosesOfPair::new(&self.pair.name, &docked.wide_table(), rows);
        let poses = self.keep().has_poses().then(of_pair);
        let poses = poses.transpose().map_err(Error::machine)?;
        if self.keep() == Keep::Top {
            docked.export_top(&self.directory())?;
        }
        Ok(DonePair {
            is_new: true,
            summary: docked.summary(),
            poses,
        })
    }
}
