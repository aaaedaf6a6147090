//! The `knotdock` program: reads the command line and hands over to [`cli`].

mod cli;
mod system_limits;

#[global_allocator]
static ALLOCATOR: system_limits::ReportingAllocator = system_limits::ReportingAllocator;

fn main() -> std::process::ExitCode {
    system_limits::fail_at_file_size();
    cli::main()
}
