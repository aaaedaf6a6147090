//! Binary STL: an 80-byte header, a little-endian count and 50 bytes a triangle.
//!
//! The count may be wrong: programs that write to a pipe leave it at zero or at a number that no file reaches. The
//! records that are there are read then, with a note.

use crate::mesh::error::MeshErrorKind;
use crate::mesh::read::soup::{At, LeftOut, Soup, is_finite};

const HEADER: usize = 84;
const RECORD: usize = 50;

/// How far records that the header does not count may lie from those that it counts, in sizes of these.
const FARTHEST: f64 = 1e3;

/// Number of triangles that the header gives.
fn counted(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEADER)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(count)).ok()
}

/// Whether the length is that of a binary file with this header.
pub fn has_records(bytes: &[u8]) -> bool {
    counted(bytes).is_some_and(|count| count > 0 && bytes.len() == HEADER + RECORD * count)
}

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Soup, MeshErrorKind> {
    let fault = |what: String| MeshErrorKind::Syntax { line: None, what };
    let Some(count) = counted(bytes) else {
        return Err(fault(
            "this is neither a text STL (it does not begin with 'solid') nor a binary one (it is shorter than the header of 84 bytes)"
                .to_owned(),
        ));
    };
    let records = bytes.get(HEADER..).unwrap_or_default();
    let (there, left) = (records.len() / RECORD, records.len() % RECORD);
    // A file that ends inside a record was cut short, or is of another kind.
    if there < count && (left > 0 || there == 0) {
        return Err(fault(format!(
            "as a binary STL its header promises {count} triangles, but the file ends after {there}"
        )));
    }
    let mut soup = Soup::default();
    let mut number = 0;
    for record in records.chunks_exact(RECORD).take(count) {
        number += 1;
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
    for &corners in more {
        number += 1;
        push(&mut soup, corners, number)?;
    }
    let read = number;
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

fn push(soup: &mut Soup, corners: Corners, number: usize) -> Result<(), MeshErrorKind> {
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
    if soup.positions.is_empty() {
        return true;
    }
    let largest = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
    };
    // Numbers that are none are left out later.
    let size = largest(&mut soup.positions.iter().flatten().copied());
    largest(&mut corners.iter().flatten().copied()) <= FARTHEST * size
}
