//! What the report of a run is made from.

use knotdock_structures::molecule::Molecule;
use serde_json::Value;

use crate::report::RunContacts;
use knotdock::options::DockOptions;
use knotdock::output::files::assemblies::Surface;
use knotdock::output::tables::poses::PoseTable;

/// What a run put together.
pub enum ReportBodies<'a> {
    /// Molecules, and their contacts in the poses of the table.
    Molecules([&'a Molecule; 2], &'a RunContacts<'a>),
    /// Meshes, or balls as surfaces.
    Solids([Surface<'a>; 2]),
}

/// A finished run, as it is shown.
pub struct RunReport<'a> {
    /// Its run.json.
    pub record: &'a Value,
    /// The options in it.
    pub options: &'a DockOptions,
    /// Its poses.csv.
    pub table: &'a PoseTable,
    /// What was docked.
    pub bodies: ReportBodies<'a>,
    /// Its directory as commands would name it.
    pub directory: &'a str,
}
