//! Threads and memory, which change no result.

use super::definition::{Optional, options};
use super::values::{AT_LEAST_ONE, Size};
use crate::threads;

impl MachineOptions {
    /// Threads to run.
    pub fn thread_count(&self) -> usize {
        threads::or_all(self.threads)
    }
}

options! {
    /// Threads and memory of a run: they change no result and are recorded with the machine.
    MachineOptions as machine, "Machine", Both {
        /// Threads [default: all hardware threads].
        threads: Option<usize> = None, "COUNT", Optional(AT_LEAST_ONE);
        /// Memory that the whole run may take, such as 800M or 4GiB [default: 80% of what is free].
        ///
        /// Program, reading and sampling included. M is 10^6 bytes, GiB 2^30.
        memory: Option<u64> = None, "SIZE", Optional(Size);
    }
}
