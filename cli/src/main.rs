//! The `knotdock` program: reads the command line and hands over to [`knotdock_cli`].

use knotdock_cli::system_limits::{self, ReportingAllocator};

#[global_allocator]
static ALLOCATOR: ReportingAllocator = ReportingAllocator;

fn main() -> std::process::ExitCode {
    system_limits::fail_at_file_size();
    knotdock_cli::main(std::env::args_os().collect()).into()
}
