//! A report that is a table of results, each perhaps with a page of its own: of batches, ensembles and sweeps.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use csv::StringRecord;
use serde_json::json;

use crate::report::columns::of_table;
use crate::report::html::{Page, escaped, section};
use crate::report::shown::rows;

/// Most rows that a list shows.
const MAX_LISTED: usize = 10_000;

/// A table of results and what is said of it.
pub(super) struct ListReport {
    /// Title of the page.
    pub title: String,
    /// What is said before the table.
    pub sentences: Vec<String>,
    /// Caption of the table.
    pub caption: &'static str,
    /// Names of its columns.
    pub header: StringRecord,
    /// Its rows.
    pub records: Vec<StringRecord>,
    /// Columns that are shown at first.
    pub main: &'static [&'static str],
    /// The page of each row, from the directory of the report.
    pub links: Vec<Option<String>>,
    /// A picture as SVG, and what it shows.
    pub picture: Option<(Vec<u8>, &'static str)>,
}

impl ListReport {
    /// The page, whole.
    pub fn text(mut self) -> String {
        let all = self.records.len();
        if all > MAX_LISTED {
            self.sentences.push(format!(
                "The table shows the first {MAX_LISTED} of {all} rows."
            ));
            self.records.truncate(MAX_LISTED);
        }
        let columns = of_table(&self.header, &self.records, self.main);
        let rows = rows(&columns, &self.records);
        let data = json!({
            "kind": "list",
            "caption": self.caption,
            "columns": columns,
            "rows": rows,
            "links": self.links,
        });
        let sentences = self
            .sentences
            .iter()
            .map(|sentence| escaped(sentence) + " ");
        let words = format!("<p>{}</p>\n", sentences.collect::<String>().trim_end());
        let mut sections = vec![section("summary", "Summary", &words)];
        if let Some((svg, what)) = &self.picture {
            // As an image: whatever stands in the file, none of it runs.
            let image = format!(
                "<img class=\"picture\" alt=\"{}\" src=\"data:image/svg+xml;base64,{}\">\n",
                escaped(what),
                STANDARD.encode(svg)
            );
            sections.push(section("picture", what, &image));
        }
        sections.push(section(
            "results",
            "Results",
            include_str!("page/list.html"),
        ));
        Page {
            title: self.title,
            sections,
            data: &data,
            viewer: None,
        }
        .text()
    }
}
