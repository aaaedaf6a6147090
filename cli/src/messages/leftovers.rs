//! Warnings of files that ended commands left.

use std::path::PathBuf;

use crate::messages::console::Console;

/// Warns of files and folders that an ended command left. They stay: nobody but the user knows whether it still runs.
pub fn warn_leftovers(paths: &[PathBuf], console: Console) {
    for path in paths {
        console.warn(format!(
            "{} was left by a command that was ended, or that still runs: remove it if none does",
            path.display()
        ));
    }
}
