//! The files of a shard as they grow: what is there is known when they are opened, and what is added is whole.

use std::collections::{HashMap, HashSet};
use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::members::Members;
use super::record::ShardRecord;
use super::results::{ResultRow, head, of_pair, rows};
use super::{POSES, PosesOfPair, ShardError, pose_rows};
use crate::output::files::appended::AppendedFile;
use crate::output::tables::batch_results::{PairResult, RESULTS};

/// Name of the list of attempts.
const ATTEMPTS: &str = "attempts.csv";

/// A shard's files, open for further pairs.
#[derive(Debug)]
pub struct Journal {
    results: AppendedFile,
    poses: Option<AppendedFile>,
    attempts_file: AppendedFile,
    /// Rows of pairs that have been docked, and of those that failed.
    done: HashSet<usize>,
    failed: HashSet<usize>,
    /// How often each pair was started.
    started: HashMap<usize, usize>,
    /// What of the files was of no use, if anything.
    lost: usize,
}

impl Journal {
    /// Opens a shard's files in its folder, or makes them. Where they end in the midst of a pair, that pair's part is
    /// cut off; so are pairs behind a place that is damaged.
    ///
    /// # Errors
    /// [`ShardError`] when the folder holds a shard of another batch, and when a file cannot be read or written.
    pub fn open(folder: &Path, record: &ShardRecord) -> Result<Self, ShardError> {
        match ShardRecord::read(folder)? {
            Some(found) if found != *record => {
                return Err(ShardError::wrong(
                    folder,
                    "the folder holds a shard of other pairs or options, or by another version",
                    "choose another directory with -o, or remove that folder",
                ));
            }
            Some(_) => {}
            None => {
                // The record comes before all others, so that these are none of a shard's.
                let files = [RESULTS, POSES, ATTEMPTS].map(|name| folder.join(name));
                if let Some(file) = files.iter().find(|file| file.exists()) {
                    return Err(ShardError::wrong(
                        file,
                        "the file belongs to no shard: there is no shard.json beside it",
                        "choose another directory with -o, or move the file away",
                    ));
                }
                record.write(folder)?;
            }
        }
        let results = folder.join(RESULTS);
        let found = rows(&results, &bytes_of(&results)?)?;
        let mut kept = found.len();
        let mut ends = (0, 0);
        let poses = folder.join(POSES);
        if record.keep.has_poses() {
            (kept, ends.1) = whole_pairs(&poses, &found)?;
        }
        let lost = found.len() - kept;
        let (mut done, mut failed) = (HashSet::new(), HashSet::new());
        for row in found.iter().take(kept) {
            let place = if row.is_done() {
                &mut done
            } else {
                &mut failed
            };
            place.insert(row.row);
            ends.0 = row.end;
        }
        let mut started = HashMap::new();
        let attempts = folder.join(ATTEMPTS);
        let listed = bytes_of(&attempts)?;
        let whole = listed
            .iter()
            .rposition(|&byte| byte == b'\n')
            .map_or(0, |end| end + 1);
        for line in listed[..whole].split(|&byte| byte == b'\n') {
            let row = std::str::from_utf8(line)
                .ok()
                .and_then(|row| row.parse().ok());
            if let Some(row) = row {
                *started.entry(row).or_insert(0) += 1;
            }
        }
        let mut journal = Self {
            results: AppendedFile::open(&results, ends.0)?,
            poses: match record.keep.has_poses() {
                true => Some(AppendedFile::open(&poses, ends.1)?),
                false => None,
            },
            attempts_file: AppendedFile::open(&attempts, whole as u64)?,
            done,
            failed,
            started,
            lost,
        };
        if ends.1 == 0
            && let Some(poses) = &mut journal.poses
        {
            let header = pose_rows::header().map_err(ShardError::reading(folder))?;
            poses.append(&header)?;
        }
        if ends.0 == 0 {
            journal.results.append(&head())?;
        }
        Ok(journal)
    }

    /// Whether a pair has been docked.
    pub fn is_done(&self, row: usize) -> bool {
        self.done.contains(&row)
    }

    /// Whether a pair failed, and was not docked since.
    pub fn has_failed(&self, row: usize) -> bool {
        self.failed.contains(&row) && !self.is_done(row)
    }

    /// How often a pair was started.
    pub fn attempts(&self, row: usize) -> usize {
        self.started.get(&row).copied().unwrap_or(0)
    }

    /// Pairs that were listed as done and have to be docked again, since a file is damaged.
    pub fn lost(&self) -> usize {
        self.lost
    }

    /// Pairs that were docked, and pairs that failed.
    pub fn counts(&self) -> [usize; 2] {
        let failed = self.failed.iter().filter(|row| !self.done.contains(*row));
        [self.done.len(), failed.count()]
    }

    /// Notes that a pair is started.
    ///
    /// # Errors
    /// [`ShardError::File`].
    pub fn start(&mut self, row: usize) -> Result<(), ShardError> {
        self.attempts_file.append(format!("{row}\n").as_bytes())?;
        *self.started.entry(row).or_insert(0) += 1;
        Ok(())
    }

    /// Adds what came of a pair: its poses, where they are kept and it has some, then its row.
    ///
    /// # Errors
    /// [`ShardError::File`]; the pair is not in the shard then, and nothing of it is in the way.
    pub fn add(
        &mut self,
        row: usize,
        result: &PairResult,
        poses: Option<&PosesOfPair>,
    ) -> Result<(), ShardError> {
        let is_done = matches!(result.outcome, Some(Ok(_)));
        if let (Some(file), Some(poses), true) = (&mut self.poses, poses, is_done) {
            file.append(poses.bytes())?;
        }
        self.results.append(&of_pair(row, result))?;
        let place = if is_done {
            &mut self.done
        } else {
            &mut self.failed
        };
        place.insert(row);
        Ok(())
    }
}

/// A file's bytes; none where it is not there.
fn bytes_of(path: &Path) -> Result<Vec<u8>, ShardError> {
    let mut bytes = Vec::new();
    match File::open(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
        Err(error) => return Err(ShardError::reading(path)(error)),
        Ok(mut file) => {
            file.read_to_end(&mut bytes)
                .map_err(ShardError::reading(path))?;
        }
    }
    Ok(bytes)
}

/// A pair of a shard: its row, and where its poses are in the shard's file.
pub(super) struct ShardPair {
    pub row: ResultRow,
    pub poses: Option<(u64, u64)>,
}

/// How many of the rows have their poses, and where these end.
fn whole_pairs(poses: &Path, rows: &[ResultRow]) -> Result<(usize, u64), ShardError> {
    let (pairs, end) = with_poses(poses, rows.to_vec())?;
    Ok((pairs.len(), end))
}

/// The first rows, as far as those of pairs that were docked have their poses; and where these end.
pub(super) fn with_poses(
    path: &Path,
    rows: Vec<ResultRow>,
) -> Result<(Vec<ShardPair>, u64), ShardError> {
    let failed = || ShardError::reading(path);
    if !path.exists() {
        return Ok((Vec::new(), 0));
    }
    let mut members = Members::of(path).map_err(failed())?;
    let Some(header) = members.next().map_err(failed())? else {
        return Ok((Vec::new(), 0));
    };
    let (mut pairs, mut end) = (Vec::new(), header.range.1);
    for row in rows {
        let poses = if row.is_done() {
            match members.next().map_err(failed())? {
                Some(member) if is_of(&member.first_line, row.name()) => {
                    end = member.range.1;
                    Some(member.range)
                }
                _ => break,
            }
        } else {
            None
        };
        pairs.push(ShardPair { row, poses });
    }
    Ok((pairs, end))
}

/// Whether a row of poses is of a pair.
fn is_of(line: &[u8], name: &str) -> bool {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(line);
    let mut record = csv::StringRecord::new();
    matches!(reader.read_record(&mut record), Ok(true))
        && record.get(0).map(crate::output::tables::cells::unquoted) == Some(name)
}
