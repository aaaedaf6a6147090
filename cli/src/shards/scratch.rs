//! A folder on a disk that is near, in which the files of a batch grow until it is done.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::record::{BatchRecord, RECORD};
use super::{ATTEMPTS, POSES};
use crate::tables::batch_results::RESULTS;
use knotdock::output::files::checksum::sha256;
use knotdock::output::files::file_error;
use knotdock::output::files::folder::{clear, make_folder, open_own};
use knotdock::output::files::whole_file::{StagedFile, is_link};
use knotdock_structures::Error;

/// The growing files, in the order in which they are copied: a row comes after the poses that it stands for.
const FILES: [&str; 3] = [POSES, RESULTS, ATTEMPTS];

/// A folder in which a batch is worked on, and its place, whose lock is held.
#[derive(Debug)]
pub struct Scratch {
    folder: PathBuf,
    place: PathBuf,
}

impl Scratch {
    /// A folder in `scratch` for the batch of a place. It begins as whichever of the two has gone further.
    pub fn open(scratch: &Path, place: &Path, record: &BatchRecord) -> Result<Self, Error> {
        make_folder(scratch)?;
        let unreadable = |source| file_error::reading(place, source);
        let place = place.canonicalize().map_err(unreadable)?;
        // Places of the same name differ in their checksums.
        let sum = sha256(place.to_string_lossy().as_bytes());
        let name = place.file_name().unwrap_or_default().to_string_lossy();
        let folder = scratch.join(format!("knotdock-{}-{name}", &sum[..12]));
        if is_link(&folder) {
            return Err(file_error::link(&folder));
        }
        make_folder(&folder)?;
        match BatchRecord::read(&folder)? {
            Some(found) if found == *record => {}
            None if BatchRecord::others_in(&folder)?.is_none() => {
                record.write(&folder)?;
            }
            _ => {
                return Err(file_error::refused(
                    &folder,
                    "the scratch folder is not empty and not this batch's",
                    "remove it, or name another --scratch",
                ));
            }
        }
        let length =
            |folder: &Path| fs::metadata(folder.join(RESULTS)).map_or(0, |found| found.len());
        if length(&place) > length(&folder) {
            copy(&place, &folder)?;
        }
        Ok(Self { folder, place })
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Copies the files to their place, each whole, and removes them here.
    pub fn copy_out(self) -> Result<(), Error> {
        copy(&self.folder, &self.place)?;
        // What stays is found by the next call, or is in nobody's way.
        clear(&self.folder, &[POSES, RESULTS, ATTEMPTS, RECORD]);
        Ok(())
    }
}

fn copy(from: &Path, to: &Path) -> Result<(), Error> {
    for name in FILES {
        if from.join(name).symlink_metadata().is_ok() {
            let mut file = open_own(&from.join(name))?;
            StagedFile::own(&to.join(name), |copy| io::copy(&mut file, copy).map(drop))?.place()?;
        }
    }
    Ok(())
}
