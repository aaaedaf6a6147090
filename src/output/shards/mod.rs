//! Shards of a batch: one table of results and one file of poses for many pairs.
//!
//! A batch of N shards has a folder for each, `shards/0003-of-0100`, with
//!
//! | file | what |
//! |---|---|
//! | `shard.json` | which pairs and options it is of ([`record`]) |
//! | `results.csv` | a row a pair in the order in which they were done: the pair's row in the table of pairs, then the columns of a batch's `results.csv` |
//! | `poses.csv.gz` | the first poses of each pair: a gzip member a pair, in the same order |
//! | `attempts.csv` | the rows of pairs that were started, so that a pair that ends the process is not started for ever |
//!
//! A pair's poses are written first, then its row, each to the device ([`journal`]). A shard that is killed goes on
//! after the last pair that has both. [`merge`] puts the pairs of all shards in the order of the table: the same bytes
//! for any number of shards.

pub mod journal;
mod members;
pub mod merge;
mod pose_rows;
pub mod record;
mod results;
mod shard;
mod shard_error;

pub use pose_rows::{PosesOfPair, WIDE_COLUMNS};
pub use shard::Shard;
pub use shard_error::ShardError;

/// Name of the folder that holds the folders of shards.
pub const SHARDS: &str = "shards";
/// Name of the file of poses, of a shard and of the whole batch.
pub const POSES: &str = "poses.csv.gz";
