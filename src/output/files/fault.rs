//! Faults on purpose: a run ends, or a change of the disk fails, at a chosen change. For tests of crashes.
//!
//! Only builds with debug assertions have them. The variable `KNOTDOCK_FAULT` names the fault: `kill N` ends the
//! process at change N, counted from 1, as a kill would; `fail N` lets change N fail as a full disk would; `panic N` lets
//! the program fail there.
//! `KNOTDOCK_FAULT_LOG` names a file to which each change adds a line: its kind, a tab and its path.

use std::io;
use std::path::Path;

/// Announces a change of the disk just before it is made.
///
/// # Errors
/// The failure on purpose.
#[cfg(debug_assertions)]
pub(super) fn point(kind: &str, path: &Path) -> io::Result<()> {
    debug::point(kind, path)
}

/// Announces a change of the disk: without debug assertions there are no faults.
///
/// # Errors
/// None.
#[cfg(not(debug_assertions))]
#[inline]
pub(super) fn point(_: &str, _: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(debug_assertions)]
mod debug {
    use std::fs::File;
    use std::io::{self, Write};
    use std::path::Path;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{LazyLock, Mutex};

    /// What happens at the chosen change.
    enum Fault {
        Kill(usize),
        Fail(usize),
        Panic(usize),
        None,
    }

    static CHANGES: AtomicUsize = AtomicUsize::new(0);

    static FAULT: LazyLock<Fault> = LazyLock::new(|| {
        let text = std::env::var("KNOTDOCK_FAULT").unwrap_or_default();
        let number = |rest: &str| rest.trim().parse().ok();
        let kill = text.strip_prefix("kill ").and_then(number);
        let fail = text.strip_prefix("fail ").and_then(number);
        let panic = text.strip_prefix("panic ").and_then(number);
        match (kill, fail, panic) {
            (Some(change), ..) => Fault::Kill(change),
            (_, Some(change), _) => Fault::Fail(change),
            (_, _, Some(change)) => Fault::Panic(change),
            _ => Fault::None,
        }
    });

    static LOG: LazyLock<Option<Mutex<File>>> = LazyLock::new(|| {
        let path = std::env::var_os("KNOTDOCK_FAULT_LOG")?;
        let file = File::options().append(true).create(true).open(path).ok()?;
        Some(Mutex::new(file))
    });

    #[allow(
        clippy::panic,
        reason = "a panic on purpose, for tests of what becomes of it"
    )]
    pub(super) fn point(kind: &str, path: &Path) -> io::Result<()> {
        let change = 1 + CHANGES.fetch_add(1, Ordering::SeqCst);
        if let Some(log) = &*LOG
            && let Ok(mut log) = log.lock()
        {
            writeln!(log, "{kind}\t{}", path.display())?;
        }
        match *FAULT {
            // Nothing is flushed or removed on the way out, as after a kill.
            Fault::Kill(chosen) if chosen == change => std::process::exit(137),
            Fault::Panic(chosen) if chosen == change => panic!("a panic on purpose"),
            Fault::Fail(chosen) if chosen == change => Err(io::ErrorKind::StorageFull.into()),
            _ => Ok(()),
        }
    }
}
