//! OFF of Geomview: an optional keyword, three counts, vertices, faces; `COFF`, `NOFF` and `STOFF` carry more a vertex,
//! which is skipped. `4OFF`, `nOFF` and binary ones are not read.
//!
//! The keyword may be in small letters and the counts may be glued to it (`OFF8 12 0`, as in ModelNet). Lines may be
//! wrapped, or be one.

use crate::error::Error;
use crate::mesh::read::soup::{At, Soup, broken, vertex};
use crate::mesh::read::words::{Line, Records, by_line_or_stream, lines};

/// The keyword that a file begins with, and the letters before its `OFF`.
fn keyword(text: &str) -> Option<(&str, &str)> {
    let word = text.split_ascii_whitespace().next()?;
    let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let start = letters.len().checked_sub(3)?;
    let end = letters.get(start..)?;
    end.eq_ignore_ascii_case("OFF")
        .then(|| (letters, letters.get(..start).unwrap_or_default()))
}

/// Whether a text begins as an OFF file does.
pub fn begins(text: &str) -> bool {
    let first = lines(text, true).next();
    first.is_some_and(|line| keyword(line.text).is_some())
}

/// Layout of an OFF file's numbers.
#[derive(Clone, Copy)]
struct Shape {
    /// Numbers after the coordinates of each vertex, in a stream.
    more: usize,
    /// Whether the number of edges follows that of faces, in a stream.
    has_edges: bool,
}

/// Reads a file.
pub fn parse(text: &str) -> Result<Soup, Error> {
    let mut all = lines(text, true);
    let first = all
        .next()
        .ok_or_else(|| broken(None, "the file is empty"))?;
    let mut rest = Some(first);
    let mut more = vec![0];
    if let Some((word, prefix)) = keyword(first.text) {
        if first.words().nth(1) == Some("BINARY") {
            return Err(first.fault("a binary OFF file; only text is read"));
        }
        more = numbers_after(&prefix.to_ascii_uppercase()).ok_or_else(|| {
            first.fault(format!(
                "{word} files are not read; OFF, COFF, NOFF and STOFF are"
            ))
        })?;
        let text = first.text.get(word.len()..).unwrap_or_default().trim();
        rest = (!text.is_empty()).then_some(Line { text, ..first });
    }
    let lines = rest.into_iter().chain(all);
    let attempts: Vec<Shape> = [true, false]
        .into_iter()
        .flat_map(|has_edges| more.iter().map(move |&more| Shape { more, has_edges }))
        .collect();
    let by_line = Shape {
        more: 0,
        has_edges: false,
    };
    by_line_or_stream(&lines, by_line, &attempts, body)
}

/// Count of numbers after the coordinates of a vertex, by the letters before `OFF`: normals, colours with or without
/// transparency, places in a picture. `None` if the file is not read.
fn numbers_after(prefix: &str) -> Option<Vec<usize>> {
    let left = prefix.strip_prefix("ST").unwrap_or(prefix);
    let is_known = left.chars().all(|c| "CN".contains(c));
    if !is_known || left.matches('C').count() > 1 || left.matches('N').count() > 1 {
        return None;
    }
    let picture = if left.len() < prefix.len() { 2 } else { 0 };
    let normal = if left.contains('N') { 3 } else { 0 };
    let colours: &[usize] = if left.contains('C') { &[4, 3] } else { &[0] };
    let sums = colours.iter().map(|colour| picture + normal + colour);
    Some(sums.collect())
}

fn body<'a, L: Iterator<Item = Line<'a>>>(
    words: &mut Records<'a, L>,
    shape: &Shape,
) -> Result<Soup, Error> {
    words.begin(|| "the number of vertices".to_owned())?;
    let vertices: usize = number(words, "the number of vertices")?;
    let faces: usize = number(words, "the number of faces")?;
    if shape.has_edges {
        let _: usize = number(words, "the number of edges")?;
    }
    let mut soup = Soup::default();
    for index in 0..vertices {
        words.begin(|| format!("vertex {} of {vertices}", index + 1))?;
        let line = words.line;
        let position = line.point(words, &mut soup.digits)?;
        soup.push_vertex(position, Some(line.number))?;
        for _ in 0..shape.more {
            let _: f64 = number(words, "a normal or a colour")?;
        }
    }
    let mut corners = Vec::new();
    for index in 0..faces {
        words.begin(|| format!("face {} of {faces}", index + 1))?;
        let at = At::Line(words.line.number);
        let size: usize = number(words, "the number of a face's vertices")?;
        corners.clear();
        for _ in 0..size {
            let index: i64 = number(words, "the index of a vertex")?;
            corners.push(vertex(words.line.number, index, index, vertices)?);
        }
        soup.push_face(&corners, at);
    }
    Ok(soup)
}

fn number<'a, L: Iterator<Item = Line<'a>>, T: std::str::FromStr>(
    words: &mut Records<'a, L>,
    what: &str,
) -> Result<T, Error> {
    let word = words.next();
    words.line.number(word, what)
}
