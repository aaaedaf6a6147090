//! Text STL: `solid`, facets with their vertices, `endsolid`. Lines may be wrapped, or be one.

use crate::mesh::error::MeshErrorKind;
use crate::mesh::read::soup::{At, LeftOut, Soup, is_finite};
use crate::mesh::read::words::{Line, lines, shortened};

/// Words that begin something inside a facet.
const WORDS: [&str; 7] = [
    "outer", "vertex", "endloop", "endfacet", "facet", "endsolid", "solid",
];

/// Lines without comments; some programs put some before the first solid.
fn plain_lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    lines(text, false).filter(|line| {
        !["#", "//", ";"]
            .iter()
            .any(|mark| line.text.starts_with(mark))
    })
}

/// Lines in which the first solid or facet must begin.
const MAX_LINES_BEFORE: usize = 100;

/// Whether a line begins a solid, with any name, or a facet.
fn is_first(line: &Line<'_>) -> bool {
    let mut words = line.words();
    let mut is = |name: &str| {
        let word = words.next();
        word.is_some_and(|word| word.eq_ignore_ascii_case(name))
    };
    let word = line.words().next().unwrap_or_default();
    if word.eq_ignore_ascii_case("solid") {
        return true;
    }
    is("facet") && is("normal")
}

/// Whether a text begins as an STL file does, with or without its first line.
pub fn begins(text: &str) -> bool {
    plain_lines(text).next().is_some_and(|line| is_first(&line))
}

/// Words of a line, of which some can be looked at ahead.
struct Words<'a> {
    line: Line<'a>,
    rest: std::iter::Peekable<std::str::SplitAsciiWhitespace<'a>>,
}

impl<'a> Words<'a> {
    fn next_is(&mut self, names: &[&str]) -> bool {
        let is = |word: &&str| names.iter().any(|name| word.eq_ignore_ascii_case(name));
        self.rest.peek().is_some_and(is)
    }

    /// Leaves out words up to one of those named, or the end of the line.
    fn skip_to(&mut self, names: &[&str]) {
        while self.rest.peek().is_some() && !self.next_is(names) {
            self.rest.next();
        }
    }

    /// Leaves out a name, which may be anything: up to what begins a facet, or the end of the line.
    fn skip_name(&mut self, names: &[&str]) {
        loop {
            self.skip_to(names);
            let is_facet = self.next_is(&["facet"]);
            let mut ahead = self.rest.clone().skip(1);
            let has_normal = |word: &str| word.eq_ignore_ascii_case("normal");
            if self.rest.peek().is_none() || !is_facet || ahead.next().is_some_and(has_normal) {
                return;
            }
            self.rest.next();
        }
    }
}

/// Reads a text.
pub fn parse(text: &str) -> Result<Soup, MeshErrorKind> {
    let mut before = plain_lines(text).take(MAX_LINES_BEFORE);
    let Some(before) = before.position(|line| is_first(&line)) else {
        return Err(not_stl(text));
    };
    let mut soup = Soup::default();
    if before > 0 {
        soup.notes.say(format!(
            "{before} lines before the first solid were not read"
        ));
    }
    // Corners of the facet with their lines, and where it begins.
    let mut corners: Vec<([f64; 3], usize)> = Vec::new();
    let mut vertices = Vec::new();
    let mut facet: Option<Line<'_>> = None;
    for line in plain_lines(text).skip(before) {
        let mut words = Words {
            line,
            rest: line.words().peekable(),
        };
        while let Some(word) = words.rest.next() {
            let keyword = word.to_ascii_lowercase();
            match (keyword.as_str(), facet) {
                ("solid", None) => words.skip_name(&["facet"]),
                ("endsolid", None) => words.skip_name(&["facet", "solid"]),
                ("facet", None) => {
                    facet = Some(line);
                    corners.clear();
                    words.skip_to(&["outer", "vertex", "endloop", "endfacet"]);
                }
                ("outer" | "endloop", Some(_)) => words.skip_to(&WORDS),
                ("vertex", Some(_)) => {
                    let position = line.point(&mut words.rest, &mut soup.digits)?;
                    corners.push((position, line.number));
                    words.skip_to(&WORDS);
                }
                ("endfacet", Some(started)) => {
                    match corners.iter().find(|(corner, _)| !is_finite(*corner)) {
                        Some(&(_, number)) => {
                            let at = At::Line(number);
                            soup.notes.left_out(LeftOut::FacetWithoutPlace, at);
                        }
                        None => {
                            vertices.clear();
                            for &(corner, number) in &corners {
                                vertices.push(soup.push_vertex(corner, Some(number))?);
                            }
                            soup.push_face(&vertices, At::Line(started.number));
                        }
                    }
                    facet = None;
                    words.skip_to(&WORDS);
                }
                _ => {
                    return Err(words.line.fault(format!(
                        "'{}' is not expected {} a facet",
                        shortened(word),
                        if facet.is_some() { "inside" } else { "outside" }
                    )));
                }
            }
        }
    }
    match facet {
        Some(line) => Err(line.fault("the file ends inside the facet that begins here")),
        None => Ok(soup),
    }
}

/// Kind of a text that is no STL, by its first line.
fn not_stl(text: &str) -> MeshErrorKind {
    match lines(text, false).next() {
        Some(line) => line.fault(format!(
            "this is text, but no STL: it begins with '{}' in place of 'solid'",
            shortened(line.text)
        )),
        None => MeshErrorKind::Syntax {
            line: None,
            what: "the file is empty".to_owned(),
        },
    }
}
