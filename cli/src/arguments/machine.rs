//! The machine that a run is carried out on.

use clap::Args;
use knotdock::options::MachineOptions;
use knotdock::options::values::{AT_LEAST_ONE, in_range};
use knotdock::threads;

use super::memory;

/// Threads of a command.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Machine")]
pub struct Threads {
    /// Threads [default: all hardware threads].
    #[arg(short = 'j', long, value_name = "COUNT", value_parser = in_range::<usize>(AT_LEAST_ONE))]
    pub threads: Option<usize>,
}

impl Threads {
    /// Threads to run.
    pub fn count(self) -> usize {
        threads::or_all(self.threads)
    }
}

/// The options of the machine with all that they leave open.
pub fn settled(options: &MachineOptions) -> MachineOptions {
    MachineOptions {
        threads: Some(options.thread_count()),
        memory: options.memory.or_else(memory::default_limit),
    }
}
