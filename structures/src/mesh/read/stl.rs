//! STL, text and binary. Normals are not used.
//!
//! - Text: `solid`, facets with their vertices, `endsolid`. Lines may be wrapped, or be one. A file may hold several
//!   solids; all are read.
//! - Binary: an 80-byte header, a little-endian count and 50 bytes a triangle. The count may be wrong: programs that
//!   write to a pipe leave it at zero or at a number that no file reaches. The records that are there are read then,
//!   with a note.

use crate::error::Error;
use crate::mesh::read::encoding::text_of;
use crate::mesh::read::soup::{At, LeftOut, Soup, broken, is_finite};
use crate::mesh::read::words::{Line, lines, shortened};

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Soup, Error> {
    // Many binary files begin with `solid` as text ones do, so the length decides.
    if !has_records(bytes)
        && let Some(text) = text_of(bytes)
    {
        return parse_text(&text);
    }
    parse_binary(bytes)
}

const HEADER: usize = 84;
const RECORD: usize = 50;

/// How far records that the header does not count may lie from those that it counts, in sizes of these.
const FARTHEST: f64 = 1e3;

fn counted(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEADER)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(count)).ok()
}

/// Whether the length is that of a binary file with this header.
pub fn has_records(bytes: &[u8]) -> bool {
    counted(bytes).is_some_and(|count| count > 0 && bytes.len() == HEADER + RECORD * count)
}

fn parse_binary(bytes: &[u8]) -> Result<Soup, Error> {
    let Some(count) = counted(bytes) else {
        let what = "this is neither a text STL (it does not begin with 'solid') nor a binary one (it is shorter than the \
                    header of 84 bytes)";
        return Err(broken(None, what));
    };
    let records = bytes.get(HEADER..).unwrap_or_default();
    let (there, left) = (records.len() / RECORD, records.len() % RECORD);
    // A file that ends inside a record was cut short, or is of another kind.
    if there < count && (left > 0 || there == 0) {
        let what = format!(
            "as a binary STL its header promises {count} triangles, but the file ends after {there}"
        );
        return Err(broken(None, what));
    }
    let mut soup = Soup::default();
    for (record, number) in records.chunks_exact(RECORD).take(count).zip(1..) {
        push(&mut soup, corners(record), number)?;
    }
    if there < count {
        soup.notes.say(format!(
            "the header promises {count} triangles, but the file holds {there}; these were read"
        ));
        return Ok(soup);
    }
    // What is there beyond the count: records, another file, or nothing of use.
    let rest = records.get(count * RECORD..).unwrap_or_default();
    if rest.len() < RECORD {
        return Ok(soup);
    }
    let (what, rest) = match counted(rest) {
        Some(_) if count > 0 && has_records(rest) => (
            "another file follows",
            rest.get(HEADER..).unwrap_or_default(),
        ),
        _ => ("more records follow", rest),
    };
    let more: Vec<Corners> = rest
        .chunks_exact(RECORD)
        .map(corners)
        .take_while(|corners| is_near(&soup, corners))
        .collect();
    // Zeros at the end fill up a block.
    let filled = more.iter().rposition(|corners| *corners != [[0.0; 3]; 3]);
    let more = more
        .get(..filled.map_or(0, |last| last + 1))
        .unwrap_or_default();
    for (&corners, number) in more.iter().zip(count + 1..) {
        push(&mut soup, corners, number)?;
    }
    let read = count + more.len();
    soup.notes.say(if more.is_empty() {
        format!(
            "the header promises {count} triangles, and {} bytes that are none follow them; these were not read",
            rest.len()
        )
    } else {
        format!("the header promises {count} triangles, but {what}; {read} were read")
    });
    Ok(soup)
}

type Corners = [[f64; 3]; 3];

/// The corners of a record; its first twelve bytes are the normal.
fn corners(record: &[u8]) -> Corners {
    let mut corners = [[0.0; 3]; 3];
    let values = corners.iter_mut().flatten();
    let numbers = record.get(12..48).unwrap_or_default().chunks_exact(4);
    for (value, bytes) in values.zip(numbers) {
        *value = f64::from(f32::from_le_bytes(bytes.try_into().unwrap_or_default()));
    }
    corners
}

fn push(soup: &mut Soup, corners: Corners, number: usize) -> Result<(), Error> {
    if !corners.into_iter().all(is_finite) {
        soup.notes
            .left_out(LeftOut::FacetWithoutPlace, At::Record(number));
        return Ok(());
    }
    let mut face = [0; 3];
    for (name, corner) in face.iter_mut().zip(corners) {
        *name = soup.push_vertex(corner, None)?;
    }
    soup.push_face(&face, At::Record(number));
    Ok(())
}

/// Whether a record that the header does not count may be a triangle of the mesh: bytes that are none give numbers of
/// any size.
fn is_near(soup: &Soup, corners: &Corners) -> bool {
    let largest = |points: &[[f64; 3]]| {
        let values = points.iter().flatten();
        values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
    };
    // Numbers that are none are left out later.
    soup.positions.is_empty() || largest(corners) <= FARTHEST * largest(&soup.positions)
}

/// Words that begin something inside a facet.
const WORDS: [&str; 7] = [
    "outer", "vertex", "endloop", "endfacet", "facet", "endsolid", "solid",
];

/// Lines without comments; some programs put some before the first solid.
fn plain_lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let marks = ["#", "//", ";"];
    let is_comment = move |line: &Line<'_>| marks.iter().any(|mark| line.text.starts_with(mark));
    lines(text, false).filter(move |line| !is_comment(line))
}

/// Lines in which the first solid or facet must begin.
const MAX_LINES_BEFORE: usize = 100;

/// Whether a line begins a solid, with any name, or a facet.
fn is_first(line: &Line<'_>) -> bool {
    let mut words = line.words().map(str::to_ascii_lowercase);
    match words.next().as_deref() {
        Some("solid") => true,
        Some("facet") => words.next().as_deref() == Some("normal"),
        _ => false,
    }
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

    /// Leaves out a name, any words up to the beginning of a facet or the end of the line.
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

fn parse_text(text: &str) -> Result<Soup, Error> {
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
fn not_stl(text: &str) -> Error {
    match lines(text, false).next() {
        Some(line) => line.fault(format!(
            "this is text, but no STL: it begins with '{}' in place of 'solid'",
            shortened(line.text)
        )),
        None => broken(None, "the file is empty"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

    /// Found by an audit: such files were taken for binary ones with 824,203,333 triangles.
    #[test]
    fn text_may_begin_with_a_mark_blank_lines_and_capitals() {
        for head in ["solid plate", "\u{feff}solid", "SOLID", "\n\n\nSolid"] {
            let soup = parse(format!("{head}\n{FACET}endsolid\n").as_bytes()).unwrap();
            assert_eq!(soup.faces.triangle_count(), 1, "{head:?}");
        }
    }

    #[test]
    fn lines_end_in_lf_crlf_or_cr() {
        let text = format!("solid\n{FACET}{FACET}endsolid\n");
        for end in ["\n", "\r\n", "\r"] {
            let soup = parse(text.replace('\n', end).as_bytes()).unwrap();
            assert_eq!(soup.faces.triangle_count(), 2, "{end:?}");
        }
    }

    #[test]
    fn lines_are_those_of_the_file() {
        let broken = format!(
            "\n\n\nsolid\n{}",
            FACET.replace("vertex 0 0 0", "vertex a b c")
        );
        match parse(broken.as_bytes()) {
            Err(error) => assert_eq!(error.line(), Some(7)),
            Ok(_) => panic!("a vertex of letters is no vertex"),
        }
    }
}
