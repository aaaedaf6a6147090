//! The header of a PLY file.

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, Header};

use crate::mesh::error::MeshErrorKind;
use crate::mesh::read::ply::binary::broken;
use crate::mesh::read::words::shortened;

/// Whether a file begins as a PLY file does.
pub fn begins(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    start.starts_with(b"ply") && start.get(3).is_none_or(u8::is_ascii_whitespace)
}

/// Reads the header; returns it with the bytes behind it and the number of its lines.
///
/// Comments and blank lines are made empty comments, which keeps the numbers of lines: the crate takes no blank lines,
/// and no text but UTF-8.
pub fn read(bytes: &[u8]) -> Result<(Header, &[u8], usize), MeshErrorKind> {
    let lead = bytes.len() - bytes.trim_ascii_start().len();
    let start = bytes.get(lead..).unwrap_or_default();
    let mut number = bytes
        .iter()
        .take(lead)
        .filter(|&&byte| byte == b'\n')
        .count();
    if !begins(bytes) {
        let first = start.split(|&byte| matches!(byte, b'\n' | b'\r')).next();
        return Err(MeshErrorKind::Syntax {
            line: (!start.is_empty()).then_some(number + 1),
            what: match first {
                Some(first) if !first.is_empty() => format!(
                    "this is no PLY: it begins with '{}' in place of 'ply'",
                    shortened(&String::from_utf8_lossy(first))
                ),
                _ => "the file is empty".to_owned(),
            },
        });
    }
    // Old systems end lines in CR alone.
    let end = match start.get(3..5) {
        Some(b"\r\n") => b'\n',
        Some([b'\r', _]) => b'\r',
        _ => b'\n',
    };
    // The crate counts lines from the first that it sees.
    let mut text = String::new();
    let lines_before = number;
    let mut rest = start;
    loop {
        let Some(length) = rest.iter().position(|&byte| byte == end) else {
            return Err(MeshErrorKind::Syntax {
                line: None,
                what: "the header does not end: there is no line 'end_header'".to_owned(),
            });
        };
        let line = String::from_utf8_lossy(rest.get(..length).unwrap_or_default());
        let line = line.trim();
        rest = rest.get(length + 1..).unwrap_or_default();
        number += 1;
        let is_comment = |word: &str| matches!(word, "comment" | "obj_info");
        let kept = line
            .split_ascii_whitespace()
            .next()
            .filter(|word| !is_comment(word));
        text.push_str(kept.map_or("comment", |_| line));
        text.push('\n');
        if line == "end_header" {
            break;
        }
    }
    let mut reader = Reader::new(text.as_bytes());
    let header = Parser::<DefaultElement>::new()
        .read_header(&mut reader)
        .map_err(|error| broken(&error, lines_before))?;
    Ok((header, rest, number))
}
