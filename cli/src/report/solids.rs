//! Reports of solids: one stands and another moves through a table of poses, or two sets bound a result.

use csv::StringRecord;
use serde_json::{Value, json};

use crate::report::MAX_ROWS;
use crate::report::columns::of_table;
use crate::report::html::{Page, paragraph, section};
use crate::report::shown::{placement, rows, solid};
use crate::report::viewer::{Viewer, on_request};
use knotdock::output::files::assemblies::Surface;
use knotdock_scoring::se3::Pose;

pub struct SolidsReport<'a> {
    pub title: String,
    pub sentences: Vec<String>,
    pub names: [&'a str; 2],
    /// Their surfaces, each in the frame of its file.
    pub surfaces: [Surface<'a>; 2],
    pub caption: &'a str,
    pub header: StringRecord,
    pub records: Vec<StringRecord>,
    /// Columns that are shown at first.
    pub main: &'a [&'a str],
    /// Pose of the second solid in each row.
    pub poses: &'a [Pose],
}

impl SolidsReport<'_> {
    /// The page, whole. Without a viewer it says how to get the view.
    pub fn text(mut self, viewer: Option<&Viewer>) -> String {
        let all = self.records.len();
        assert_eq!(all, self.poses.len(), "one pose per row");
        if all > MAX_ROWS {
            self.sentences.push(format!(
                "This report shows the first {MAX_ROWS} of {all} rows."
            ));
            self.records.truncate(MAX_ROWS);
        }
        let columns = of_table(&self.header, &self.records, self.main);
        let rows = rows(&columns, &self.records);
        let placed = self.poses.iter().take(MAX_ROWS);
        let data = json!({
            "kind": "solids",
            "caption": self.caption,
            "sides": self.names,
            "columns": columns,
            "rows": rows,
            "placed": placed.map(|pose| [placement(pose)]).collect::<Vec<_>>(),
            "bodies": self.surfaces.iter().map(solid).collect::<Value>(),
        });
        let words = paragraph(&self.sentences);
        let explorer = include_str!("page/solids.html");
        let explorer = explorer.replace("{{lacking}}", &on_request(viewer));
        Page {
            title: self.title,
            sections: vec![
                section("summary", "Summary", &words),
                section("poses", "Results", &explorer),
            ],
            data: &data,
            viewer,
        }
        .text()
    }
}
