//! Memory that this process holds and has held, as the system reports it.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::dock::shared_process::is_shared;

/// The most memory that the process had held when the present run began, in bytes.
static PEAK_BEFORE: AtomicU64 = AtomicU64::new(0);

/// Begins a run: what the process held at most before is not the run's.
pub fn begin() {
    PEAK_BEFORE.store(peak().unwrap_or(0), Ordering::Relaxed);
}

/// The most memory that the process has held so far, in bytes, by all its runs. `None` off Linux.
pub fn peak() -> Option<u64> {
    status("VmHWM:")
}

/// Memory that the process holds now, in bytes: program, inputs and all that was made of them. `None` off Linux, and
/// where other runs share the process, whose memory is not this one's.
pub fn held() -> Option<u64> {
    status("VmRSS:").filter(|_| !is_shared())
}

/// The most memory that the present run has held so far, in bytes: at least the memory that it holds now. `None` as of
/// [`held`].
pub fn peak_of_run() -> Option<u64> {
    let peak = peak().filter(|_| !is_shared())?;
    if peak > PEAK_BEFORE.load(Ordering::Relaxed) {
        Some(peak)
    } else {
        held()
    }
}

/// A size in /proc/self/status, in bytes.
fn status(key: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    kib.checked_mul(1024)
}
