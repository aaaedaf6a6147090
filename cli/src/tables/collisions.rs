//! Collisions of two solids as a table: one row per pose, in the order of the poses.
//!
//! RFC 4180, but with LF as the line end. `docs/reference/solids_files.md` describes the columns. All of them but
//! `microseconds` are the same for any number of threads.

use std::path::Path;

use csv::StringRecord;
use knotdock::geometry::collide::CollisionReport;
use knotdock::output::files::whole_file::StagedFile;
use knotdock::output::tables::fields::number;
use knotdock::table_text::cells::TableWriter;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use serde_json::{Map, Value, json};

/// The columns, in order.
#[rustfmt::skip]
const COLUMNS: [&str; 31] = [
    "pose", "qw", "qx", "qy", "qz", "tx", "ty", "tz", "verdict", "certified_by", "distance_low", "distance_high",
    "witness_a_x", "witness_a_y", "witness_a_z", "witness_b_x", "witness_b_y", "witness_b_z", "overlap_volume",
    "overlap_volume_bound", "overlap_energy", "force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z",
    "energy_bound", "ball_pairs", "modes", "microseconds",
];

/// The values of each row; `null` for quantities that were not computed. Poses are numbered from 1.
fn rows<'a>(
    poses: &'a [Pose],
    reports: &'a [CollisionReport],
) -> impl Iterator<Item = Vec<Value>> + use<'a> {
    let rows = (1usize..).zip(poses).zip(reports);
    rows.map(|((number, pose), report)| {
        let translation: [f64; 3] = pose.translation.into();
        let distance = report.distance;
        let witness = |side: usize| vector(distance.map(|distance| distance.witnesses[side]));
        let volume = report.shared_volume;
        let contact = report.contact;
        let mut row = vec![json!(number)];
        row.extend(pose.quaternion().map(Value::from));
        row.extend(translation.map(Value::from));
        row.push(json!(report.verdict.name()));
        row.push(json!(report.certificate.name()));
        row.push(json!(distance.map(|distance| distance.low)));
        row.push(json!(distance.map(|distance| distance.high)));
        row.extend(witness(0));
        row.extend(witness(1));
        row.push(json!(volume.map(|volume| volume.value)));
        row.push(json!(volume.map(|volume| volume.bound)));
        row.push(json!(contact.map(|contact| contact.energy)));
        row.extend(vector(contact.map(|contact| contact.force)));
        row.extend(vector(contact.map(|contact| contact.torque)));
        row.push(json!(contact.map(|contact| contact.bound)));
        row.push(json!(report.ball_pairs));
        row.push(json!(report.modes));
        row.push(json!((report.seconds * 1e7).round() / 10.0));
        row
    })
}

/// The components of a vector.
fn vector(vector: Option<[f64; 3]>) -> [Value; 3] {
    [0, 1, 2].map(|axis| json!(vector.map(|vector| vector[axis])))
}

/// A row as it is written.
fn record(row: &[Value]) -> StringRecord {
    let field = |value: &Value| match value {
        Value::String(word) => word.clone(),
        Value::Number(value) if value.is_f64() => value.as_f64().map(number).unwrap_or_default(),
        Value::Number(count) => count.to_string(),
        _ => String::new(),
    };
    row.iter().map(field).collect()
}

/// Writes the table beside its place.
///
/// # Errors
/// [`Error`] when the file cannot be made or written.
pub fn write(
    path: &Path,
    poses: &[Pose],
    reports: &[CollisionReport],
) -> Result<StagedFile, Error> {
    StagedFile::write(path, |file| {
        let mut table = TableWriter::new(file);
        table.row(COLUMNS)?;
        for row in rows(poses, reports) {
            table.row(&record(&row))?;
        }
        table.flush()
    })
}

/// The header and the rows, as they are written.
pub fn table(poses: &[Pose], reports: &[CollisionReport]) -> (StringRecord, Vec<StringRecord>) {
    let records = rows(poses, reports).map(|row| record(&row));
    (COLUMNS.iter().collect(), records.collect())
}

/// The rows as JSON objects with the names of the columns.
pub fn objects(poses: &[Pose], reports: &[CollisionReport]) -> Vec<Value> {
    let names = || COLUMNS.map(str::to_owned).into_iter();
    let objects = rows(poses, reports).map(|row| names().zip(row).collect::<Map<_, _>>());
    objects.map(Value::Object).collect()
}
