//! `batch.json`: which pairs and options a batch, or a shard of it, is of.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{ATTEMPTS, POSES, Shard};
use crate::tables::batch_results::RESULTS;
use knotdock::bounded_read::MAX_RECORD;
use knotdock::output::files::file_error;
use knotdock::output::files::folder::{make_folder, names_in, read_own};
use knotdock::output::files::lock::Lock;
use knotdock::output::files::whole_file::{StagedFile, is_link, leftovers};
use knotdock::output::records::program::VERSION_WITH_COMMIT;
use knotdock_structures::Error;

pub const RECORD: &str = "batch.json";
/// Name of the lock in the folder.
const LOCK: &str = ".knotdock-lock";

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

/// The record of a batch or a shard. Shards of one batch differ in nothing but [`Self::shard`] and [`Self::own`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatchRecord {
    /// Always `knotdock`.
    program: String,
    /// Version and commit of the program.
    pub knotdock: String,
    pub shard: Shard,
    /// Rows of the table of pairs.
    pub pairs: usize,
    /// SHA-256 of the rows of the table of pairs.
    pub table_sha256: String,
    /// Options of `knotdock dock` for all pairs.
    pub options: Vec<String>,
    pub keep: Keep,
    /// Rows that are kept of each pair's table of poses; `None` for all.
    pub rows: Option<usize>,
    /// Its pairs in the order of the table: name and checksum of the row of each.
    pub own: Vec<(String, String)>,
}

impl BatchRecord {
    pub fn new(
        shard: Shard,
        pairs: usize,
        table_sha256: String,
        options: Vec<String>,
        keep: Keep,
        rows: Option<usize>,
        own: Vec<(String, String)>,
    ) -> Self {
        Self {
            program: "knotdock".to_owned(),
            knotdock: VERSION_WITH_COMMIT.to_owned(),
            shard,
            pairs,
            table_sha256,
            options,
            keep,
            rows,
            own,
        }
    }

    /// Whether two shards are of one batch.
    pub fn is_of_batch_of(&self, other: &Self) -> bool {
        let of_all = |record: &Self| Self {
            shard: Shard::WHOLE,
            own: Vec::new(),
            ..record.clone()
        };
        self.shard.count() == other.shard.count() && of_all(self) == of_all(other)
    }

    pub fn read(folder: &Path) -> Result<Option<Self>, Error> {
        let path = folder.join(RECORD);
        if path.symlink_metadata().is_err() {
            return Ok(None);
        }
        let bytes = read_own(&path, MAX_RECORD)?;
        serde_json::from_slice(&bytes).map(Some).map_err(|error| {
            let message = format!("this is not the record of a batch: {error}");
            file_error::refused(&path, message, "remove its folder, and dock it again")
        })
    }

    /// Takes a new or empty folder, or one with this record; the lock to hold, and leftovers of ended commands.
    pub fn take(&self, folder: &Path) -> Result<(Lock, Vec<PathBuf>), Error> {
        if is_link(folder) {
            return Err(file_error::link(folder));
        }
        make_folder(folder)?;
        let lock = Lock::take(&folder.join(LOCK))?;
        let left = left_in(folder);
        match Self::read(folder)? {
            Some(found) => self.check(&found, folder)?,
            None => {
                if let Some(other) = Self::others_in(folder)? {
                    return Err(file_error::refused(
                        folder,
                        format!(
                            "the directory is not empty and holds no batch of knotdock: there is {other}"
                        ),
                        "choose another directory with -o",
                    ));
                }
                self.write(folder)?;
            }
        }
        Ok((lock, left))
    }

    /// Something in a folder that no ended command of a batch left there.
    pub(super) fn others_in(folder: &Path) -> Result<Option<String>, Error> {
        let left = left_in(folder);
        let is_left = |name: &str| left.iter().any(|path| path.ends_with(name));
        let mut names = names_in(folder)?.into_iter();
        Ok(names.find(|name| name != LOCK && !is_left(name)))
    }

    pub(super) fn write(&self, folder: &Path) -> Result<(), Error> {
        let write = |file: &mut dyn Write| Ok(serde_json::to_writer(file, self)?);
        StagedFile::own(&folder.join(RECORD), write)?.place()
    }

    /// Refuses a folder with the record of another batch; rows that differ are named.
    fn check(&self, found: &Self, folder: &Path) -> Result<(), Error> {
        let refused = |message: String| Err(file_error::refused(folder, message, OTHER));
        let rows = found.own.len().max(self.own.len());
        let differs = |&row: &usize| found.own.get(row) != self.own.get(row);
        let differing: Vec<usize> = (0..rows).filter(differs).collect();
        if !differing.is_empty() {
            let of = |row: &usize| {
                let names = [self, found].map(|record| record.own.get(*row).map(|own| &own.0));
                let name = names.into_iter().flatten().next();
                let number = self.shard.row(*row);
                name.map_or(number.to_string(), |name| format!("{number} ({name})"))
            };
            let shown: Vec<String> = differing.iter().take(5).map(of).collect();
            let more = differing.len().saturating_sub(shown.len());
            let more = match more {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            return refused(format!(
                "the table of pairs has changed in row {}{more}",
                shown.join(", ")
            ));
        }
        if found.table_sha256 != self.table_sha256 {
            return refused("the table of pairs has changed in rows of other shards".to_owned());
        }
        // A pair's own run says whether it is of the same options.
        let is_same = match self.keep {
            Keep::All => found.keep == Keep::All && found.shard == self.shard,
            _ => found == self,
        };
        if is_same {
            return Ok(());
        }
        refused("the directory holds a batch of other options, or by another version".to_owned())
    }
}

/// What ended commands left of a batch's files in a folder.
fn left_in(folder: &Path) -> Vec<PathBuf> {
    let files = [RECORD, RESULTS, POSES, ATTEMPTS].into_iter();
    files
        .flat_map(|name| leftovers(&folder.join(name)))
        .collect()
}

const OTHER: &str =
    "choose another directory with -o, or give the table and the options as they were";
