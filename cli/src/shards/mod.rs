//! Batches: one table of results and one file of poses for many pairs, which grow pair by pair.
//!
//! A batch and each of its N shards have their own folder, `shards/0003-of-0100`. It holds
//!
//! | file | what |
//! |---|---|
//! | `batch.json` | the pairs and options of the batch ([`record`]) |
//! | `results.csv` | one row per pair, in the order in which they were done until all are |
//! | `poses.csv.gz` | the first poses of each pair: one gzip member per pair |
//! | `attempts.csv` | the names of pairs that were started, so that a pair that ends the process is given up in the end |
//!
//! A pair's poses are written first, then its row, each to the device ([`part`]). A batch that is killed goes on with
//! the pairs that lack one of them. [`merge`] puts the pairs of all shards in the order of the table. The bytes are the
//! same for any number of shards.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

pub mod merge;
pub mod part;
mod poses_file;
pub mod record;
pub mod scratch;

pub use poses_file::{PosesOfPair, WIDE_COLUMNS};

/// Name of the folder that holds the folders of shards.
pub const SHARDS: &str = "shards";
/// Name of the file of poses, of a shard and of the whole batch.
pub const POSES: &str = "poses.csv.gz";
/// Name of the list of attempts.
pub const ATTEMPTS: &str = "attempts.csv";

/// One of several parts of a batch: every `count`-th pair, beginning with pair `index`. Both count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// The whole batch as one shard.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    pub fn index(self) -> usize {
        self.index
    }

    /// How many there are.
    pub fn count(self) -> usize {
        self.count
    }

    /// Whether it has the pair of a row of the table, rows counted from 1.
    pub fn has(self, row: usize) -> bool {
        row >= 1 && (row - 1) % self.count == self.index - 1
    }

    /// The row of the table that its pair of a place has; places count from 0, rows from 1.
    pub fn row(self, place: usize) -> usize {
        self.index + place * self.count
    }

    pub fn folder(self) -> String {
        format!("{:04}-of-{:04}", self.index, self.count)
    }
}

const MOST: usize = 1_000_000;

impl TryFrom<String> for Shard {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let numbers = parts.map(|(index, count)| (index.parse(), count.parse()));
        match numbers {
            Some((Ok(index), Ok(count))) if (1..=count).contains(&index) && count <= MOST => {
                Ok(Self { index, count })
            }
            _ => Err(
                "write I/N: which of how many shards, such as 3/100, from 1/N to N/N, N at most 1000000"
                    .to_owned(),
            ),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_is_in_one_shard() {
        for count in [1usize, 2, 7, 30] {
            let shards =
                (1..=count).map(|index| format!("{index}/{count}").parse::<Shard>().unwrap());
            let shards: Vec<Shard> = shards.collect();
            for row in 1..=100 {
                assert_eq!(shards.iter().filter(|shard| shard.has(row)).count(), 1);
            }
            assert!(shards.iter().all(|shard| !shard.has(0)));
            assert!(
                shards
                    .iter()
                    .all(|shard| shard.has(shard.row(9)) && shard.has(shard.row(0)))
            );
        }
        for text in [
            "",
            "3",
            "0/4",
            "5/4",
            "1/0",
            "a/b",
            "1/2/3",
            "-1/2",
            "1/1000001",
        ] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
        assert_eq!("3/100".parse::<Shard>().unwrap().folder(), "0003-of-0100");
    }
}
