//! The shards of a batch put together, in the order of the table of pairs.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use super::part::{Index, PairFiles, Range};
use super::poses_file::{copy_range, header};
use super::record::BatchRecord;
use super::{POSES, SHARDS, Shard};
use crate::tables::batch_results::{RESULTS, head};
use knotdock::output::files::file_error;
use knotdock::output::files::folder::{make_folder, open_own};
use knotdock::output::files::whole_file::{StagedFile, is_link, leftovers};
use knotdock_structures::Error;

/// Files that are open at the same time.
const OPEN: usize = 128;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Merged {
    pub shards: Vec<Shard>,
    /// Pairs of the batch, those that were docked, and those that failed.
    pub counts: [usize; 3],
    pub results: PathBuf,
    pub poses: Option<PathBuf>,
    /// Files that ended commands left beside them.
    pub leftovers: Vec<PathBuf>,
}

/// A pair of the batch: its shard, and the ranges of its row and its poses in the shard's files.
struct MergedPair {
    shard: usize,
    files: PairFiles,
}

/// Merges the shards in some directories of a batch into `out`: `results.csv`, and `poses.csv.gz` where poses are kept.
/// The bytes do not depend on how many shards there are, on their places or their order. With `partial` pairs and
/// shards may be missing. Other files of these names are replaced only with `force`.
pub fn merge(
    directories: &[PathBuf],
    out: &Path,
    partial: bool,
    force: bool,
) -> Result<Merged, Error> {
    let folder_of =
        |shard: Shard, directory: usize| directories[directory].join(SHARDS).join(shard.folder());
    let mut shards: Vec<(Shard, usize)> = Vec::new();
    let mut first: Option<BatchRecord> = None;
    let mut pairs: BTreeMap<usize, MergedPair> = BTreeMap::new();
    for (shard, directory) in shards_in(directories)? {
        let folder = &folder_of(shard, directory);
        let Some(record) = BatchRecord::read(folder)? else {
            continue;
        };
        let is_of_batch = first
            .as_ref()
            .is_none_or(|first| record.is_of_batch_of(first));
        if record.shard != shard || !is_of_batch {
            let other = shards.first();
            let other = other.map_or(folder.clone(), |one| folder_of(one.0, one.1));
            return Err(file_error::refused(
                folder,
                format!(
                    "this shard is of other pairs or options, or by another version, than that in {}",
                    other.display()
                ),
                "merge only shards of one table of pairs, docked with the same options, into the same number of shards",
            ));
        }
        let mut found = Index::of(folder, record.keep.has_poses())?.pairs;
        for (place, (name, _)) in record.own.iter().enumerate() {
            if let Some(pair) = found.remove(name) {
                let merged = MergedPair {
                    shard: shards.len(),
                    files: pair,
                };
                pairs.insert(shard.row(place), merged);
            }
        }
        if let Some(stray) = found.keys().min() {
            return Err(file_error::refused(
                &folder.join(RESULTS),
                format!("there is a row of {stray}, which is no pair of shard {shard}"),
                "remove the shard's folder, and dock it again",
            ));
        }
        shards.push((shard, directory));
        let mut of_batch = record;
        of_batch.own.clear();
        first.get_or_insert(of_batch);
    }
    let Some(record) = first else {
        return Err(no_shards(directories));
    };
    if !partial {
        let at = &directories[shards.first().map_or(0, |first| first.1)];
        complete(&record, shards.iter().map(|one| one.0.index()), &pairs, at)?;
    }
    if is_link(out) {
        return Err(file_error::link(out));
    }
    make_folder(out)?;
    let copied = |name: &str, head: &[u8], part: fn(&MergedPair) -> Option<Range>| {
        let path = out.join(name);
        let staged = StagedFile::own(&path, |file| {
            file.write_all(head)?;
            let mut open: HashMap<usize, File> = HashMap::new();
            for pair in pairs.values() {
                let Some(range) = part(pair) else { continue };
                if open.len() == OPEN && !open.contains_key(&pair.shard) {
                    open.clear();
                }
                let from = match open.entry(pair.shard) {
                    Entry::Occupied(entry) => entry.into_mut(),
                    Entry::Vacant(entry) => {
                        let (shard, directory) = shards[pair.shard];
                        let from = open_own(&folder_of(shard, directory).join(name));
                        entry.insert(from.map_err(io::Error::other)?)
                    }
                };
                copy_range(from, range, file)?;
            }
            Ok(())
        })?;
        Ok::<_, Error>((path, staged))
    };
    let left = [RESULTS, POSES].map(|name| leftovers(&out.join(name)));
    let mut written = vec![copied(RESULTS, &head(), |pair| Some(pair.files.row))?];
    if record.keep.has_poses() {
        let header = header().map_err(|error| file_error::writing(out, error))?;
        written.push(copied(POSES, &header, |pair| pair.files.poses)?);
    }
    // Neither takes its place before both may.
    let mut paths = Vec::new();
    let mut changed = Vec::new();
    for (path, staged) in written {
        if !staged.is_there()? {
            if !force && path.symlink_metadata().is_ok() {
                return Err(file_error::refused(
                    &path,
                    "another file is already there",
                    "choose another directory with -o, or pass --force to replace it",
                ));
            }
            changed.push(staged);
        }
        paths.push(path);
    }
    changed.into_iter().try_for_each(StagedFile::place)?;
    let done = pairs.values().filter(|pair| pair.files.is_done).count();
    let mut paths = paths.into_iter();
    Ok(Merged {
        leftovers: left.concat(),
        counts: [record.pairs, done, pairs.len() - done],
        results: paths.next().unwrap_or_default(),
        poses: paths.next(),
        shards: shards.into_iter().map(|(shard, _)| shard).collect(),
    })
}

/// The shards in some directories, each with the number of its directory.
fn shards_in(directories: &[PathBuf]) -> Result<BTreeMap<Shard, usize>, Error> {
    let mut shards: BTreeMap<Shard, usize> = BTreeMap::new();
    for (number, directory) in directories.iter().enumerate() {
        let place = directory.join(SHARDS);
        if is_link(&place) {
            return Err(file_error::link(&place));
        }
        let entries = match fs::read_dir(&place) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            Err(error) => return Err(file_error::reading(&place, error)),
        };
        for entry in entries {
            let entry = entry.map_err(|source| file_error::reading(&place, source))?;
            let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
            let name = entry.file_name();
            let shard = name
                .to_str()
                .and_then(|name| name.replace("-of-", "/").parse().ok());
            let Some(shard) = shard.filter(|shard: &Shard| is_folder && name == *shard.folder())
            else {
                continue;
            };
            if let Some(twice) = shards.insert(shard, number) {
                let twice = directories[twice].display();
                return Err(file_error::refused(
                    &entry.path(),
                    format!("shard {shard} is in {twice}, too"),
                    "name each directory once",
                ));
            }
        }
    }
    Ok(shards)
}

fn no_shards(directories: &[PathBuf]) -> Error {
    file_error::refused(
        directories.first().map_or(Path::new(""), PathBuf::as_path),
        "there are no shards of a batch",
        "name the directory that `knotdock batch --shard` wrote to with -o; a batch without --shard needs no merge",
    )
}

/// Refuses a batch of which shards or pairs are missing.
fn complete(
    record: &BatchRecord,
    there: impl Iterator<Item = usize>,
    pairs: &BTreeMap<usize, MergedPair>,
    at: &Path,
) -> Result<(), Error> {
    let count = record.shard.count();
    let refused = |message: String, remedy: &str| Err(file_error::refused(at, message, remedy));
    if let Some(missing) = gaps(there, count) {
        return refused(
            format!("shards {missing} of {count} are missing"),
            "dock them with `knotdock batch --shard`, or pass --partial",
        );
    }
    match gaps(pairs.keys().copied(), record.pairs) {
        Some(missing) => refused(
            format!("pairs {missing} of {} are not done", record.pairs),
            "run `knotdock batch --shard` of their shards again, which goes on where it was, or pass --partial",
        ),
        None => Ok(()),
    }
}

/// The numbers from 1 to `last` that are missing in a rising sequence, as text; `None` if none is missing.
fn gaps(numbers: impl Iterator<Item = usize>, last: usize) -> Option<String> {
    const SHOWN: usize = 10;
    let mut gaps = Vec::new();
    let mut next = 1;
    for number in numbers.chain([last.saturating_add(1)]) {
        match number.saturating_sub(next) {
            0 => {}
            1 => gaps.push(next.to_string()),
            _ => gaps.push(format!("{next}-{}", number - 1)),
        }
        next = number.saturating_add(1);
    }
    let more = if gaps.len() > SHOWN { ", ..." } else { "" };
    gaps.truncate(SHOWN);
    (!gaps.is_empty()).then(|| gaps.join(", ") + more)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_said_as_ranges() {
        let gaps = |there: &[usize], last| gaps(there.iter().copied(), last);
        assert_eq!(gaps(&[1, 2, 3], 3), None);
        assert_eq!(gaps(&[2, 4, 8], 9).unwrap(), "1, 3, 5-7, 9");
        assert_eq!(
            gaps(&[], usize::MAX).unwrap(),
            format!("1-{}", usize::MAX - 1)
        );
        let odd: Vec<usize> = (1..100).step_by(2).collect();
        assert!(gaps(&odd, 100).unwrap().ends_with("18, 20, ..."));
    }
}
