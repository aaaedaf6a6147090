//! The report of one run.

use crate::report::html::{Page, section};
use crate::report::run_parts::{ReportBodies, RunReport};
use crate::report::viewer::Viewer;
use crate::report::{run_cost, run_data, run_words};

impl RunReport<'_> {
    /// The page, whole. Without a viewer it says how to get the view.
    pub fn text(&self, viewer: Option<&Viewer>) -> String {
        let data = run_data::data(self);
        let explorer = include_str!("page/explorer.html");
        let lacking = match viewer {
            Some(_) => "",
            None => LACKING,
        };
        let mut sections = vec![
            section("summary", "Summary", &run_words::summary(self)),
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
        sections.push(section("cost", "What accuracy cost", &run_cost::cost(self)));
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

/// What stands in the place of the view, where there is none.
const LACKING: &str = "<p>This report has no three-dimensional view: the program was built without it. To add one, run \
                       <code>npm install 3dmol</code> and then <code>knotdock report DIR --viewer \
                       node_modules/3dmol</code>.</p>";
