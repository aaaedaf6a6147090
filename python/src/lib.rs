//! knotdock from Python: the module `knotdock._knotdock`, on which the package `knotdock` is built.
//!
//! Commands run by their words, as on the command line; molecules and correlations are classes of
//! their own.

mod command;
mod correlator;
mod failure;
mod molecule;
mod options;
mod run;

use pyo3::prelude::*;

#[global_allocator]
static ALLOCATOR: knotdock_cli::system_limits::ReportingAllocator =
    knotdock_cli::system_limits::ReportingAllocator;

/// The compiled part of the package.
#[pymodule]
mod _knotdock {
    #[pymodule_export]
    use super::command::{add, call, main, version, view_page};
    #[pymodule_export]
    use super::correlator::Correlator;
    #[pymodule_export]
    use super::molecule::Molecule;
    #[pymodule_export]
    use super::options::options;
    #[pymodule_export]
    use super::run::{Run, dock};
}
