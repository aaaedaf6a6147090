//! The files that runs wrote, by their records: all other files in a run's directory are the user's.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::bounded_read::{MAX_RECORD, read_bounded_file};

use super::checksum::sha256_of_file;
use super::seal::{REPORT, is_sealed};

/// The record of `knotdock dock`.
pub const RUN: &str = "run.json";
/// The record of `knotdock dock` of several conformations.
pub const ENSEMBLE: &str = "ensemble.json";
/// The record of `knotdock tradeoff`.
pub const TRADEOFF: &str = "tradeoff.json";
/// The list of a run's additions, with checksums as `files`.
pub const ADDED: &str = "added.json";

/// Folder of an ensemble that holds its runs.
pub const MEMBERS: &str = "members";

/// The files of a directory that no run in it wrote as they are.
pub(super) fn not_own(place: &Path, files: &[PathBuf]) -> io::Result<Vec<PathBuf>> {
    let mut own = OwnFiles::default();
    for path in files.iter().filter(|path| is_record(path)) {
        let folder = path.parent().unwrap_or(Path::new(""));
        let is_run = folder == Path::new("") || folder.parent() == Some(Path::new(MEMBERS));
        if is_run && is_of_us(&place.join(path)) {
            own.add(place, folder)?;
        }
    }
    let mut others = Vec::new();
    for path in files {
        if !own.holds(place, path)? {
            others.push(path.clone());
        }
    }
    Ok(others)
}

/// Whether a path ends with the name of a record.
pub(super) fn is_record(path: &Path) -> bool {
    let is_of = |record: &&str| path.file_name() == Some(OsStr::new(record));
    [RUN, ENSEMBLE, TRADEOFF, ADDED].iter().any(is_of)
}

/// The files of runs, as their records list them.
#[derive(Debug, Default)]
pub(super) struct OwnFiles {
    /// Checksums that a file may have, by its path.
    checksums: BTreeMap<PathBuf, Vec<String>>,
    /// Records, which list no checksum of themselves.
    records: BTreeSet<PathBuf>,
    /// Reports, whose seals show that they are as they were written.
    reports: BTreeSet<PathBuf>,
}

impl OwnFiles {
    /// Adds those of a run in a folder of a directory.
    pub fn add(&mut self, place: &Path, folder: &Path) -> io::Result<()> {
        for record in [RUN, ENSEMBLE, TRADEOFF, ADDED] {
            let path = folder.join(record);
            if !is_of_us(&place.join(&path)) {
                continue;
            }
            let listed = read_record(&place.join(&path))?;
            for (name, checksum) in listed["files"].as_object().into_iter().flatten() {
                let sums = self.checksums.entry(folder.join(name)).or_default();
                sums.extend(checksum.as_str().map(str::to_owned));
            }
            self.records.insert(path);
        }
        self.reports.insert(folder.join(REPORT));
        Ok(())
    }

    /// Whether a file is as a run wrote it.
    pub fn holds(&self, place: &Path, path: &Path) -> io::Result<bool> {
        let file = place.join(path);
        if !file.symlink_metadata()?.is_file() {
            return Ok(false);
        }
        if self.records.contains(path) || (self.reports.contains(path) && is_sealed(&file)) {
            return Ok(true);
        }
        match self.checksums.get(path) {
            Some(sums) => Ok(sums.contains(&sha256_of_file(&file)?)),
            None => Ok(false),
        }
    }
}

/// Whether a directory holds a run, an ensemble or a sweep.
pub fn is_run(directory: &Path) -> bool {
    let mut records = [RUN, ENSEMBLE, TRADEOFF].iter();
    records.any(|record| is_of_us(&directory.join(record)))
}

/// Whether a file is a record of this program.
pub(super) fn is_of_us(path: &Path) -> bool {
    let is_file = path.symlink_metadata().is_ok_and(|found| found.is_file());
    is_file && read_record(path).is_ok_and(|record| record["program"] == "knotdock")
}

fn read_record(path: &Path) -> io::Result<Value> {
    let bytes = read_bounded_file(path, MAX_RECORD)?;
    Ok(serde_json::from_slice(&bytes)?)
}

/// A path from a folder, with `/` between its parts.
pub(super) fn name_of(path: &Path) -> String {
    let parts = path.iter().map(|part| part.to_string_lossy());
    parts.collect::<Vec<_>>().join("/")
}
