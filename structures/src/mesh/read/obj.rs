//! Wavefront OBJ: `v` and `f` lines; all else (normals, textures, groups, materials, lines, points) bounds no solid.

use std::borrow::Cow;

use crate::error::Error;
use crate::mesh::read::soup::{At, Soup, vertex};
use crate::mesh::read::words::{lines, real, shortened};

/// Keywords other than `v` that a line of an OBJ file may begin with.
const KEYWORDS: [&str; 14] = [
    "vn", "vt", "vp", "f", "fo", "l", "p", "g", "o", "s", "mtllib", "usemtl", "cstype", "lod",
];

/// Whether a text begins as an OBJ file does: lines of its keywords, up to a vertex.
pub fn begins(text: &str) -> bool {
    for line in lines(text, true) {
        let mut words = line.words();
        match words.next() {
            Some("v") => return words.take(3).filter_map(real).count() == 3,
            Some(word) if KEYWORDS.contains(&word) => {}
            _ => return false,
        }
    }
    false
}

/// Text with lines joined to the next that end with a backslash, but for comments; a mark in its place keeps lines
/// counted.
fn joined(text: &str) -> Cow<'_, str> {
    if !text.contains('\\') {
        return Cow::Borrowed(text);
    }
    let mut joined = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let continued = match line.contains('#') {
            true => None,
            false => line.trim_end_matches(['\r', '\n']).strip_suffix('\\'),
        };
        match continued {
            Some(started) if line.ends_with('\n') => {
                joined.push_str(started);
                joined.push_str(" \u{b}");
            }
            _ => joined.push_str(line),
        }
    }
    Cow::Owned(joined)
}

/// Reads a file.
pub fn parse(text: &str) -> Result<Soup, Error> {
    let text = joined(text);
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    let mut continued = 0;
    for mut line in lines(&text, true) {
        line.number += continued;
        continued += line.text.matches('\u{b}').count();
        let mut words = line
            .text
            .split(|c: char| c.is_ascii_whitespace() || c == '\u{b}')
            .filter(|w| !w.is_empty());
        match words.next() {
            Some("v") => {
                let position = line.point(&mut words, &mut soup.digits)?;
                soup.push_vertex(position, Some(line.number))?;
            }
            Some("f" | "fo") => {
                corners.clear();
                for word in words {
                    // v, v/vt, v//vn or v/vt/vn.
                    let number = word.split('/').next();
                    let index: i64 = line.number(number, "the number of a vertex")?;
                    let count = soup.positions.len();
                    // Counted from 1, or back from the latest vertex.
                    let place = if index > 0 {
                        index - 1
                    } else {
                        count as i64 + index
                    };
                    corners.push(vertex(line.number, index, place, count)?);
                }
                soup.push_face(&corners, At::Line(line.number));
            }
            _ => {}
        }
    }
    match lines(&text, true).next() {
        Some(line) if soup.positions.is_empty() => Err(line.fault(format!(
            "there is no vertex in the file, a line that begins with 'v'; its first line is '{}'",
            shortened(line.text)
        ))),
        _ => Ok(soup),
    }
}
