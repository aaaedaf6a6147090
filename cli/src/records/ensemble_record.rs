//! `ensemble.json`: conformations, members and results of an ensemble. `docs/reference/json_output.md` describes it.

use std::path::Path;

/// Name of the record in the directory of an ensemble.
pub const RECORD: &str = "ensemble.json";
/// Name of the folder in it that holds the members' runs.
pub use knotdock::output::files::own_files::MEMBERS;

/// Number of the layout of `ensemble.json`; it rises when an entry changes its meaning or goes.
pub const SCHEMA: u32 = 2;

/// Whether a directory holds an ensemble.
pub fn is_ensemble(directory: &Path) -> bool {
    directory.join(RECORD).is_file()
}
