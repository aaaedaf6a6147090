//! One pair of a batch: docked unless its run is there, and reported.

use crate::messages::failure;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::shards::PosesOfPair;
use crate::shards::record::Keep;
use crate::tables::batch_results::RunSummary;
use serde_json::{Value, json};

use crate::commands::batch::limits::{Limits, PairTime};
use crate::commands::dock::{Dock, Prepared};
use crate::docking::{Docking, held_by_another};
use crate::messages::console::Console;
use crate::messages::run_summary::summary_line;
use knotdock_structures::Error;

/// Seconds before a pair is docked again.
const PAUSE: Duration = Duration::from_secs(1);

/// A pair and what is wanted of it.
pub struct PairWork {
    /// Its command line.
    pub dock: Dock,
    /// Its name.
    pub name: String,
    /// The directory of its run, or of its complexes.
    pub directory: PathBuf,
    /// How its line of the report begins.
    pub head: String,
    /// What is kept of it.
    pub keep: Keep,
    /// Rows of its table that are kept.
    pub rows: usize,
    /// What it may take.
    pub limits: Limits,
}

/// What came of a pair.
pub struct DockedPair {
    /// Its JSON entry.
    pub entry: Value,
    /// Its row of the table.
    pub outcome: Result<RunSummary, Error>,
    /// Its poses, where they are kept in one file with those of others.
    pub poses: Option<PosesOfPair>,
}

/// What a pair left: whether it had to be docked, its summary, and its poses where they are kept elsewhere.
type Left = (bool, RunSummary, Option<PosesOfPair>);

impl PairWork {
    /// Docks the pair on some threads, and reports it.
    pub fn dock(self, threads: usize, console: Console) -> DockedPair {
        let clock = Instant::now();
        let mut entry = json!({
            "name": self.name,
            "directory": self.has_directory().then(|| self.directory.display().to_string()),
            "status": "failed",
            "error": null,
            "best": null,
            "first_acceptable_rank": null,
        });
        let head = &self.head;
        match self.attempts(threads, console) {
            Ok((anew, summary, poses)) => {
                console.say(format!("{head}: {}", summary_line(&summary, anew, clock)));
                entry["status"] = if anew { "docked" } else { "kept" }.into();
                entry["best"] = summary.best.clone();
                entry["first_acceptable_rank"] = summary.first_acceptable.into();
                DockedPair {
                    entry,
                    outcome: Ok(summary),
                    poses,
                }
            }
            Err(failure) => {
                console.error(format!("{head} failed\n{}", failure::text(&failure)));
                entry["error"] = failure::json(&failure)["error"].clone();
                DockedPair {
                    entry,
                    outcome: Err(failure),
                    poses: None,
                }
            }
        }
    }

    /// Whether it leaves a directory.
    fn has_directory(&self) -> bool {
        matches!(self.keep, Keep::Top | Keep::All)
    }

    /// Docks it, and again where that may help.
    fn attempts(&self, threads: usize, console: Console) -> Result<Left, Error> {
        let mut retries = self.limits.retries;
        loop {
            let time = PairTime::new(self.limits, console);
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

    fn once(&self, threads: usize, silent: Console, console: Console) -> Result<Left, Error> {
        let dock = self.dock.clone();
        dock.prepared(silent, Some(threads), |prepared| match (self.keep, prepared) {
            (Keep::All, prepared) => {
                let anew = self.run(prepared, silent, console)?;
                Ok((anew, RunSummary::of(&self.directory)?, None))
            }
            (_, Prepared::Run(docking)) => {
                let (summary, poses) = self.poses(*docking, silent)?;
                Ok((true, summary, poses))
            }
            (_, Prepared::Ensemble(_)) => Err(Error::input(
                "this pair has several conformations, which are docked in runs of their own, and only --keep all keeps runs",
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
    fn poses(
        &self,
        docking: Docking,
        silent: Console,
    ) -> Result<(RunSummary, Option<PosesOfPair>), Error> {
        let docked = docking.dock(silent)?;
        let poses = match self.keep.has_poses() {
            true => Some(PosesOfPair::new(
                &self.name,
                &docked.wide_table(),
                self.rows,
            )),
            false => None,
        };
        let poses = poses.transpose().map_err(Error::machine)?;
        if self.keep == Keep::Top {
            docked.export_top(&self.directory)?;
        }
        Ok((docked.summary(), poses))
    }
}
