//! The report of one run.

use crate::report::MAX_ROWS;
use crate::report::html::{Page, section};
use crate::report::run_data::{ReportBodies, RunReport};
use crate::report::shown::LACKING;
use crate::report::viewer::Viewer;
use crate::report::{run_cost, run_data, run_words};

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
