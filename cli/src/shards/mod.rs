//! Batches: one table of results and one file of poses for many pairs, which grow pair by pair.
//!
//! A batch has a folder of its own, and so has each of its N shards, `shards/0003-of-0100`. It holds
//!
//! | file | what |
//! |---|---|
//! | `batch.json` | which pairs and options it is of ([`record`]) |
//! | `results.csv` | one row per pair, in the order in which they were done until all are |
//! | `poses.csv.gz` | the first poses of each pair: one gzip member per pair |
//! | `attempts.csv` | the names of pairs that were started, so that a pair that ends the process is given up in the end |
//!
//! A pair's poses are written first, then its row, each to the device ([`part`]). A batch that is killed goes on with
//! the pairs that lack one of them. [`merge`] puts the pairs of all shards in the order of the table: the same bytes for
//! any number of shards.

pub mod merge;
pub mod part;
mod poses_file;
pub mod record;
pub mod scratch;
mod shard;

pub use poses_file::{PosesOfPair, WIDE_COLUMNS};
pub use shard::Shard;

/// Name of the folder that holds the folders of shards.
pub const SHARDS: &str = "shards";
/// Name of the file of poses, of a shard and of the whole batch.
pub const POSES: &str = "poses.csv.gz";
/// Name of the list of attempts.
pub const ATTEMPTS: &str = "attempts.csv";
