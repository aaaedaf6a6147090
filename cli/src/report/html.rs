//! The page of a report: head, sections, packed data, scripts and seal.

use std::fmt::Write as _;
use std::io::{BufReader, Read as _};
use std::path::PathBuf;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::GzDecoder;
use serde_json::Value;

use crate::report::viewer::{ADDRESS, Viewer, ViewerArguments, packed};
use knotdock::output::files::seal::{BEGINNING, sealed};
use knotdock::output::records::program::VERSION_WITH_COMMIT;
use knotdock_structures::Error;

/// The scripts of a report, in the order in which each uses those before it.
const SCRIPTS: [&str; 11] = [
    include_str!("page/packed.js"),
    include_str!("page/table.js"),
    include_str!("page/charts.js"),
    include_str!("page/geometry.js"),
    include_str!("page/scene.js"),
    include_str!("page/panels.js"),
    include_str!("page/run.js"),
    include_str!("page/list.js"),
    include_str!("page/solids.js"),
    include_str!("page/models.js"),
    include_str!("page/main.js"),
];

/// Security policy of a report: it loads nothing from outside, but for the library of the view, on request, if the page
/// does not hold it.
fn policy(has_viewer: bool) -> String {
    let library = match has_viewer {
        true => String::new(),
        false => format!(" {ADDRESS}"),
    };
    format!(
        "default-src 'none'; script-src 'unsafe-inline' blob:{library}; style-src 'unsafe-inline'; img-src data: blob:; \
         worker-src blob:; base-uri 'none'; form-action 'none'"
    )
}

pub(super) struct Page<'a> {
    pub title: String,
    pub sections: Vec<String>,
    pub data: &'a Value,
    /// The library of the view, if it is shown.
    pub viewer: Option<&'a Viewer>,
}

impl Page<'_> {
    /// The page as text, sealed.
    pub fn text(&self) -> String {
        let title = escaped(&self.title);
        let mut text = format!(
            "{BEGINNING} {VERSION_WITH_COMMIT} -->\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
             <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n<style>\n{style}</style>\n</head>\n<body>\n\
             <header><h1>{title}</h1></header>\n<main>\n",
            policy = policy(self.viewer.is_some()),
            style = include_str!("page/style.css"),
        );
        for section in &self.sections {
            text += section;
        }
        let _ = write!(
            text,
            "</main>\n<footer><p>Written by knotdock {VERSION_WITH_COMMIT}.{}</p></footer>\n",
            match self.viewer {
                Some(_) =>
                    " The view is 3Dmol.js (Rego and Koes, Bioinformatics 31 (2015) 1322), under the BSD 3-clause licence.",
                None => "",
            }
        );
        text += &scripts(&self.data.to_string(), self.viewer, &SCRIPTS);
        text += "</body>\n</html>\n";
        sealed(text)
    }
}

/// The scripts of a view alone.
const VIEW_SCRIPTS: [&str; 5] = [
    include_str!("page/packed.js"),
    include_str!("page/geometry.js"),
    include_str!("page/scene.js"),
    include_str!("page/view.js"),
    "unpacked(\"data\").then((text) => showView(JSON.parse(text)));\n",
];

/// A page that holds a view and nothing else, as notebooks show it; `None` without the library of the view.
///
/// `data` is the JSON text that page/view.js reads, `package` a folder of npm's package 3dmol.
///
/// # Errors
/// [`Error`] if the folder does not hold the library.
pub fn view_page(data: &str, package: Option<PathBuf>) -> Result<Option<String>, Error> {
    let Some(viewer) = (ViewerArguments { viewer: package }).read()? else {
        return Ok(None);
    };
    Ok(Some(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<title>knotdock</title>\n\
         <style>html, body, #scene {{ margin: 0; height: 100%; overflow: hidden; }} #scene img {{ display: none; }} \
         #scene {{ position: relative; }}</style>\n</head>\n<body>\n\
         <div id=\"scene\" role=\"img\" tabindex=\"0\" \
         aria-label=\"The structure, turned with the mouse or the arrow keys\"></div>\n\
         {scripts}</body>\n</html>\n",
        policy = policy(true),
        scripts = scripts(data, Some(&viewer), &VIEW_SCRIPTS),
    )))
}

/// The data, the library with its licence, and scripts.
fn scripts(data: &str, viewer: Option<&Viewer>, scripts: &[&str]) -> String {
    let mut text = script("data", &packed(data.as_bytes()));
    if let Some(viewer) = viewer {
        let licence = viewer.licence.replace("--", "- -");
        let _ = write!(text, "<!--\n{licence}\n-->\n");
        text += &script("viewer", &viewer.packed);
    }
    let code = scripts.concat();
    text + "<script>\n\"use strict\";\n(() => {\n" + &code + "})();\n</script>\n"
}

fn script(id: &str, packed: &str) -> String {
    format!("<script type=\"text/plain\" id=\"{id}\">{packed}</script>\n")
}

/// Most bytes of unpacked data.
const MAX_DATA: u64 = 256 << 20;

/// The data of the scripts in the text of a page; `None` of anything else.
pub(super) fn data_of(page: &[u8]) -> Option<Value> {
    let (_, rest) = std::str::from_utf8(page).ok()?.split_once("id=\"data\">")?;
    let packed = STANDARD.decode(rest.split_once('<')?.0).ok()?;
    let data = GzDecoder::new(packed.as_slice()).take(MAX_DATA);
    serde_json::from_reader(BufReader::new(data)).ok()
}

/// Text as HTML, also in attributes.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            c => escaped.push(c),
        }
    }
    escaped
}

pub(super) fn section(id: &str, heading: &str, inner: &str) -> String {
    format!(
        "<section id=\"{id}\" aria-labelledby=\"{id}-heading\">\n<h2 id=\"{id}-heading\">{}</h2>\n{inner}</section>\n",
        escaped(heading)
    )
}

pub(super) fn paragraph(sentences: &[String]) -> String {
    format!("<p>{}</p>\n", escaped(&sentences.join(" ")))
}

/// A table of text: a `header` of names with `|` between them, and rows of fields.
pub(super) fn table(
    caption: &str,
    header: &str,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let head = header.split('|');
    let head = head.map(|name| format!("<th scope=\"col\">{}</th>", escaped(name)));
    let mut text = format!(
        "<div class=\"scroll\"><table>\n<caption>{}</caption>\n<tr>{}</tr>\n",
        escaped(caption),
        head.collect::<String>()
    );
    for row in rows {
        let cells = row.iter().map(|cell| format!("<td>{}</td>", escaped(cell)));
        let _ = writeln!(text, "<tr>{}</tr>", cells.collect::<String>());
    }
    text + "</table></div>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_no_markup() {
        assert_eq!(
            escaped("<img src=x onerror='a'> & \"b\""),
            "&lt;img src=x onerror=&#39;a&#39;&gt; &amp; &quot;b&quot;"
        );
        let text = table("<i>", "<b>", [vec!["</td>".to_owned()]]);
        assert!(!text.contains("<b>") && !text.contains("<i>"));
    }
}
