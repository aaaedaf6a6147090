//! Wavefront OBJ: `v` and `f` lines; all else (normals, textures, groups, materials, lines, points) bounds no solid.

use super::super::error::MeshErrorKind;
use super::Soup;
use super::words::lines;

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Soup, MeshErrorKind> {
    let text = String::from_utf8_lossy(bytes);
    // A backslash at the end of a line continues it; the blank keeps lines counted.
    let joined;
    let text: &str = if text.contains('\\') {
        joined = text.replace("\\\r\n", "  \u{b}").replace("\\\n", " \u{b}");
        &joined
    } else {
        &text
    };
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    let mut continued = 0;
    for mut line in lines(text, true) {
        line.number += continued;
        continued += line.text.matches('\u{b}').count();
        let mut words = line
            .text
            .split(|c: char| c.is_ascii_whitespace() || c == '\u{b}')
            .filter(|w| !w.is_empty());
        match words.next() {
            Some("v") => {
                let position = line.point(&mut words)?;
                soup.push_vertex(position, Some(line.number))?;
            }
            Some("f" | "fo") => {
                corners.clear();
                for word in words {
                    // v, v/vt, v//vn or v/vt/vn.
                    let vertex = word.split('/').next();
                    let index: i64 = line.number(vertex, "the number of a vertex")?;
                    let count = soup.positions.len();
                    let place = match index {
                        1.. => usize::try_from(index - 1).ok(),
                        // Counted back from the latest vertex.
                        ..=-1 => usize::try_from(index.unsigned_abs())
                            .ok()
                            .and_then(|back| count.checked_sub(back)),
                        0 => None,
                    };
                    match place
                        .filter(|&place| place < count)
                        .and_then(|place| u32::try_from(place).ok())
                    {
                        Some(place) => corners.push(place),
                        None => {
                            return Err(MeshErrorKind::Index {
                                line: Some(line.number),
                                index,
                                vertices: count,
                            });
                        }
                    }
                }
                if corners.len() < 3 {
                    return Err(line.fault(format!(
                        "a face of {} vertices; three are needed",
                        corners.len()
                    )));
                }
                soup.push_face(&corners);
            }
            _ => {}
        }
    }
    Ok(soup)
}
