//! Faults on purpose: a run ends, or a change of the disk fails, at a chosen change. For tests of crashes.
//!
//! Only builds with debug assertions have them. The variable `KNOTDOCK_FAULT` names the fault. `kill N` ends the
//! process at change N, counted from 1, as a kill would. `fail N` lets change N fail as a full disk would. `panic N`
//! lets the program fail there. `KNOTDOCK_FAULT_LOG` names a file to which each change adds a line: its kind, a tab and
//! its path.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Announces a change of the disk just before it is made; fails if a test requests that.
#[allow(
    clippy::panic,
    reason = "a panic on purpose, for tests of what becomes of it"
)]
pub(super) fn point(kind: &str, path: &Path) -> io::Result<()> {
    static CHANGES: AtomicUsize = AtomicUsize::new(0);
    if !cfg!(debug_assertions) {
        return Ok(());
    }
    let change = 1 + CHANGES.fetch_add(1, Ordering::SeqCst);
    if let Some(log) = std::env::var_os("KNOTDOCK_FAULT_LOG") {
        let mut log = File::options().append(true).create(true).open(log)?;
        log.write_all(format!("{kind}\t{}\n", path.display()).as_bytes())?;
    }
    let fault = std::env::var("KNOTDOCK_FAULT").unwrap_or_default();
    match fault.split_once(' ') {
        Some((kind, number)) if number.parse() == Ok(change) => match kind {
            // Nothing is flushed or removed on the way out, as after a kill.
            "kill" => std::process::exit(137),
            "panic" => panic!("a panic on purpose"),
            _ => Err(io::ErrorKind::StorageFull.into()),
        },
        _ => Ok(()),
    }
}
