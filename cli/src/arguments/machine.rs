//! The machine that a run is carried out on.

use knotdock::dock::plan::DockPlan;
use knotdock::options::{MachineOptions, Threads};
use knotdock::output::records::manifest::Machine;

use super::memory;

/// The options of the machine with all that they leave open.
pub fn settled(options: &MachineOptions) -> MachineOptions {
    MachineOptions {
        threads: options.threads.count().into(),
        memory: options.memory.or_else(memory::default_limit),
    }
}

/// Where and how a plan is carried out.
pub fn machine(plan: &DockPlan) -> Machine {
    Machine {
        system: std::env::consts::OS,
        architecture: std::env::consts::ARCH,
        hardware_threads: Threads::default().count(),
        threads: plan.options.machine.threads.count(),
        rotations_in_flight: plan.in_flight(),
        memory_limit_bytes: plan.options.machine.memory,
        memory_estimate_bytes: plan.memory_bytes(),
        memory_stage: plan.largest_stage(),
        adapter: None,
        command: std::env::args_os()
            .map(|word| word.to_string_lossy().into_owned())
            .collect(),
        chosen: None,
    }
}
