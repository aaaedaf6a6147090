//! One pair of a batch: docked unless its run is there, and reported.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Instant;

use knotdock::output::tables::batch_results::RunSummary;
use serde_json::{Value, json};

use crate::cli::dock::Dock;
use crate::cli::docking::held_by_another;
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;
use crate::cli::messages::run_summary::summary_line;

/// What came of a pair.
pub struct DockedRow {
    /// Its JSON entry.
    pub entry: Value,
    /// Its row of the table.
    pub outcome: Result<RunSummary, Failure>,
}

/// Docks the pair of one row and reports it; its JSON entry with what came of it.
pub fn dock_row(
    (dock, threads): (Dock, usize),
    (name, head): (&str, &str),
    run: &Path,
    console: Console,
) -> DockedRow {
    let clock = Instant::now();
    let mut entry = json!({
        "name": name,
        "directory": run.display().to_string(),
        "status": "failed",
        "error": null,
        "best": null,
        "first_acceptable_rank": null,
    });
    // A fault of the program costs no other pair, either.
    let docked = catch_unwind(AssertUnwindSafe(|| dock_pair(dock, threads, console)));
    let docked = docked.unwrap_or_else(|_| {
        Err(
            Failure::other("knotdock failed on this pair, which is a fault of the program")
                .remedy("report it with the files of the pair; the other pairs go on"),
        )
    });
    let outcome = docked.and_then(|anew| Ok((RunSummary::of(run)?, anew)));
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
    DockedRow { entry, outcome }
}

/// Docks a pair into its directory; whether it had to be done.
fn dock_pair(dock: Dock, threads: usize, console: Console) -> Result<bool, Failure> {
    // A pair's own words would hide the batch's; its run.json has them.
    let silent = Console {
        quiet: true,
        ..Console::default()
    };
    dock.prepared(silent, Some(threads), |prepared| {
        if prepared.is_done(console) {
            return Ok(false);
        }
        if let Some(directory) = prepared.in_the_way() {
            return Err(held_by_another(directory, "`-- --force`"));
        }
        prepared.run(silent, console)?;
        Ok(true)
    })
}
