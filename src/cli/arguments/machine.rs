//! Options of the machine: they change no result.

use clap::Args;
use knotdock::dock::plan::DockPlan;
use knotdock::options::DockOptions;
use knotdock::output::manifest::Machine;

use super::memory;
use crate::cli::arguments::values::at_least_one;

/// Their heading in the help.
pub const MACHINE: &str = "Machine";

/// Threads of a command.
#[derive(Args, Debug)]
pub struct ThreadArguments {
    /// Threads [default: all hardware threads].
    #[arg(long, value_name = "N", value_parser = at_least_one, help_heading = MACHINE)]
    threads: Option<usize>,
}

impl ThreadArguments {
    /// How many to run.
    pub fn count(&self) -> usize {
        self.threads.unwrap_or_else(hardware_threads)
    }
}

/// Threads and memory of a search.
#[derive(Args, Debug)]
pub struct MachineArguments {
    #[command(flatten)]
    threads: ThreadArguments,
    /// Memory that a search may take, such as 800M (10^6) or 4GiB (2^30 bytes) [default: 80% of what is free].
    #[arg(long, value_name = "SIZE", value_parser = memory::parse_size, help_heading = MACHINE)]
    memory: Option<u64>,
}

impl MachineArguments {
    /// Puts them into options.
    pub fn apply(&self, options: &mut DockOptions) {
        options.threads = self.threads.count();
        options.memory = self.memory.or_else(memory::default_limit);
    }
}

/// Hardware threads that the process may use.
fn hardware_threads() -> usize {
    std::thread::available_parallelism().map_or(1, |threads| threads.get())
}

/// Where and how a plan is carried out.
pub fn machine(plan: &DockPlan) -> Machine {
    Machine {
        system: std::env::consts::OS,
        architecture: std::env::consts::ARCH,
        hardware_threads: hardware_threads(),
        threads: plan.options.threads,
        rotations_in_flight: plan.in_flight(),
        memory_limit_bytes: plan.options.memory,
        memory_estimate_bytes: plan.memory_bytes(),
        adapter: None,
        command: std::env::args_os()
            .map(|word| word.to_string_lossy().into_owned())
            .collect(),
        chosen: None,
    }
}
