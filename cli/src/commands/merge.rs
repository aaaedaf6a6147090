//! `knotdock merge`: the shards of a batch as one table and one file of poses.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use crate::messages::console::Console;
use crate::shards::merge::{Merged, merge};
use crate::tables::report::counted;
use knotdock_structures::Error;

/// Put the shards of a batch together, in the order of its table of pairs.
///
/// Writes results.csv and poses.csv.gz. Their bytes do not depend on the number of shards or on where each was docked.
#[derive(Args, Debug)]
pub struct Merge {
    /// Directories that `knotdock batch --shard` wrote to.
    #[arg(value_name = "DIR", required = true)]
    directories: Vec<PathBuf>,
    /// Where the tables go [default: the directory, where there is one].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Merge what there is where shards are missing or not done.
    #[arg(long)]
    partial: bool,
    /// Replace tables of an earlier merge that differ.
    #[arg(long)]
    force: bool,
}

impl Merge {
    pub fn run(self, console: Console) -> Result<(), Error> {
        let out = match (self.output, self.directories.as_slice()) {
            (Some(out), _) => out,
            (None, [one]) => one.clone(),
            (None, _) => {
                return Err(Error::input(
                    "several directories are given, and it is not known where the merged tables go",
                )
                .help("name one with -o"));
            }
        };
        let Merged {
            shards,
            counts: [pairs, done, failed],
            results,
            poses,
            leftovers,
        } = merge(&self.directories, &out, self.partial, self.force)?;
        console.warn_leftovers(&leftovers);
        let path = |path: PathBuf| path.display().to_string();
        let (results, poses) = (path(results), poses.map(path));
        let beside = poses.as_ref().map(|poses| format!(" and {poses}"));
        console.say(format!(
            "{} of {}: {done} done, {failed} failed, in {results}{}",
            counted(shards.len(), "shard"),
            counted(pairs, "pair"),
            beside.unwrap_or_default()
        ));
        console.result(&json!({
            "results": results,
            "poses": poses,
            "shards": shards.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "pairs": pairs,
            "done": done,
            "failed": failed,
        }))
    }
}
