//! The report of one run.

use knotdock_structures::molecule::Molecule;
use serde_json::Value;

use crate::report::MAX_ROWS;
use crate::report::contacts::RunContacts;
use crate::report::html::{Page, section};
use crate::report::shown::LACKING;
use crate::report::viewer::Viewer;
use crate::report::{run_cost, run_data, run_words};
use knotdock::options::DockOptions;
use knotdock::output::files::assemblies::Surface;
use knotdock::output::tables::poses::PoseTable;

/// The bodies of a run.
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
    /// The docked bodies.
    pub bodies: ReportBodies<'a>,
    /// Its directory as commands would name it.
    pub directory: &'a str,
}

impl RunReport<'_> {
    /// The page, whole: of large molecules with fewer rows, so that it stays below 6 MB. Without a viewer it says
    /// how to get the view.
    pub fn text(&self, viewer: Option<&Viewer>) -> String {
        let mut rows = self.table.rows().len().min(MAX_ROWS);
        loop {
            let text = self.page(rows, viewer);
            if text.len() <= MAX_BYTES || rows <= MIN_ROWS {
                return text;
            }
            rows = (rows / 2).max(MIN_ROWS);
        }
    }

    /// The page with `rows` rows.
    fn page(&self, rows: usize, viewer: Option<&Viewer>) -> String {
        let data = run_data::data(self, rows);
        let explorer = include_str!("page/explorer.html");
        let lacking = match viewer {
            Some(_) => "",
            None => LACKING,
        };
        let mut sections = vec![
            section("summary", "Summary", &run_words::summary(self, rows)),
            section("poses", "Poses", &explorer.replace("{{lacking}}", lacking)),
        ];
        if matches!(self.bodies, ReportBodies::Molecules(..)) {
            let consensus = include_str!("page/consensus.html");
            sections.push(section(
                "consensus",
                "Where the best clusters gather",
                consensus,
            ));
        }
        sections.push(section(
            "cost",
            "Numerical error and cost",
            &run_cost::cost(self),
        ));
        sections.push(section(
            "options",
            "Options, and how to repeat the run",
            &run_cost::options(self),
        ));
        Page {
            title: run_words::title(self),
            sections,
            data: &data,
            viewer,
        }
        .text()
    }
}

/// Most bytes of a page, while rows can be left out.
const MAX_BYTES: usize = 5_500_000;
/// Rows that are shown of molecules of any size.
const MIN_ROWS: usize = 100;
