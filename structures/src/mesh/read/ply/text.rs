//! The data of a text PLY: an element a line, or all in one stream of words.

use ply_rs_bw::ply::{Header, PropertyType, ScalarType};

use crate::mesh::error::MeshErrorKind;
use crate::mesh::read::ply::elements::{FaceLists, LISTS, Role, whole};
use crate::mesh::read::soup::At;
use crate::mesh::read::words::{Line, Records, by_line_or_stream, lines, real};

/// Reads what follows the header, which has `before` lines.
pub fn read(header: &Header, payload: &[u8], before: usize) -> Result<FaceLists, MeshErrorKind> {
    let text = String::from_utf8_lossy(payload);
    let lines = lines(&text, false).map(|line| Line {
        number: line.number + before,
        ..line
    });
    by_line_or_stream(&lines, (), &[()], |words, ()| elements(header, words))
}

fn elements<'a, L: Iterator<Item = Line<'a>>>(
    header: &Header,
    words: &mut Records<'a, L>,
) -> Result<FaceLists, MeshErrorKind> {
    let mut faces = FaceLists::default();
    for (name, element) in &header.elements {
        let role = Role::of(name, element)?;
        for index in 0..element.count {
            if element.properties.is_empty() {
                break;
            }
            words.begin(|| format!("{name} {} of {}", index + 1, element.count))?;
            let number = words.line().number;
            let mut position = [0.0; 3];
            let mut indices = Vec::new();
            for (property, definition) in &element.properties {
                let what = || format!("the property {property} of {name} {}", index + 1);
                let mut word = || {
                    words.next().ok_or_else(|| {
                        let end = format!("the line ends where {} is needed", what());
                        words.line().fault(end)
                    })
                };
                let first = word()?;
                match definition.data_type {
                    PropertyType::Scalar(ref kind) => {
                        let axis = ["x", "y", "z"].iter().position(|axis| axis == property);
                        if let (Role::Vertex, Some(axis)) = (role, axis) {
                            position[axis] = coordinate(first, kind)
                                .ok_or_else(|| words.line().misplaced(first, "a coordinate"))?;
                            faces.soup.digits.note(first);
                        }
                    }
                    PropertyType::List(..) => {
                        let length = index_of(first)
                            .and_then(|length| usize::try_from(length).ok())
                            .ok_or_else(|| words.line().misplaced(first, "the length of a list"))?;
                        let is_wanted = matches!(role, Role::Face | Role::Strip)
                            && LISTS.contains(&property.as_str());
                        for _ in 0..length {
                            let word = words.next().ok_or_else(|| {
                                let end = format!("the line ends where {} is needed", what());
                                words.line().fault(end)
                            })?;
                            if is_wanted {
                                let needed = "the index of a vertex";
                                indices.push(
                                    index_of(word)
                                        .ok_or_else(|| words.line().misplaced(word, needed))?,
                                );
                            }
                        }
                    }
                }
            }
            match role {
                Role::Vertex => {
                    faces.soup.push_vertex(position, Some(number))?;
                }
                Role::Face | Role::Strip => faces.lists.push((role, At::Line(number), indices)),
                Role::Other => {}
            }
        }
    }
    Ok(faces)
}

/// A coordinate as its type holds it.
fn coordinate(word: &str, kind: &ScalarType) -> Option<f64> {
    if matches!(kind, ScalarType::Float)
        && let Ok(value) = word.parse::<f32>()
    {
        return Some(f64::from(value));
    }
    real(word)
}

/// A whole number, which may be written as another one is.
fn index_of(word: &str) -> Option<i64> {
    let written = word.parse().ok();
    written.or_else(|| word.parse().ok().map(whole))
}
