//! Files of the user's that a run found in its way, and what is said of them.

use std::path::Path;

use crate::output::files::staging::{SetAside, finish_interrupted};

use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;

/// Warns of files of the user's that were in the way of a run and have another name now.
pub fn warn_set_aside(files: &[SetAside], console: Console) {
    for SetAside { from, to } in files {
        console.warn(format!(
            "{} is not as a run wrote it, so it is kept as {}",
            from.display(),
            to.display()
        ));
    }
}

/// Finishes what an interrupted run left in a directory before the directory is read.
pub fn finish_before_reading(directory: &Path, console: Console) -> Result<(), Failure> {
    warn_set_aside(&finish_interrupted(directory)?, console);
    Ok(())
}
