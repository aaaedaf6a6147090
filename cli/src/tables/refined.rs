//! `refined.csv`: one row a refined pose, in the order in which ranks were requested.
//!
//! RFC 4180, but with LF as the line end. `docs/reference/files.md` describes the columns. `rank` and the pose are named as in
//! `poses.csv`, so that the table is one of poses, too.

use std::io;

use serde_json::{Map, Value, json};

use crate::tables::{Column, object, write_table};
use knotdock::evaluate::PoseQuality;
use knotdock::refine::Refined;

/// A refined pose, with its qualities before and after where there is a known complex.
pub struct RefinedRow {
    /// Rank in the run's table.
    pub rank: usize,
    /// What came of it; the molecules are not read.
    pub refined: Refined,
    /// Before and after.
    pub quality: Option<[PoseQuality; 2]>,
}

const COLUMNS: [Column<RefinedRow>; 15] = [
    ("rank", |row| json!(row.rank)),
    ("qw", |row| quaternion(row, 0)),
    ("qx", |row| quaternion(row, 1)),
    ("qy", |row| quaternion(row, 2)),
    ("qz", |row| quaternion(row, 3)),
    ("tx", |row| json!(row.refined.pose.translation.x)),
    ("ty", |row| json!(row.refined.pose.translation.y)),
    ("tz", |row| json!(row.refined.pose.translation.z)),
    ("rmsd_moved", |row| json!(row.refined.rmsd_moved)),
    ("energy_before", |row| json!(row.refined.before.total())),
    ("energy_after", |row| json!(row.refined.after.total())),
    ("clashes_before", |row| json!(row.refined.before.clashes)),
    ("clashes_after", |row| json!(row.refined.after.clashes)),
    ("side_chains_moved", |row| {
        json!(row.refined.packing.map(|packing| packing.moved))
    }),
    ("exact", |row| {
        json!(row.refined.packing.map(|packing| packing.exact))
    }),
];

/// The columns that a known complex adds.
const OF_NATIVE: [Column<RefinedRow>; 10] = [
    ("irmsd_before", |row| of(row, 0, |q| json!(q.irmsd))),
    ("irmsd_after", |row| of(row, 1, |q| json!(q.irmsd))),
    ("lrmsd_before", |row| of(row, 0, |q| json!(q.lrmsd))),
    ("lrmsd_after", |row| of(row, 1, |q| json!(q.lrmsd))),
    ("fnat_before", |row| of(row, 0, |q| json!(q.fnat))),
    ("fnat_after", |row| of(row, 1, |q| json!(q.fnat))),
    ("dockq_before", |row| of(row, 0, |q| json!(q.dockq))),
    ("dockq_after", |row| of(row, 1, |q| json!(q.dockq))),
    ("capri_before", |row| of(row, 0, |q| json!(q.capri.name()))),
    ("capri_after", |row| of(row, 1, |q| json!(q.capri.name()))),
];

fn quaternion(row: &RefinedRow, part: usize) -> Value {
    json!(row.refined.pose.quaternion()[part])
}

/// A value of a row's quality, before (0) or after (1).
fn of(row: &RefinedRow, time: usize, value: fn(&PoseQuality) -> Value) -> Value {
    let quality = row.quality.as_ref();
    quality.map_or(Value::Null, |quality| value(&quality[time]))
}

/// The columns of a table.
fn columns(rows: &[RefinedRow]) -> Vec<Column<RefinedRow>> {
    let has_native = rows.iter().any(|row| row.quality.is_some());
    let of_native: &[_] = if has_native { &OF_NATIVE } else { &[] };
    [&COLUMNS, of_native].concat()
}

/// Writes the table to a stream.
///
/// # Errors
/// Those of the stream.
pub fn write_to(stream: &mut dyn io::Write, rows: &[RefinedRow]) -> io::Result<()> {
    write_table(stream, &columns(rows), rows)
}

/// The rows as JSON objects with the names of the columns.
pub fn objects(rows: &[RefinedRow]) -> Vec<Map<String, Value>> {
    let columns = columns(rows);
    rows.iter().map(|row| object(&columns, row)).collect()
}
