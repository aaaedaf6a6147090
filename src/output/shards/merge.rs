//! The shards of a batch put together, in the order of the table of pairs.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::journal::{ShardPair, with_poses};
use super::members::copy_range;
use super::record::ShardRecord;
use super::results::rows;
use super::{POSES, SHARDS, Shard, ShardError, pose_rows};
use crate::bounded_read::{MAX_POSES, read_bounded_file};
use crate::output::files::whole_file::{is_blank, write_whole};
use crate::output::tables::batch_results::{RESULTS, header, is_ours};
use crate::output::tables::cells::{TableWriter, unquoted};

/// Files that are open at the same time.
const OPEN: usize = 128;

/// What was merged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Merged {
    /// The shards that were there.
    pub shards: Vec<Shard>,
    /// Pairs of the batch, those that were docked, and those that failed.
    pub counts: [usize; 3],
    /// The table of results.
    pub results: PathBuf,
    /// The file of poses, where poses are kept.
    pub poses: Option<PathBuf>,
}

/// A shard with its pairs.
struct Found {
    folder: PathBuf,
    record: ShardRecord,
    pairs: Vec<ShardPair>,
}

/// Merges the shards in some directories of a batch into `out`: `results.csv`, and `poses.csv.gz` where poses are kept.
/// The bytes do not depend on how many shards there are, on their places or their order. With `partial` pairs and
/// shards may be missing.
///
/// # Errors
/// [`ShardError`] when there is no shard, when shards are of different batches or twice there, and when one is missing
/// or not done.
pub fn merge(directories: &[PathBuf], out: &Path, partial: bool) -> Result<Merged, ShardError> {
    let mut shards: Vec<Found> = Vec::new();
    for directory in directories {
        for folder in folders(directory)? {
            if let Some(record) = ShardRecord::read(&folder)? {
                shards.push(found(folder, record)?);
            }
        }
    }
    shards.sort_by_key(|shard| shard.record.shard);
    let Some(first) = shards.first() else {
        return Err(ShardError::wrong(
            directories.first().map_or(Path::new(""), PathBuf::as_path),
            "there are no shards of a batch",
            "name the directory that `knotdock batch --shard` wrote to with -o",
        ));
    };
    let record = first.record.clone();
    check(&shards, &record, partial)?;

    // A pair that failed and was docked afterwards has two rows, of which the last one counts.
    let mut order: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
    for (number, shard) in shards.iter().enumerate() {
        for (place, pair) in shard.pairs.iter().enumerate() {
            order.insert(pair.row.row, (number, place));
        }
    }
    let pairs = || {
        order
            .values()
            .map(|&(shard, place)| (shard, &shards[shard].pairs[place]))
    };
    let done = pairs().filter(|(_, pair)| pair.row.is_done()).count();
    if order.len() < record.pairs && !partial {
        let missing = record.pairs - order.len();
        let is_short = |shard: &&Found| {
            let own = (1..=record.pairs).filter(|&row| shard.record.shard.has(row));
            own.into_iter().any(|row| !order.contains_key(&row))
        };
        let short = shards.iter().find(is_short).unwrap_or(first);
        return Err(ShardError::wrong(
            &short.folder,
            format!(
                "{missing} of {} pairs are not done, some of them of shard {}",
                record.pairs, short.record.shard
            ),
            "run its `knotdock batch --shard` again, which goes on where it was, or pass --partial",
        ));
    }
    let names = pairs().map(|(_, pair)| pair.row.name().to_lowercase());
    check_places(out, record.keep.has_poses(), Some(&names.collect()))?;
    let results = out.join(RESULTS);
    write_whole(&results, |file| {
        let mut table = TableWriter::new(file);
        table.row(header())?;
        for (_, pair) in pairs() {
            table.row(&pair.row.fields)?;
        }
        table.flush()
    })?;
    let poses = record.keep.has_poses().then(|| out.join(POSES));
    if let Some(path) = &poses {
        write_whole(path, |file| {
            file.write_all(&pose_rows::header()?)?;
            let mut open: HashMap<usize, File> = HashMap::new();
            for (number, pair) in pairs() {
                let Some(range) = pair.poses else { continue };
                if open.len() == OPEN && !open.contains_key(&number) {
                    open.clear();
                }
                let from = match open.entry(number) {
                    Entry::Occupied(entry) => entry.into_mut(),
                    Entry::Vacant(entry) => {
                        entry.insert(File::open(shards[number].folder.join(POSES))?)
                    }
                };
                copy_range(from, range, file)?;
            }
            Ok(())
        })?;
    }
    Ok(Merged {
        shards: shards.iter().map(|shard| shard.record.shard).collect(),
        counts: [record.pairs, done, order.len() - done],
        results,
        poses,
    })
}

/// Refuses a directory in which the tables would take the place of something else: of a file that is no such table, and,
/// where the `names` of the pairs are known, of a table with other pairs.
///
/// # Errors
/// [`ShardError::Wrong`] and [`ShardError::Unreadable`].
pub fn check_places(
    out: &Path,
    has_poses: bool,
    names: Option<&HashSet<String>>,
) -> Result<(), ShardError> {
    const REMEDY: &str = "choose another directory with -o, or move the file away";
    let results = out.join(RESULTS);
    if !is_ours(&results) {
        let message = "this is not a table of results of a batch";
        return Err(ShardError::wrong(&results, message, REMEDY));
    }
    if let (Some(names), true) = (names, results.exists()) {
        let table =
            read_bounded_file(&results, MAX_POSES).map_err(ShardError::reading(&results))?;
        let mut rows = csv::Reader::from_reader(table.as_slice()).into_records();
        let is_other = |row: &csv::StringRecord| {
            let name = unquoted(row.get(0).unwrap_or_default());
            !names.contains(&name.to_lowercase())
        };
        if rows.any(|row| row.is_ok_and(|row| is_other(&row))) {
            let message = "the table has results of other pairs";
            return Err(ShardError::wrong(&results, message, REMEDY));
        }
    }
    let poses = out.join(POSES);
    if has_poses && poses.exists() && !is_of_poses(&poses) {
        let message = "this is not a file of poses of a batch";
        return Err(ShardError::wrong(&poses, message, REMEDY));
    }
    Ok(())
}

/// Whether a file begins as a file of poses does, or has no content.
fn is_of_poses(path: &Path) -> bool {
    let Ok(header) = pose_rows::header() else {
        return false;
    };
    let mut start = Vec::new();
    let read =
        File::open(path).and_then(|file| file.take(header.len() as u64).read_to_end(&mut start));
    read.is_ok() && (is_blank(&start) || start == header)
}

/// The folders of a directory's shards, in the order of their names.
fn folders(directory: &Path) -> Result<Vec<PathBuf>, ShardError> {
    let place = directory.join(SHARDS);
    let entries = match fs::read_dir(&place) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(ShardError::reading(&place)(error)),
    };
    let paths = entries.map(|entry| entry.map(|entry| entry.path()));
    let paths: io::Result<Vec<PathBuf>> = paths.collect();
    let mut paths = paths.map_err(ShardError::reading(&place))?;
    // What begins with a dot is on its way there.
    let is_hidden = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default();
        name.to_string_lossy().starts_with('.')
    };
    paths.retain(|path| path.is_dir() && !is_hidden(path));
    paths.sort();
    Ok(paths)
}

fn found(folder: PathBuf, record: ShardRecord) -> Result<Found, ShardError> {
    let path = folder.join(RESULTS);
    let bytes = read_bounded_file(&path, MAX_POSES).map_err(ShardError::reading(&path))?;
    let rows = rows(&path, &bytes)?;
    let pairs = if record.keep.has_poses() {
        with_poses(&folder.join(POSES), rows)?.0
    } else {
        let none = |row| ShardPair { row, poses: None };
        rows.into_iter().map(none).collect()
    };
    if let Some(stray) = pairs
        .iter()
        .find(|pair| !record.shard.has(pair.row.row) || pair.row.row > record.pairs)
    {
        return Err(ShardError::wrong(
            &path,
            format!(
                "row {} of the table of pairs is not in shard {}",
                stray.row.row, record.shard
            ),
            "remove the shard's folder, and dock it again",
        ));
    }
    Ok(Found {
        folder,
        record,
        pairs,
    })
}

/// Refuses shards that do not make one batch.
fn check(shards: &[Found], record: &ShardRecord, partial: bool) -> Result<(), ShardError> {
    for pair in shards.windows(2) {
        let [one, other] = pair else { continue };
        if other.record.of_shard(record.shard) != *record
            || other.record.shard.count() != record.shard.count()
        {
            return Err(ShardError::wrong(
                &other.folder,
                format!(
                    "this shard is of other pairs or options, or by another version, than that in {}",
                    shards[0].folder.display()
                ),
                "merge only shards of one table of pairs, docked with the same options, into the same number of shards",
            ));
        }
        if one.record.shard == other.record.shard {
            return Err(ShardError::wrong(
                &other.folder,
                format!(
                    "shard {} is in {}, too",
                    one.record.shard,
                    one.folder.display()
                ),
                "name each directory once",
            ));
        }
    }
    let there: Vec<usize> = shards
        .iter()
        .map(|shard| shard.record.shard.index())
        .collect();
    let missing: Vec<String> = (1..=record.shard.count())
        .filter(|index| !there.contains(index))
        .map(|index| index.to_string())
        .collect();
    if !missing.is_empty() && !partial {
        let folder = shards[0].folder.parent().unwrap_or(Path::new(""));
        let first: Vec<String> = missing.iter().take(10).cloned().collect();
        let more = if missing.len() > first.len() {
            " ..."
        } else {
            ""
        };
        return Err(ShardError::wrong(
            folder,
            format!(
                "{} of {} shards are missing: {}{more}",
                missing.len(),
                record.shard.count(),
                first.join(", ")
            ),
            "dock them with `knotdock batch --shard`, or pass --partial",
        ));
    }
    Ok(())
}
