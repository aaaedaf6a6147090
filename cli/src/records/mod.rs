//! Records in JSON that the program writes or reads again.

pub mod recorded_run;
pub(crate) mod tradeoff;

use std::path::Path;

use serde_json::Value;

pub(crate) use knotdock::output::files::own_files::MEMBERS;

/// Name of the record in the directory of an ensemble. `docs/reference/json_output.md` describes it.
pub(crate) const ENSEMBLE_RECORD: &str = "ensemble.json";

/// Number of the layout of `ensemble.json`; it rises when an entry changes its meaning or goes.
pub(crate) const ENSEMBLE_SCHEMA: u32 = 2;

pub(crate) fn is_ensemble(directory: &Path) -> bool {
    directory.join(ENSEMBLE_RECORD).is_file()
}

/// The entries of several JSON objects as one object.
pub(crate) fn joined(parts: impl IntoIterator<Item = Value>) -> Value {
    let objects = parts.into_iter().filter_map(|part| match part {
        Value::Object(entries) => Some(entries),
        _ => None,
    });
    Value::Object(objects.flatten().collect())
}
