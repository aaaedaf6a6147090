//! The `knotdock` program: reads the command line and hands over to [`knotdock::cli`].

use knotdock::system_limits::{self, ReportingAllocator};

#[global_allocator]
static ALLOCATOR: ReportingAllocator = ReportingAllocator;

fn main() -> std::process::ExitCode {
    system_limits::fail_at_file_size();
    knotdock::cli::main(std::env::args_os().collect()).into()
}
