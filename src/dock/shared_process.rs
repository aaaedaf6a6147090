//! Whether several runs share the process at the same time.
//!
//! The system counts the memory and the processor time of a whole process. Where runs share one, those counts are of
//! all of them: then a run's memory is estimated from its atoms, and its processor time is that of its one thread.

use std::sync::atomic::{AtomicBool, Ordering};

static SHARED: AtomicBool = AtomicBool::new(false);

/// From now on several runs may be under way at the same time.
pub fn share_process() {
    SHARED.store(true, Ordering::Relaxed);
}

/// Whether several runs may be under way.
pub fn is_shared() -> bool {
    SHARED.load(Ordering::Relaxed)
}
