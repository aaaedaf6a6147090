//! Collisions of two solids as a table: a row a pose, in the order of the poses.
//!
//! RFC 4180, but with LF as the line end. `docs/reference/solids_files.md` describes the columns. All of them but `microseconds` are
//! the same for any number of threads.

use std::path::Path;

use csv::StringRecord;
use knotdock_scoring::se3::Pose;
use serde_json::{Value, json};

use crate::tables::{Column, field, object, write_table};
use knotdock::geometry::collide::Answer;
use knotdock::output::files::whole_file::StagedFile;
use knotdock_structures::Error;

/// A row: the number of the pose from 1, the pose, and what was computed there.
struct Row<'a> {
    number: usize,
    pose: &'a Pose,
    answer: &'a Answer,
}

fn quaternion(row: &Row, part: usize) -> Value {
    json!(row.pose.quaternion()[part])
}

fn translation(row: &Row, axis: usize) -> Value {
    json!(row.pose.translation[axis])
}

fn witness(row: &Row, side: usize, axis: usize) -> Value {
    let bounds = row.answer.bounds;
    json!(bounds.map(|bounds| bounds.witnesses[side][axis]))
}

fn force(row: &Row, axis: usize) -> Value {
    json!(row.answer.contact.map(|contact| contact.force[axis]))
}

fn torque(row: &Row, axis: usize) -> Value {
    json!(row.answer.contact.map(|contact| contact.torque[axis]))
}

/// The columns, in order.
fn columns<'a>() -> [Column<Row<'a>>; 31] {
    [
        ("pose", |row| json!(row.number)),
        ("qw", |row| quaternion(row, 0)),
        ("qx", |row| quaternion(row, 1)),
        ("qy", |row| quaternion(row, 2)),
        ("qz", |row| quaternion(row, 3)),
        ("tx", |row| translation(row, 0)),
        ("ty", |row| translation(row, 1)),
        ("tz", |row| translation(row, 2)),
        ("verdict", |row| json!(row.answer.found.verdict.name())),
        ("certified_by", |row| {
            json!(row.answer.found.certificate.name())
        }),
        ("distance_low", |row| {
            json!(row.answer.bounds.map(|bounds| bounds.low))
        }),
        ("distance_high", |row| {
            json!(row.answer.bounds.map(|bounds| bounds.high))
        }),
        ("witness_a_x", |row| witness(row, 0, 0)),
        ("witness_a_y", |row| witness(row, 0, 1)),
        ("witness_a_z", |row| witness(row, 0, 2)),
        ("witness_b_x", |row| witness(row, 1, 0)),
        ("witness_b_y", |row| witness(row, 1, 1)),
        ("witness_b_z", |row| witness(row, 1, 2)),
        ("overlap_volume", |row| {
            json!(row.answer.volume.map(|volume| volume.value))
        }),
        ("overlap_volume_bound", |row| {
            json!(row.answer.volume.map(|volume| volume.bound))
        }),
        ("overlap_energy", |row| {
            json!(row.answer.contact.map(|contact| contact.energy))
        }),
        ("force_x", |row| force(row, 0)),
        ("force_y", |row| force(row, 1)),
        ("force_z", |row| force(row, 2)),
        ("torque_x", |row| torque(row, 0)),
        ("torque_y", |row| torque(row, 1)),
        ("torque_z", |row| torque(row, 2)),
        ("energy_bound", |row| {
            json!(row.answer.contact.map(|contact| contact.bound))
        }),
        ("ball_pairs", |row| json!(row.answer.ball_pairs)),
        ("modes", |row| json!(row.answer.modes)),
        ("microseconds", |row| {
            json!((row.answer.seconds * 1e7).round() / 10.0)
        }),
    ]
}

fn rows<'a>(poses: &'a [Pose], answers: &'a [Answer]) -> impl Iterator<Item = Row<'a>> {
    let rows = (1..).zip(poses).zip(answers);
    rows.map(|((number, pose), answer)| Row {
        number,
        pose,
        answer,
    })
}

/// Writes the table beside its place.
///
/// # Errors
/// [`Error`].
pub fn write(path: &Path, poses: &[Pose], answers: &[Answer]) -> Result<StagedFile, Error> {
    StagedFile::write(path, |file| {
        write_table(file, &columns(), rows(poses, answers))
    })
}

/// The header and the rows, as they are written.
pub fn table(poses: &[Pose], answers: &[Answer]) -> (StringRecord, Vec<StringRecord>) {
    let columns = columns();
    let records = rows(poses, answers).map(|row| {
        let fields = columns.iter().map(|(_, value)| field(&value(&row)));
        fields.collect()
    });
    (
        columns.iter().map(|(name, _)| *name).collect(),
        records.collect(),
    )
}

/// The rows as JSON objects with the names of the columns; `null` where nothing was computed.
pub fn objects(poses: &[Pose], answers: &[Answer]) -> Vec<Value> {
    let columns = columns();
    rows(poses, answers)
        .map(|row| Value::Object(object(&columns, &row)))
        .collect()
}
