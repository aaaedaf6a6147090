//! Which files of a directory a run wrote, and which are its user's.
//!
//! A run's record lists the run's files with their checksums. A recorded file is the run's own as long as it has its
//! checksum; one that has changed is the user's, and so is all that is not recorded. A file without content, as a power
//! cut leaves it, is nobody's loss and counts as the run's own.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::bounded_read::MAX_RECORD;

use super::checksum::sha256_of_file;
use super::disk;
use super::product::{EXPORTED, Product};
use super::seal::{REPORT, is_sealed};
use super::whole_file::is_blank;

/// What a directory holds of a product.
#[derive(Debug)]
pub(super) enum Found {
    /// Nothing of its names.
    Nothing,
    /// A whole record, and these of its files.
    Run(OwnFiles),
    /// Files of a product whose record is missing or broken.
    Broken(OwnFiles),
    /// An entry of one of its names that it did not write.
    Foreign(&'static str),
}

/// The files of a product that are as it wrote them, with their checksums, by their paths from the directory.
#[derive(Debug, Default)]
pub(super) struct OwnFiles(pub BTreeMap<PathBuf, String>);

impl OwnFiles {
    /// Whether a directory holds nothing else.
    pub fn are_all_of(&self, product: &Product, directory: &Path) -> io::Result<bool> {
        let is_own = |path: &PathBuf| {
            self.0.contains_key(path) || product.folder.is_some_and(|name| path == Path::new(name))
        };
        Ok(disk::tree(directory)?.iter().all(is_own))
    }
}

/// Looks for a product in a directory, which need not be there.
///
/// # Errors
/// What the system says when a file cannot be read.
pub(super) fn survey(product: &Product, directory: &Path) -> io::Result<Found> {
    let kind = |name: &str| directory.join(name).symlink_metadata().ok();
    let mut present = product.entries().filter(|name| kind(name).is_some());
    let Some(first) = present.next() else {
        return Ok(Found::Nothing);
    };
    // A product's folder is a folder and its files are files; what is a link the user made.
    let is_file = |name: &str| kind(name).is_none_or(|found| found.is_file());
    if let Some(name) = product.folder
        && kind(name).is_some_and(|found| !found.is_dir())
    {
        return Ok(Found::Foreign(name));
    }
    let mut files = product
        .files
        .iter()
        .map(|(name, _)| *name)
        .chain([product.record]);
    if let Some(name) = files.find(|name| !is_file(name)) {
        return Ok(Found::Foreign(name));
    }
    let record = read_record(&directory.join(product.record))?;
    let recorded = match &record {
        Record::Whole(record) => recorded_files(product, directory, record)?,
        Record::None | Record::Broken => None,
        Record::Foreign => return Ok(Found::Foreign(first)),
    };
    let mut own = match recorded {
        Some(recorded) => unchanged(directory, recorded)?,
        None => {
            if let Some(name) = foreign(product, directory)? {
                return Ok(Found::Foreign(name));
            }
            alike(product, directory)?
        }
    };
    // A report is not recorded: it says for itself that it is as it was written.
    let report = directory.join(REPORT);
    if product.may_hold(Path::new(REPORT)) && is_sealed(&report) {
        own.0.insert(REPORT.into(), sha256_of_file(&report)?);
    }
    Ok(match record {
        Record::Whole(_) => Found::Run(own),
        _ => Found::Broken(own),
    })
}

/// A record as found.
enum Record {
    None,
    Whole(Value),
    /// Without content, or torn.
    Broken,
    /// Another program's, or a user's.
    Foreign,
}

fn read_record(path: &Path) -> io::Result<Record> {
    let mut bytes = Vec::new();
    match File::open(path) {
        Ok(file) => file.take(MAX_RECORD).read_to_end(&mut bytes)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Record::None),
        Err(error) => return Err(error),
    };
    let ours = |record: &Value| record["program"] == "knotdock";
    Ok(match serde_json::from_slice::<Value>(&bytes) {
        Ok(record) if ours(&record) => Record::Whole(record),
        Ok(_) => Record::Foreign,
        Err(_) if is_blank(&bytes) || names_us(&bytes) => Record::Broken,
        Err(_) => Record::Foreign,
    })
}

/// The files that a record lists, with their checksums, and those exported later; `None` where it lists none.
fn recorded_files(
    product: &Product,
    directory: &Path,
    record: &Value,
) -> io::Result<Option<BTreeMap<PathBuf, String>>> {
    let Some(files) = record["files"].as_object() else {
        return Ok(None);
    };
    let mut recorded = BTreeMap::new();
    let mut add = |path: PathBuf, checksum: &Value| {
        if let (true, Some(checksum)) = (product.may_hold(&path), checksum.as_str()) {
            recorded.insert(path, checksum.to_owned());
        }
    };
    for (name, checksum) in files {
        add(PathBuf::from(name), checksum);
    }
    let mut lists = vec![PathBuf::from(product.record)];
    if let Some(folder) = product.folder {
        let list = Path::new(folder).join(EXPORTED);
        let path = directory.join(&list);
        if path.symlink_metadata().is_ok_and(|found| found.is_file())
            && let Record::Whole(exported) = read_record(&path)?
        {
            for (name, checksum) in exported["files"].as_object().into_iter().flatten() {
                add(Path::new(folder).join(name), checksum);
            }
            lists.push(list);
        }
    }
    // A list has no checksum of itself.
    for list in lists {
        let checksum = sha256_of_file(&directory.join(&list))?;
        recorded.insert(list, checksum);
    }
    Ok(Some(recorded))
}

/// Those of the recorded files that are there and unchanged, or without content.
fn unchanged(directory: &Path, recorded: BTreeMap<PathBuf, String>) -> io::Result<OwnFiles> {
    let mut own = OwnFiles::default();
    for (path, expected) in recorded {
        let file = directory.join(&path);
        if !file.symlink_metadata().is_ok_and(|found| found.is_file()) {
            continue;
        }
        let found = sha256_of_file(&file)?;
        if found == expected || is_blank_file(&file)? {
            own.0.insert(path, found);
        }
    }
    Ok(own)
}

/// A file of a product's name that is not alike one; of a directory without a list of files.
fn foreign(product: &Product, directory: &Path) -> io::Result<Option<&'static str>> {
    for &(name, beginning) in product.files {
        let path = directory.join(name);
        if path.exists() && !is_alike(&start(&path)?, beginning) {
            return Ok(Some(name));
        }
    }
    Ok(None)
}

/// The files that are alike a product's, of a directory without a list of files.
fn alike(product: &Product, directory: &Path) -> io::Result<OwnFiles> {
    let mut paths: Vec<PathBuf> = product.files.iter().map(|(name, _)| name.into()).collect();
    paths.push(product.record.into());
    if let Some(folder) = product.folder {
        let inside = fs::read_dir(directory.join(folder)).into_iter().flatten();
        for entry in inside {
            paths.push(Path::new(folder).join(entry?.file_name()));
        }
    }
    let mut own = OwnFiles::default();
    for path in paths {
        let file = directory.join(&path);
        let is_file = file.symlink_metadata().is_ok_and(|found| found.is_file());
        let beginning = product
            .files
            .iter()
            .find(|(name, _)| path == Path::new(name))
            .map_or("", |(_, beginning)| beginning);
        if is_file && product.may_hold(&path) && is_alike(&start(&file)?, beginning) {
            let checksum = sha256_of_file(&file)?;
            own.0.insert(path, checksum);
        }
    }
    Ok(own)
}

/// Whether the start of a file shows it to be a product's: it is blank, has the beginning, or names this program.
fn is_alike(start: &[u8], beginning: &str) -> bool {
    is_blank(start)
        || (!beginning.is_empty() && start.starts_with(beginning.as_bytes()))
        || names_us(start)
}

/// Whether a file is without content to its end.
fn is_blank_file(path: &Path) -> io::Result<bool> {
    let mut file = File::open(path)?;
    let mut buffer = [0; 4096];
    loop {
        let count = file.read(&mut buffer)?;
        if count == 0 || !is_blank(&buffer[..count]) {
            return Ok(count == 0);
        }
    }
}

/// Whether text names this program.
fn names_us(bytes: &[u8]) -> bool {
    bytes.windows(8).any(|word| word == b"knotdock")
}

/// The first bytes of a file.
fn start(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(4096).read_to_end(&mut bytes)?;
    Ok(bytes)
}
