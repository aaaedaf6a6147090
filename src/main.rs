//! The `knotdock` program: reads the command line and hands over to [`cli`].

// No input may end in a panic; tests may.
#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

mod cli;
mod system_limits;

#[global_allocator]
static ALLOCATOR: system_limits::ReportingAllocator = system_limits::ReportingAllocator;

fn main() -> std::process::ExitCode {
    system_limits::fail_at_file_size();
    cli::main()
}
