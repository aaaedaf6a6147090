//! `refined.csv`: one row a refined pose, in the order in which ranks were requested.
//!
//! RFC 4180, but with LF as the line end. `docs/reference/files.md` describes the columns. `rank` and the pose are named as in
//! `poses.csv`, so that the table is one of poses, too.

use std::io;

use serde_json::{Map, Value, json};

use knotdock::evaluate::PoseQuality;
use knotdock::output::tables::fields::number;
use knotdock::refine::Refined;
use knotdock::table_text::cells::TableWriter;

/// A refined pose, with its qualities before and after where there is a known complex.
pub struct RefinedRow {
    /// Rank in the run's table.
    pub rank: usize,
    /// What came of it; the molecules are not read.
    pub refined: Refined,
    /// Before and after.
    pub quality: Option<[PoseQuality; 2]>,
}

/// A column: its name, and its value of a row.
type Column = (&'static str, fn(&RefinedRow) -> Value);

const COLUMNS: [Column; 15] = [
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
        row.refined
            .packing
            .map_or(Value::Null, |packing| json!(packing.moved))
    }),
    ("exact", |row| {
        row.refined
            .packing
            .map_or(Value::Null, |packing| json!(packing.exact))
    }),
];

/// The columns that a known complex adds.
const OF_NATIVE: [Column; 10] = [
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
fn columns(rows: &[RefinedRow]) -> impl Iterator<Item = &'static Column> {
    let has_native = rows.iter().any(|row| row.quality.is_some());
    let of_native: &[Column] = if has_native { &OF_NATIVE } else { &[] };
    COLUMNS.iter().chain(of_native)
}

/// Writes the table to a stream.
///
/// # Errors
/// Those of the stream.
pub fn write_to(stream: &mut dyn io::Write, rows: &[RefinedRow]) -> io::Result<()> {
    let mut table = TableWriter::new(stream);
    table.row(columns(rows).map(|(name, _)| *name))?;
    for row in rows {
        table.row(columns(rows).map(|(_, value)| field(&value(row))))?;
    }
    table.flush()
}

/// The rows as JSON objects with the names of the columns.
pub fn objects(rows: &[RefinedRow]) -> Vec<Map<String, Value>> {
    let object = |row: &RefinedRow| {
        let entries = columns(rows).map(|(name, value)| ((*name).to_owned(), value(row)));
        entries.collect()
    };
    rows.iter().map(object).collect()
}

/// A value as a field.
fn field(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(value) if value.is_f64() => value.as_f64().map_or(String::new(), number),
        other => other.to_string(),
    }
}
