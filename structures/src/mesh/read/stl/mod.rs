//! STL, text and binary. A text file may hold several solids; all are read. Normals are not used.

mod binary;
mod text;

use crate::mesh::error::MeshErrorKind;
use crate::mesh::read::encoding::text_of;
use crate::mesh::read::soup::Soup;

pub use crate::mesh::read::stl::binary::has_records;
pub use crate::mesh::read::stl::text::begins;

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Soup, MeshErrorKind> {
    // Many binary files begin with `solid` as text ones do, so the length decides.
    if !has_records(bytes)
        && let Some(text) = text_of(bytes)
    {
        return text::parse(&text);
    }
    binary::parse(bytes)
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
            Err(MeshErrorKind::Syntax { line, .. }) => assert_eq!(line, Some(7)),
            _ => panic!("a vertex of letters is no vertex"),
        }
    }
}
