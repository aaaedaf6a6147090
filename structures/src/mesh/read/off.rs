//! OFF of Geomview: an optional keyword, three counts, vertices, faces; `COFF`, `NOFF` and `STOFF` carry more a vertex, which
//! is skipped. `4OFF`, `nOFF` and binary ones are not read.

use super::super::error::MeshErrorKind;
use super::Soup;
use super::words::{Line, lines, text_of};

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Soup, MeshErrorKind> {
    let text = text_of(bytes);
    let mut lines = lines(&text, true).peekable();
    let end = |what: &str| MeshErrorKind::Syntax {
        line: None,
        what: format!("the file ends where {what} is needed"),
    };
    let mut first = lines.next().ok_or_else(|| end("the keyword OFF"))?;
    if let Some(keyword) = first.words().next().filter(|word| word.ends_with("OFF")) {
        if first.words().nth(1) == Some("BINARY") {
            return Err(first.fault("a binary OFF file; only text is read"));
        }
        if !["OFF", "COFF", "NOFF", "CNOFF", "STOFF"].contains(&keyword) {
            return Err(first.fault(format!(
                "{keyword} files are not read; OFF, COFF, NOFF and STOFF are"
            )));
        }
        let rest = first.text.get(keyword.len()..).unwrap_or_default().trim();
        first = if rest.is_empty() {
            lines.next().ok_or_else(|| end("the number of vertices"))?
        } else {
            Line {
                text: rest,
                ..first
            }
        };
    }
    let mut counts = first.words();
    let vertices: usize = first.number(counts.next(), "the number of vertices")?;
    let faces: usize = first.number(counts.next(), "the number of faces")?;

    let mut soup = Soup::default();
    for index in 0..vertices {
        let line = lines
            .next()
            .ok_or_else(|| end(&format!("vertex {} of {vertices}", index + 1)))?;
        let position = line.point(&mut line.words())?;
        soup.push_vertex(position, Some(line.number))?;
    }
    let mut corners = Vec::new();
    for index in 0..faces {
        let line = lines
            .next()
            .ok_or_else(|| end(&format!("face {} of {faces}", index + 1)))?;
        let mut words = line.words();
        let size: usize = line.number(words.next(), "the number of a face's vertices")?;
        corners.clear();
        for _ in 0..size {
            let index: i64 = line.number(words.next(), "the index of a vertex")?;
            match u32::try_from(index)
                .ok()
                .filter(|&index| (index as usize) < vertices)
            {
                Some(index) => corners.push(index),
                None => {
                    return Err(MeshErrorKind::Index {
                        line: Some(line.number),
                        index,
                        vertices,
                    });
                }
            }
        }
        // Faces of one or two vertices are points and lines, which the format allows and which bound nothing.
        if corners.len() >= 3 {
            soup.push_face(&corners);
        }
    }
    Ok(soup)
}
