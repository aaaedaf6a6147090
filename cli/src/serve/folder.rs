//! The folder that is served. Each run is a folder in it, as `knotdock dock -o` writes it. `serve/inputs` has a folder for
//! each upload, `serve/jobs` a file for each run that the page requested.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use axum::body::BodyDataStream;
use axum::http::StatusCode;
use futures_util::StreamExt;
use knotdock_structures::Error;
use tempfile::NamedTempFile;

use super::api::Refusal;
use knotdock::output::files::file_error::unwritable;
use knotdock::output::files::lock::Lock;

/// Folder of what belongs to no run.
const OWN: &str = "serve";
/// Uploads, as the commands of runs name them.
pub const INPUTS: &str = "serve/inputs";
const JOBS: &str = "serve/jobs";

/// Most bytes of the files of an upload together, and most files.
const MAX_BYTES: u64 = 200 << 20;
const MAX_FILES: usize = 100;

/// Endings of the files that are read, each perhaps followed by `.gz`.
const ENDINGS: [&str; 11] = [
    "pdb", "ent", "cif", "mmcif", "stl", "obj", "ply", "off", "csv", "sph", "yml",
];
const MAX_NAME: usize = 100;

pub struct Folder {
    root: PathBuf,
    /// Files and bytes of the uploads of this process.
    uploads: Mutex<HashMap<String, (usize, u64)>>,
    _lock: Lock,
}

impl Folder {
    /// Opens a folder, which only one server may use at a time.
    pub fn open(root: &Path) -> Result<Self, Error> {
        for folder in [INPUTS, JOBS] {
            let folder = root.join(folder);
            fs::create_dir_all(&folder).map_err(|error| unwritable(&folder, error))?;
        }
        let failed = |error| unwritable(root, error);
        let root = root.canonicalize().map_err(failed)?;
        let lock = Lock::take(&root.join(OWN).join("lock")).map_err(|error| {
            error
                .help("another `knotdock serve` uses this folder: end it, or give another --folder")
        })?;
        Ok(Self {
            root,
            uploads: Mutex::default(),
            _lock: lock,
        })
    }

    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The file of a job.
    pub fn job_file(&self, run: &str) -> PathBuf {
        self.root.join(JOBS).join(format!("{run}.json"))
    }

    /// Names of the runs that the page requested.
    pub fn job_names(&self) -> Result<Vec<String>, Error> {
        let mut names = names_in(&self.root.join(JOBS))?;
        names.retain_mut(|name| match name.strip_suffix(".json") {
            Some(stem) => {
                *name = stem.to_owned();
                true
            }
            None => false,
        });
        Ok(names)
    }

    /// Names of the folders beside the server's own.
    pub fn folder_names(&self) -> Result<Vec<String>, Error> {
        let mut names = names_in(&self.root)?;
        names.retain(|name| self.run(name).is_some());
        Ok(names)
    }

    /// The folder of a run by its name, if there is one.
    pub fn run(&self, name: &str) -> Option<PathBuf> {
        let folder = self.root.join(name);
        (is_name(name) && name != OWN && folder.is_dir()).then_some(folder)
    }

    /// A file of a run, which links cannot lead out of it.
    pub fn run_file(&self, run: &str, path: &str) -> Option<PathBuf> {
        let folder = self.run(run)?.canonicalize().ok()?;
        let path = folder.join(path).canonicalize().ok()?;
        (folder.starts_with(&self.root) && path.starts_with(&folder) && path.is_file())
            .then_some(path)
    }

    /// A file of an upload.
    pub fn input(&self, upload: &str, name: &str) -> Option<PathBuf> {
        let folder = self.root.join(INPUTS);
        let path = folder.join(upload).join(name);
        let is_here = is_name(upload) && is_name(name) && !path.is_symlink() && path.is_file();
        is_here.then_some(path)
    }

    /// Makes the folder of a new upload; its name.
    pub fn new_upload(&self) -> Result<String, Error> {
        let folder = self.root.join(INPUTS);
        let mut number = names_in(&folder)?.len();
        loop {
            number += 1;
            let name = format!("{number:04}");
            match fs::create_dir(folder.join(&name)) {
                Ok(()) => return Ok(name),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(unwritable(&folder, error)),
            }
        }
    }

    /// Receives a file of an upload; the name under which it is kept.
    pub async fn receive(
        &self,
        upload: &str,
        name: &str,
        mut body: BodyDataStream,
    ) -> Result<String, Refusal> {
        let folder = self.root.join(INPUTS).join(upload);
        if !is_name(upload) || !folder.is_dir() {
            return Err(Refusal::new(
                StatusCode::NOT_FOUND,
                "there is no such upload",
            ));
        }
        let name = kept_name(name)?;
        self.count(upload, 1, 0)?;
        // What is not complete goes when it is dropped. The writes wait for the page cache alone.
        let mut file =
            NamedTempFile::new_in(&folder).map_err(|error| unwritable(&folder, error))?;
        while let Some(part) = body.next().await {
            let part =
                part.map_err(|_| Refusal::new(StatusCode::BAD_REQUEST, "the upload ended early"))?;
            self.count(upload, 0, part.len() as u64)?;
            file.write_all(&part)
                .map_err(|error| unwritable(&folder, error))?;
        }
        if folder.join(&name).exists() {
            let message =
                format!("{name} is there already: name the files of an upload differently");
            return Err(Refusal::new(StatusCode::CONFLICT, message));
        }
        let path = folder.join(&name);
        let kept = file.persist_noclobber(&path);
        kept.map_err(|error| unwritable(&path, error.error))?;
        Ok(name)
    }

    /// Counts files and bytes of an upload, and refuses those above the limits.
    fn count(&self, upload: &str, files: usize, bytes: u64) -> Result<(), Refusal> {
        let mut uploads = self.uploads.lock().unwrap_or_else(PoisonError::into_inner);
        let used = uploads.entry(upload.to_owned()).or_default();
        *used = (used.0 + files, used.1 + bytes);
        match used.0 > MAX_FILES || used.1 > MAX_BYTES {
            true => Err(Refusal::new(
                StatusCode::PAYLOAD_TOO_LARGE,
                "an upload has at most 100 files and 200 MB; dock larger ones from the command line",
            )),
            false => Ok(()),
        }
    }
}

/// Names in a folder that are text, in order.
fn names_in(folder: &Path) -> Result<Vec<String>, Error> {
    let failed = |error| Error::machine(format!("cannot list the folder: {error}")).at(folder);
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        names.extend(entry.map_err(failed)?.file_name().into_string());
    }
    names.sort();
    Ok(names)
}

/// Whether a text is the name of one visible file or folder, and no path.
pub fn is_name(text: &str) -> bool {
    let mut parts = Path::new(text).components();
    let is_one = matches!((parts.next(), parts.next()), (Some(Component::Normal(part)), None) if part == text);
    is_one && !text.starts_with('.') && !text.contains(['/', '\\', ':', '\0'])
}

/// The name under which an uploaded file is kept: letters, digits and `._-` of its own.
fn kept_name(name: &str) -> Result<String, Refusal> {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() || "._-".contains(c) {
            c
        } else {
            '_'
        }
    };
    let kept: String = name.chars().map(plain).collect();
    let kept = kept.trim_start_matches(['.', '-', '_']);
    let lower = kept.to_ascii_lowercase();
    let stem = lower.strip_suffix(".gz").unwrap_or(&lower);
    let ending = stem.rsplit_once('.').map(|(_, ending)| ending);
    if !ending.is_some_and(|ending| ENDINGS.contains(&ending)) || kept.len() > MAX_NAME {
        let message = format!(
            "files end in {} (also .gz) and have names of at most {MAX_NAME} characters",
            ENDINGS.map(|ending| format!(".{ending}")).join(", ")
        );
        return Err(Refusal::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, message));
    }
    Ok(kept.to_owned())
}

/// Reads a small file of the server.
pub fn read_small(path: &Path) -> Option<Vec<u8>> {
    const MAX: u64 = 16 << 20;
    let file = File::open(path).ok()?;
    (file.metadata().ok()?.len() <= MAX).then(|| fs::read(path).ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_no_paths() {
        for name in [
            "", ".", "..", "../a", "a/b", "/a", "a\\b", ".a", "a/", "C:a", "a\0",
        ] {
            assert!(!is_name(name), "{name:?}");
        }
        assert!(is_name("1ppe E (2)") && is_name("a..b"));
    }

    #[test]
    fn uploads_keep_plain_names() {
        let kept = |name: &str| kept_name(name).ok();
        assert_eq!(kept("../../etc/a b.pdb").as_deref(), Some("etc_a_b.pdb"));
        assert_eq!(kept("--output.PDB.gz").as_deref(), Some("output.PDB.gz"));
        assert_eq!(kept("Ångström.cif").as_deref(), Some("ngstr_m.cif"));
        for name in [
            "",
            "pdb",
            "a.sh",
            "a.gz",
            "a.pdb/",
            &format!("{}.pdb", "a".repeat(97)),
        ] {
            assert!(kept(name).is_none(), "{name}");
        }
    }
}
