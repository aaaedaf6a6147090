//! Collisions of two solids as a table: a row a pose, in the order of the poses.
//!
//! RFC 4180, but with LF as the line end. `docs/reference/solids_files.md` describes the columns. All of them but `microseconds` are
//! the same for any number of threads.

use knotdock_structures::Error;
use std::io;

use csv::StringRecord;
use knotdock_scoring::se3::Pose;
use serde_json::{Map, Value, json};

use knotdock::geometry::collide::Answer;
use knotdock::output::files::whole_file::StagedFile;
use knotdock::output::tables::fields::number;
use knotdock::table_text::cells::TableWriter;
use std::path::Path;

/// A value of a row.
enum Cell {
    Number(f64),
    Count(usize),
    Word(&'static str),
    /// A number that was not computed.
    Nothing,
}

/// A column: its name, and its value of a row.
type Column = (&'static str, fn(&Row) -> Cell);

/// A row: the number of the pose from 1, the pose, and what is known of it.
struct Row<'a> {
    number: usize,
    pose: &'a Pose,
    answer: &'a Answer,
}

impl Row<'_> {
    fn quaternion(&self, part: usize) -> Cell {
        Cell::Number(self.pose.quaternion()[part])
    }

    fn translation(&self, axis: usize) -> Cell {
        Cell::Number(self.pose.translation[axis])
    }

    fn witness(&self, side: usize, axis: usize) -> Cell {
        of(self
            .answer
            .bounds
            .map(|bounds| bounds.witnesses[side][axis]))
    }

    fn force(&self, axis: usize) -> Cell {
        of(self.answer.contact.map(|contact| contact.force[axis]))
    }

    fn torque(&self, axis: usize) -> Cell {
        of(self.answer.contact.map(|contact| contact.torque[axis]))
    }
}

fn of(value: Option<f64>) -> Cell {
    value.map_or(Cell::Nothing, Cell::Number)
}

/// The columns, in order.
const COLUMNS: [Column; 31] = [
    ("pose", |row| Cell::Count(row.number)),
    ("qw", |row| row.quaternion(0)),
    ("qx", |row| row.quaternion(1)),
    ("qy", |row| row.quaternion(2)),
    ("qz", |row| row.quaternion(3)),
    ("tx", |row| row.translation(0)),
    ("ty", |row| row.translation(1)),
    ("tz", |row| row.translation(2)),
    ("verdict", |row| Cell::Word(row.answer.found.verdict.name())),
    ("certified_by", |row| {
        Cell::Word(row.answer.found.certificate.name())
    }),
    ("distance_low", |row| {
        of(row.answer.bounds.map(|bounds| bounds.low))
    }),
    ("distance_high", |row| {
        of(row.answer.bounds.map(|bounds| bounds.high))
    }),
    ("witness_a_x", |row| row.witness(0, 0)),
    ("witness_a_y", |row| row.witness(0, 1)),
    ("witness_a_z", |row| row.witness(0, 2)),
    ("witness_b_x", |row| row.witness(1, 0)),
    ("witness_b_y", |row| row.witness(1, 1)),
    ("witness_b_z", |row| row.witness(1, 2)),
    ("overlap_volume", |row| {
        of(row.answer.volume.map(|volume| volume.value))
    }),
    ("overlap_volume_bound", |row| {
        of(row.answer.volume.map(|volume| volume.bound))
    }),
    ("overlap_energy", |row| {
        of(row.answer.contact.map(|contact| contact.energy))
    }),
    ("force_x", |row| row.force(0)),
    ("force_y", |row| row.force(1)),
    ("force_z", |row| row.force(2)),
    ("torque_x", |row| row.torque(0)),
    ("torque_y", |row| row.torque(1)),
    ("torque_z", |row| row.torque(2)),
    ("energy_bound", |row| {
        of(row.answer.contact.map(|contact| contact.bound))
    }),
    ("ball_pairs", |row| Cell::Count(row.answer.ball_pairs)),
    ("modes", |row| Cell::Count(row.answer.modes)),
    ("microseconds", |row| {
        Cell::Number((row.answer.seconds * 1e7).round() / 10.0)
    }),
];

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
    StagedFile::write(path, |file| write_to(file, poses, answers))
}

/// The header and the rows, as they are written.
pub fn table(poses: &[Pose], answers: &[Answer]) -> (StringRecord, Vec<StringRecord>) {
    let header = COLUMNS.iter().map(|(name, _)| *name).collect();
    (
        header,
        rows(poses, answers).map(|row| record(&row)).collect(),
    )
}

/// A row as it is written.
fn record(row: &Row) -> StringRecord {
    let field = |(_, cell): &Column| match cell(row) {
        Cell::Number(value) => number(value),
        Cell::Count(count) => count.to_string(),
        Cell::Word(word) => word.to_owned(),
        Cell::Nothing => String::new(),
    };
    COLUMNS.iter().map(field).collect()
}

fn write_to(file: &mut dyn io::Write, poses: &[Pose], answers: &[Answer]) -> io::Result<()> {
    let mut table = TableWriter::new(file);
    table.row(COLUMNS.map(|(name, _)| name))?;
    for row in rows(poses, answers) {
        table.row(&record(&row))?;
    }
    table.flush()
}

/// The rows as JSON objects with the names of the columns; `null` where nothing was computed.
pub fn objects(poses: &[Pose], answers: &[Answer]) -> Vec<Value> {
    rows(poses, answers)
        .map(|row| {
            let entry = |(name, cell): &Column| {
                let value = match cell(&row) {
                    Cell::Number(value) => json!(value),
                    Cell::Count(count) => json!(count),
                    Cell::Word(word) => json!(word),
                    Cell::Nothing => Value::Null,
                };
                ((*name).to_owned(), value)
            };
            Value::Object(COLUMNS.iter().map(entry).collect::<Map<_, _>>())
        })
        .collect()
}
