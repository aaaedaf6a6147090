//! `shard.json`: which pairs and options a shard is of.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{Shard, ShardError};
use crate::bounded_read::{MAX_RECORD, read_bounded_file};
use crate::output::files::whole_file::{to_json, write_whole};
use crate::output::records::program::VERSION_WITH_COMMIT;

/// Name of the file.
pub const RECORD: &str = "shard.json";

/// What is kept of each pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Keep {
    /// Its row of results.csv.
    None,
    /// Its first poses too, in poses.csv.gz.
    Table,
    /// The complexes of its best poses too, in a folder of its name.
    Top,
    /// Its whole run, in a directory of its name.
    All,
}

impl Keep {
    /// Whether there is a file of poses.
    pub fn has_poses(self) -> bool {
        matches!(self, Self::Table | Self::Top)
    }
}

/// A shard's record. Two shards that differ in nothing but [`Self::shard`] belong to one batch.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShardRecord {
    /// Version and commit of the program.
    pub knotdock: String,
    /// Which shard.
    pub shard: Shard,
    /// Rows of the table of pairs.
    pub pairs: usize,
    /// SHA-256 of the table of pairs.
    pub table_sha256: String,
    /// Options of `knotdock dock` for all pairs.
    pub options: Vec<String>,
    /// What is kept of each pair.
    pub keep: Keep,
    /// Rows that are kept of each pair's table of poses; `None` for all.
    pub rows: Option<usize>,
}

impl ShardRecord {
    /// The record of a shard of this program.
    pub fn new(
        shard: Shard,
        (pairs, table_sha256): (usize, String),
        options: Vec<String>,
        (keep, rows): (Keep, Option<usize>),
    ) -> Self {
        Self {
            knotdock: VERSION_WITH_COMMIT.to_owned(),
            shard,
            pairs,
            table_sha256,
            options,
            keep,
            rows,
        }
    }

    /// The same of another shard of the batch.
    pub fn of_shard(&self, shard: Shard) -> Self {
        Self {
            shard,
            ..self.clone()
        }
    }

    /// Reads the record in a shard's folder; `None` where there is none.
    ///
    /// # Errors
    /// [`ShardError`] when it cannot be read or is no such record.
    pub fn read(folder: &Path) -> Result<Option<Self>, ShardError> {
        let path = folder.join(RECORD);
        if !path.exists() {
            return Ok(None);
        }
        let bytes = read_bounded_file(&path, MAX_RECORD).map_err(ShardError::reading(&path))?;
        serde_json::from_slice(&bytes).map(Some).map_err(|error| {
            let message = format!("this is not the record of a shard: {error}");
            ShardError::wrong(
                &path,
                message,
                "remove the shard's folder, and dock it again",
            )
        })
    }

    /// Writes it into the shard's folder, whole.
    ///
    /// # Errors
    /// [`ShardError::File`].
    pub fn write(&self, folder: &Path) -> Result<(), ShardError> {
        let path = folder.join(RECORD);
        Ok(write_whole(&path, |file| to_json(file, self))?)
    }
}
