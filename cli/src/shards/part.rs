//! The growing files of a batch or a shard: opening them indexes their pairs, and each pair is added whole.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use super::poses_file::{Members, copy_range, header};
use super::record::BatchRecord;
use super::{ATTEMPTS, POSES, PosesOfPair};
use crate::tables::batch_results::{PairResult, RESULTS, head, name_and_status, row};
use knotdock::output::files::appended::AppendedFile;
use knotdock::output::files::file_error;
use knotdock::output::files::folder::{next_line, open_own};
use knotdock::output::files::whole_file::StagedFile;
use knotdock::table_text::cells::unquoted;
use knotdock_structures::Error;

/// A batch's or a shard's files, open for further pairs.
#[derive(Debug)]
pub struct Part {
    folder: PathBuf,
    results: AppendedFile,
    poses: Option<AppendedFile>,
    attempts: AppendedFile,
    pairs: HashMap<String, PairFiles>,
    started: HashMap<String, usize>,
    /// Pairs that were listed as done and have to be docked again, since a file is damaged.
    pub lost: usize,
}

impl Part {
    /// Opens or makes the files in a folder; incomplete pairs and everything after damage is cut off.
    pub fn open(folder: &Path, record: &BatchRecord) -> Result<Self, Error> {
        let has_poses = record.keep.has_poses();
        let found = Index::of(folder, has_poses)?;
        let [results, poses, attempts] = [RESULTS, POSES, ATTEMPTS].map(|name| folder.join(name));
        let (mut started, mut whole) = (HashMap::new(), 0);
        read_lines(&attempts, |line, (_, end)| {
            let name = String::from_utf8_lossy(line).into_owned();
            *started.entry(name).or_insert(0) += 1;
            whole = end;
            true
        })?;
        let mut part = Self {
            folder: folder.to_owned(),
            results: AppendedFile::open(&results, found.results_end)?,
            poses: has_poses
                .then(|| AppendedFile::open(&poses, found.poses_end))
                .transpose()?,
            attempts: AppendedFile::open(&attempts, whole)?,
            pairs: found.pairs,
            started,
            lost: found.lost,
        };
        if let (0, Some(poses)) = (found.poses_end, &mut part.poses) {
            let header = header().map_err(|error| file_error::writing(folder, error))?;
            poses.append(&header)?;
        }
        if found.results_end == 0 {
            part.results.append(&head())?;
        }
        Ok(part)
    }

    /// Whether a pair was docked, or failed; `None` for neither.
    pub fn is_done(&self, name: &str) -> Option<bool> {
        self.pairs.get(name).map(|pair| pair.is_done)
    }

    pub fn attempts(&self, name: &str) -> usize {
        self.started.get(name).copied().unwrap_or(0)
    }

    /// Pairs that were docked, and pairs that failed.
    pub fn counts(&self) -> [usize; 2] {
        let done = self.pairs.values().filter(|pair| pair.is_done).count();
        [done, self.pairs.len() - done]
    }

    pub fn start(&mut self, name: &str) -> Result<(), Error> {
        self.attempts.append(format!("{name}\n").as_bytes())?;
        *self.started.entry(name.to_owned()).or_insert(0) += 1;
        Ok(())
    }

    /// Adds the result of a pair: its poses, if they are kept and it has some, then its row.
    pub fn add(&mut self, result: &PairResult, poses: Option<&PosesOfPair>) -> Result<(), Error> {
        let poses = match (&mut self.poses, poses) {
            (Some(file), Some(poses)) => Some(file.append(poses.bytes())?),
            _ => None,
        };
        let pair = PairFiles {
            is_done: result.outcome.is_ok(),
            row: self.results.append(&row(result))?,
            poses,
        };
        self.pairs.insert(result.name.clone(), pair);
        Ok(())
    }

    /// Puts rows and poses in the order of the table, each pair once, when all of them are there.
    pub fn finish(self, record: &BatchRecord) -> Result<(), Error> {
        let names = record.own.iter().map(|(name, _)| name);
        let pairs: Vec<&PairFiles> = names.filter_map(|name| self.pairs.get(name)).collect();
        let folder = &self.folder;
        if let Some(file) = &self.poses {
            let header = header().map_err(|error| file_error::writing(folder, error))?;
            let poses: Vec<Range> = pairs.iter().filter_map(|pair| pair.poses).collect();
            put_in_order(&folder.join(POSES), &header, &poses, file.end())?;
        }
        let rows: Vec<Range> = pairs.iter().map(|pair| pair.row).collect();
        put_in_order(&folder.join(RESULTS), &head(), &rows, self.results.end())
    }
}

/// Start and end of a part of a file, in bytes.
pub(super) type Range = (u64, u64);

/// Writes a file anew with some of its parts in another order, if it has them in another.
fn put_in_order(path: &Path, head: &[u8], parts: &[Range], end: u64) -> Result<(), Error> {
    let start = head.len() as u64;
    let follows = |at: u64, part: &Range| (part.0 == at).then_some(part.1);
    if parts.iter().try_fold(start, follows) == Some(end) {
        return Ok(());
    }
    let mut file = open_own(path)?;
    let sorted = StagedFile::own(path, |new| {
        new.write_all(head)?;
        parts
            .iter()
            .try_for_each(|part| copy_range(&mut file, *part, new))
    })?;
    sorted.place()
}

#[derive(Debug)]
pub(super) struct PairFiles {
    pub is_done: bool,
    pub row: Range,
    pub poses: Option<Range>,
}

/// Index of the files of a part.
pub(super) struct Index {
    /// Each pair by its name: of several rows or poses the last ones count.
    pub pairs: HashMap<String, PairFiles>,
    results_end: u64,
    poses_end: u64,
    lost: usize,
}

impl Index {
    pub fn of(folder: &Path, has_poses: bool) -> Result<Self, Error> {
        let mut poses = HashMap::new();
        let mut poses_end = 0;
        let path = folder.join(POSES);
        if has_poses && path.symlink_metadata().is_ok() {
            let refused = |source: io::Error| match source.kind() {
                io::ErrorKind::FileTooLarge => file_error::refused(
                    &path,
                    format!("this is no file of poses of a batch: {source}"),
                    "remove its folder, and dock it again",
                ),
                _ => file_error::reading(&path, source),
            };
            let mut members = Members::of(open_own(&path)?);
            while let Some(member) = members.next().map_err(refused)? {
                poses_end = member.range.1;
                poses.insert(first_field(&member.first_line), member.range);
            }
        }
        let mut index = Self {
            pairs: HashMap::new(),
            results_end: 0,
            poses_end,
            lost: 0,
        };
        let path = folder.join(RESULTS);
        let head = head();
        let mut is_other = false;
        read_lines(&path, |line, range| {
            if range.0 == 0 {
                is_other = line != &head[..head.len() - 1];
            } else {
                let Some((name, is_done)) = name_and_status(line) else {
                    return false;
                };
                let poses = poses.get(&name).copied().filter(|_| is_done);
                let pair = PairFiles {
                    is_done,
                    row: range,
                    poses,
                };
                index.pairs.insert(name, pair);
            }
            index.results_end = range.1;
            !is_other
        })?;
        if is_other {
            let message = "this is not a table of results of a batch";
            return Err(file_error::refused(
                &path,
                message,
                "remove its folder, and dock it again",
            ));
        }
        let all = index.pairs.len();
        index
            .pairs
            .retain(|_, pair| !has_poses || !pair.is_done || pair.poses.is_some());
        index.lost = all - index.pairs.len();
        Ok(index)
    }
}

/// Hands the whole lines of a file and their ranges to `take`, until it returns false; none if there is no file.
fn read_lines(path: &Path, mut take: impl FnMut(&[u8], Range) -> bool) -> Result<(), Error> {
    if path.symlink_metadata().is_err() {
        return Ok(());
    }
    let mut file: BufReader<File> = BufReader::new(open_own(path)?);
    let (mut line, mut start) = (Vec::new(), 0);
    while next_line(&mut file, &mut line).map_err(|source| {
        file_error::refused(
            path,
            format!("cannot read {}: {source}", path.display()),
            "remove its folder, and dock it again",
        )
    })? {
        let end = start + line.len() as u64 + 1;
        if !take(&line, (start, end)) {
            break;
        }
        start = end;
    }
    Ok(())
}

fn first_field(line: &[u8]) -> String {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(line);
    let mut record = csv::StringRecord::new();
    let _ = reader.read_record(&mut record);
    unquoted(record.get(0).unwrap_or_default()).to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::Shard;
    use super::super::record::Keep;
    use super::*;
    use std::fs;

    fn result(name: &str, error: &str) -> PairResult {
        PairResult {
            name: name.to_owned(),
            receptor: "a,b.pdb".to_owned(),
            ligand: "=c.pdb".to_owned(),
            outcome: Err(error.to_owned()),
        }
    }

    /// Wherever a table is cut, the rows before that place are found, and rows that are added follow them.
    #[test]
    fn whole_rows_are_found_in_what_is_left() {
        let own = ["x", "y"]
            .map(|name| (name.to_owned(), String::new()))
            .into();
        let record = BatchRecord::new(
            Shard::WHOLE,
            2,
            String::new(),
            Vec::new(),
            Keep::None,
            None,
            own,
        );
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(RESULTS);
        let mut part = Part::open(folder.path(), &record).unwrap();
        let mut ends = Vec::new();
        for pair in [result("y", "of\n\"two\" lines\n"), result("x", "")] {
            part.add(&pair, None).unwrap();
            ends.push(fs::metadata(&path).unwrap().len() as usize);
        }
        drop(part);
        let bytes = fs::read(&path).unwrap();
        for length in 0..=bytes.len() {
            fs::write(&path, &bytes[..length]).unwrap();
            let expected = ends.iter().filter(|end| **end <= length).count();
            let mut part = Part::open(folder.path(), &record).unwrap();
            assert_eq!(part.counts(), [0, expected], "{length}");
            for pair in [result("y", "of\n\"two\" lines\n"), result("x", "")] {
                if part.is_done(&pair.name).is_none() {
                    part.add(&pair, None).unwrap();
                }
            }
            part.finish(&record).unwrap();
            let text = fs::read_to_string(&path).unwrap();
            let rows = csv::Reader::from_reader(text.as_bytes()).into_records();
            let names: Vec<String> = rows.map(|row| row.unwrap()[0].to_owned()).collect();
            assert_eq!(names, ["x", "y"], "{length}");
        }
        fs::write(&path, "name,value\n").unwrap();
        assert!(Part::open(folder.path(), &record).is_err());
    }
}
