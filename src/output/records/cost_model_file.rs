//! The cost model of a machine, kept in the user's cache folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::bounded_read::{MAX_OPTIONS, read_bounded_file};
use crate::output::files::whole_file::{FileError, to_json, write_whole};
use crate::tradeoff::cost_model::CostModel;

/// Number of the layout of the file; it rises when an entry or what a coefficient multiplies changes.
const SCHEMA: u32 = 1;

/// The file's content.
#[derive(Debug, Serialize, Deserialize)]
struct File {
    schema: u32,
    program: String,
    /// Threads that were busy when it was fitted.
    threads: usize,
    cost_model: CostModel,
}

/// Why a file holds no cost model.
#[derive(Debug, thiserror::Error)]
pub enum CostModelError {
    /// It cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's message.
        source: io::Error,
    },
    /// It is none that this version understands.
    #[error("{} holds no cost model that this version can use: {message}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// The fault, in words.
        message: String,
    },
}

/// Path of the cost model: knotdock/cost_model.json in `XDG_CACHE_HOME`, or else in .cache of the home folder.
/// `None` where there is neither.
pub fn default_path() -> Option<PathBuf> {
    // The standard has relative folders ignored.
    let folder = |name: &str| {
        let folder = PathBuf::from(std::env::var_os(name)?);
        folder.is_absolute().then_some(folder)
    };
    let cache = folder("XDG_CACHE_HOME").or_else(|| Some(folder("HOME")?.join(".cache")))?;
    Some(cache.join("knotdock").join("cost_model.json"))
}

/// Writes a cost model, whole or not at all, and the folder for it.
///
/// # Errors
/// [`FileError`].
pub fn write(path: &Path, model: &CostModel, threads: usize) -> Result<(), FileError> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|source| FileError::unwritable(folder, source))?;
    }
    let file = File {
        schema: SCHEMA,
        program: "knotdock".to_owned(),
        threads,
        cost_model: *model,
    };
    write_whole(path, |stream| to_json(stream, &file))
}

/// Whether a file is a cost model that knotdock wrote, of whichever version.
pub fn is_ours(path: &Path) -> bool {
    let value = read_bounded_file(path, MAX_OPTIONS).ok();
    let value = value.and_then(|text| serde_json::from_slice::<serde_json::Value>(&text).ok());
    value.is_some_and(|value| value["program"] == "knotdock" && !value["cost_model"].is_null())
}

/// Reads a cost model; `None` where there is no such file.
///
/// # Errors
/// [`CostModelError`].
pub fn read(path: &Path) -> Result<Option<CostModel>, CostModelError> {
    let text = match read_bounded_file(path, MAX_OPTIONS) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(source) => {
            return Err(CostModelError::Read {
                path: path.to_owned(),
                source,
            });
        }
    };
    let content = |message: String| CostModelError::Content {
        path: path.to_owned(),
        message,
    };
    let file: File = serde_json::from_slice(&text).map_err(|error| content(error.to_string()))?;
    if file.program != "knotdock" || file.schema != SCHEMA {
        return Err(content("it is of another version".to_owned()));
    }
    if !file.cost_model.is_sound() {
        return Err(content("a coefficient is no time".to_owned()));
    }
    Ok(Some(file.cost_model))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_survives_its_file_and_nothing_else_passes_for_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/cost_model.json");
        assert!(read(&path).unwrap().is_none());
        write(&path, &CostModel::BUILT_IN, 3).unwrap();
        assert_eq!(read(&path).unwrap(), Some(CostModel::BUILT_IN));
        let text = fs::read_to_string(&path).unwrap();
        for broken in [
            "{}".to_owned(),
            text.replace("\"schema\": 1", "\"schema\": 99"),
            text.replace("\"pair\": ", "\"pair\": -"),
            text.replace("\"pair\"", "\"pairs\""),
        ] {
            assert_ne!(broken, text);
            fs::write(&path, broken).unwrap();
            assert!(matches!(read(&path), Err(CostModelError::Content { .. })));
        }
    }
}
