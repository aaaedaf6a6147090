//! STL, text and binary.
//!
//! A binary file has an 80-byte header, a little-endian count and 50 bytes a triangle; many begin with `solid` like text
//! ones, so the length decides. A text file may hold several solids; all are read. Normals are not used.

use super::super::error::MeshErrorKind;
use super::Soup;
use super::words::{Line, lines, text_of};

const HEADER: usize = 84;
const RECORD: usize = 50;

/// Number of triangles that a binary header promises.
fn promised(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEADER)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(count)).ok()
}

/// Whether the length is that of a binary file with this header.
pub fn is_binary(bytes: &[u8]) -> bool {
    promised(bytes).is_some_and(|count| count > 0 && bytes.len() == HEADER + RECORD * count)
}

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Soup, MeshErrorKind> {
    // A binary file cut short may begin with `solid` too; then it has zero bytes, which text never has.
    if !is_binary(bytes) && !bytes.contains(&0) {
        let text = text_of(bytes);
        let first = text.trim_start().get(..5);
        if first.is_some_and(|word| word.eq_ignore_ascii_case("solid")) {
            return parse_text(&text);
        }
    }
    parse_binary(bytes)
}

fn parse_binary(bytes: &[u8]) -> Result<Soup, MeshErrorKind> {
    let fault = |what: String| MeshErrorKind::Syntax { line: None, what };
    let Some(count) = promised(bytes) else {
        return Err(fault(
            "this is neither a text STL (it does not begin with 'solid') nor a binary one (it is shorter than the header of 84 bytes)"
                .to_owned(),
        ));
    };
    let records = bytes.get(HEADER..).unwrap_or_default();
    if records.len() / RECORD < count {
        return Err(fault(format!(
            "the header promises {count} triangles, but the file ends after {}",
            records.len() / RECORD
        )));
    }
    let mut soup = Soup::default();
    for record in records.chunks_exact(RECORD).take(count) {
        let mut corners = [0; 3];
        // The first twelve bytes are the normal.
        for (corner, bytes) in corners
            .iter_mut()
            .zip(record.get(12..48).unwrap_or_default().chunks_exact(12))
        {
            let mut position = [0.0; 3];
            for (value, bytes) in position.iter_mut().zip(bytes.chunks_exact(4)) {
                *value = f64::from(f32::from_le_bytes(bytes.try_into().unwrap_or_default()));
            }
            *corner = soup.push_vertex(position, None)?;
        }
        soup.triangles.push(corners);
    }
    Ok(soup)
}

fn parse_text(text: &str) -> Result<Soup, MeshErrorKind> {
    let mut soup = Soup::default();
    let mut corners: Vec<u32> = Vec::new();
    let mut facet: Option<Line<'_>> = None;
    for line in lines(text, false) {
        let mut words = line.words();
        let keyword = words.next().unwrap_or_default().to_ascii_lowercase();
        match (keyword.as_str(), facet) {
            // Names may be anything, so the rest of the line is not looked at.
            ("solid" | "endsolid", None) => {}
            ("facet", None) => {
                facet = Some(line);
                corners.clear();
            }
            ("outer" | "endloop", Some(_)) => {}
            ("vertex", Some(_)) => {
                let position = line.point(&mut words)?;
                corners.push(soup.push_vertex(position, Some(line.number))?);
            }
            ("endfacet", Some(_)) => {
                if corners.len() < 3 {
                    return Err(line.fault(format!(
                        "a facet of {} vertices; three are needed",
                        corners.len()
                    )));
                }
                soup.push_face(&corners);
                facet = None;
            }
            (word, _) => {
                return Err(line.fault(format!(
                    "'{}' is not expected {} a facet",
                    word.chars().take(40).collect::<String>(),
                    if facet.is_some() { "inside" } else { "outside" }
                )));
            }
        }
    }
    match facet {
        Some(line) => Err(line.fault("the file ends inside the facet that begins here")),
        None => Ok(soup),
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
            assert_eq!(soup.triangles.len(), 1, "{head:?}");
        }
    }

    #[test]
    fn lines_end_in_lf_crlf_or_cr() {
        let text = format!("solid\n{FACET}{FACET}endsolid\n");
        for end in ["\n", "\r\n", "\r"] {
            let soup = parse(text.replace('\n', end).as_bytes()).unwrap();
            assert_eq!(soup.triangles.len(), 2, "{end:?}");
        }
    }

    #[test]
    fn lines_are_those_of_the_file() {
        let broken = format!(
            "\n\n\nsolid\n{}",
            FACET.replace("vertex 0 0 0", "vertex a b c")
        );
        match parse(broken.as_bytes()) {
            Err(MeshErrorKind::Syntax { line, .. }) => assert_eq!(line, Some(7)),
            _ => panic!("a vertex of letters is no vertex"),
        }
    }
}
