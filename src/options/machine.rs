//! Threads and memory, which change no result.

use clap::Args;

use super::values::{at_least_one, size};

/// Threads and memory of a run: they change no result and are recorded with the machine.
#[derive(Args, Clone, Debug, PartialEq)]
#[command(next_help_heading = "Machine")]
pub struct MachineOptions {
    /// Threads.
    #[command(flatten)]
    pub threads: Threads,
    /// Memory that the whole run may take, such as 800M or 4GiB [default: 80% of what is free].
    ///
    /// Program, reading and sampling included. M is 10^6 bytes, GiB 2^30.
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub memory: Option<u64>,
}

/// Threads of a command.
#[derive(Args, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[command(next_help_heading = "Machine")]
pub struct Threads {
    /// Threads [default: all hardware threads].
    #[arg(short = 'j', long, value_name = "COUNT", value_parser = at_least_one)]
    pub threads: Option<usize>,
}

impl Threads {
    /// How many to run.
    pub fn count(self) -> usize {
        self.threads
            .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
    }
}

impl From<usize> for Threads {
    fn from(threads: usize) -> Self {
        Self {
            threads: Some(threads),
        }
    }
}
