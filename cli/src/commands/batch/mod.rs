//! `knotdock batch`: many pairs in one call, and one table of their results.

mod batch_pairs;
mod docking;
mod pair;
mod schedule;

use std::path::PathBuf;

use clap::Args;

use crate::arguments::is_of_program;
use crate::commands::batch::batch_pairs::{Pairs, pairs};
use crate::commands::batch::docking::BatchRun;
use crate::commands::batch::pair::Limits;
use crate::messages::console::Console;
use crate::shards::Shard;
use crate::shards::record::{BatchRecord, Keep};
use crate::tables::report::counted;
use knotdock::options::values::{AT_LEAST_ONE, AllOr, all_or_at_least_one, in_range};
use knotdock_structures::Error;

/// Dock many pairs of a table, and sum up what came of them.
///
/// By default each pair has its own directory, and DIR/results.csv one row per pair. A pair that is done is not docked
/// again, so that a batch which was stopped goes on where it was. A pair that fails is reported, and the others go on.
/// For many thousands of pairs, --keep table writes one table of results and one file of poses, and --shard docks a part
/// of the table on each of several machines.
#[derive(Args, Debug)]
pub struct Batch {
    /// Table of the pairs (CSV): columns `receptor` and `ligand` as for `knotdock dock`, optionally `name`, and further
    /// columns named as options of `knotdock dock` that take a value (native, active_receptor, rotations ...). Files
    /// are looked for from the table's folder.
    #[arg(value_name = "PAIRS.CSV")]
    pairs: PathBuf,
    /// Directory of the batch [default: knotdock_PAIRS].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Threads of the whole batch. Small pairs are docked at the same time on one thread each, large ones by themselves
    /// on all. A pair whose own options name a number of threads has that [default: all hardware threads].
    #[arg(short = 'j', long, value_name = "COUNT", value_parser = in_range::<usize>(AT_LEAST_ONE))]
    threads: Option<usize>,
    /// What is kept of each pair.
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = Keep::All)]
    keep: Keep,
    /// Rows of each pair that go to poses.csv.gz, best first, or `all` [default: 200].
    #[arg(long, value_name = "COUNT", value_parser = all_or_at_least_one)]
    rows: Option<AllOr>,
    /// Dock one of N parts of the table, such as 3/100: every hundredth pair, from the third on. Its files are in
    /// DIR/shards; `knotdock merge DIR` puts all parts together.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Folder on a disk of this machine in which the shard's files are until it is done.
    #[arg(long, value_name = "FOLDER")]
    scratch: Option<PathBuf>,
    #[command(flatten)]
    limits: Limits,
    /// Dock pairs again that failed in an earlier call; with --keep all that is always done.
    #[arg(long)]
    retry_failed: bool,
    /// Exit code 0 where pairs failed, as long as every pair was tried: the table has their errors.
    #[arg(long)]
    failures_ok: bool,
    /// Refine the complexes in the top/ of each pair, as `knotdock dock` does: some 0.1 s for each.
    #[arg(long)]
    refine_top: bool,
    /// Options of `knotdock dock` for all pairs, after `--`; with --force runs of other inputs or options are replaced.
    #[arg(last = true, value_name = "DOCK OPTIONS")]
    options: Vec<String>,
}

impl Batch {
    /// Docks the pairs; the exit code: 0 if all are done, 2 if what failed did so by its input, else 1.
    pub fn run(mut self, console: Console) -> Result<u8, Error> {
        if !self.refine_top && !self.options.iter().any(|word| word == "--raw") {
            self.options.push("--raw".to_owned());
        }
        let directory = self.output.clone().unwrap_or_else(|| {
            let stem = self.pairs.file_stem().unwrap_or_default();
            PathBuf::from(format!("knotdock_{}", stem.to_string_lossy()))
        });
        if let Some(word) = self.options.iter().find(|word| is_of_program(word)) {
            return Err(Error::input(format!(
                "{word} applies to the whole batch, and is given after --"
            ))
            .help(format!("put {word} before `--`")));
        }
        let is_plain = self.shard.is_none() && self.keep == Keep::All;
        if is_plain && (self.scratch.is_some() || self.retry_failed) {
            return Err(
                Error::input("--scratch and --retry-failed need shards, and this batch writes a directory for each pair")
                    .help("leave them out, or give --keep table, --keep none or --shard I/N"),
            );
        }
        if self.rows.is_some() && !self.keep.has_poses() {
            return Err(
                Error::input("--rows needs poses.csv.gz, which this batch does not keep")
                    .help("leave it out, or give --keep table or --keep top"),
            );
        }
        let shard = self.shard.unwrap_or(Shard::WHOLE);
        let Pairs { own, total, sha256 } = pairs(&self.pairs, shard, &directory, &self.options)?;
        console.say(format!(
            "Docking {} of {}{} into {}",
            counted(own.len(), "pair"),
            self.pairs.display(),
            match self.shard {
                Some(shard) => format!(" (shard {shard} of its {total})"),
                None => String::new(),
            },
            directory.display()
        ));
        let rows = self.rows.unwrap_or(AllOr(Some(ROWS)));
        let names = own
            .iter()
            .map(|pair| (pair.name.clone(), pair.row.checksum()));
        let names = names.collect();
        let run = BatchRun {
            record: BatchRecord::new(shard, total, sha256, self.options, self.keep, rows.0, names),
            directory,
            scratch: self.scratch,
            threads: self.threads,
            limits: self.limits,
            retry_failed: self.retry_failed,
            is_shard: self.shard.is_some(),
        };
        let code = run.dock(own, console)?;
        Ok(if self.failures_ok { 0 } else { code })
    }
}

/// Rows of a pair that are kept where their number is not given: some 35 kB.
const ROWS: usize = 200;
