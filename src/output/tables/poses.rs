//! `poses.csv`: one row per pose, best first (RFC 4180, but with LF as the line end).
//!
//! Columns are found by name: those of `pose_columns`, and appended ones. Quaternions are Hamilton's, active, right-handed, unit, `qw >= 0`; a ligand atom at x in its own file
//! goes to R(q) x + t, in Å, in the receptor's file frame. Numbers are in the shortest digits that read back to the
//! same f64; a missing value is an empty field.

use std::io;

use csv::StringRecord;
use knotdock_scoring::se3::Pose;
use serde_json::Value;

use crate::output::tables::fields::Column;
use crate::table_text::cells::TableWriter;

/// A table of poses as text, with the pose of each row, as `evaluate` and `export` read it.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseTable {
    /// The columns.
    pub header: StringRecord,
    /// Fields of each row.
    pub records: Vec<StringRecord>,
    /// Rank and pose of each row.
    pub rows: Vec<PoseRow>,
}

/// Rank and pose of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseRow {
    /// 1-based rank.
    pub rank: usize,
    /// From the ligand's file frame to the receptor's.
    pub pose: Pose,
}

impl PoseTable {
    /// The poses, in the table's order.
    pub fn rows(&self) -> &[PoseRow] {
        &self.rows
    }

    /// The field of a row in a column, if the table has both.
    pub fn field(&self, row: usize, column: &str) -> Option<&str> {
        let place = self.header.iter().position(|name| name == column)?;
        self.records.get(row)?.get(place)
    }

    /// Rows as JSON objects with the columns' names: numbers, truth values and text, `null` for empty fields. Indices
    /// past the end are skipped.
    pub fn objects(&self, indices: impl IntoIterator<Item = usize>) -> Vec<Value> {
        let indices = indices.into_iter();
        let records = indices.filter_map(|index| self.records.get(index));
        records
            .map(|record| row_object(&self.header, record))
            .collect()
    }

    /// Puts a column at the end, or in the place of the one that has its name.
    ///
    /// A row for which `column` has no field gets an empty one.
    pub fn set_column(&mut self, column: &Column) {
        let place = self.header.iter().position(|name| name == column.name);
        if place.is_none() {
            self.header.push_field(&column.name);
        }
        for (index, record) in self.records.iter_mut().enumerate() {
            let field = column.fields.get(index).map_or("", String::as_str);
            match place {
                None => record.push_field(field),
                Some(place) => {
                    let fields = record.iter().enumerate();
                    let fields = fields.map(|(at, old)| if at == place { field } else { old });
                    *record = fields.collect();
                }
            }
        }
    }

    /// Writes the table to a stream.
    pub fn write_to(&self, stream: &mut dyn io::Write) -> io::Result<()> {
        let mut writer = TableWriter::new(stream);
        writer.row(&self.header)?;
        for record in &self.records {
            writer.row(record)?;
        }
        writer.flush()
    }
}

/// A row as a JSON object with the columns' names.
pub(crate) fn row_object(header: &StringRecord, record: &StringRecord) -> Value {
    let fields = header.iter().zip(record);
    let entries = fields.map(|(name, field)| (name.to_owned(), value(field)));
    Value::Object(entries.collect())
}

/// A field as JSON.
fn value(field: &str) -> Value {
    if field.is_empty() {
        return Value::Null;
    }
    // Numbers and truth values are written in CSV as in JSON; what is neither is text.
    match serde_json::from_str(field) {
        Ok(value @ (Value::Bool(_) | Value::Number(_))) => value,
        _ => field.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_name_and_replaced_in_place() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("poses.csv");
        std::fs::write(
            &path,
            "note,tz,ty,tx,qz,qy,qx,qw,irmsd,rank\r\n\"a, b\",3,2,1,0,0,0,1,9,5\r\n",
        )
        .unwrap();
        let mut table = PoseTable::read(&path).unwrap();
        let row = table.rows()[0];
        assert_eq!(row.rank, 5);
        assert_eq!(
            row.pose,
            Pose::from_parts([1.0, 0.0, 0.0, 0.0], [1.0, 2.0, 3.0])
        );
        for (name, value) in [("irmsd", "0.5"), ("fnat", "1")] {
            table.set_column(&Column {
                name: name.to_owned(),
                fields: vec![value.to_owned()],
            });
        }
        let mut written = Vec::new();
        table.write_to(&mut written).unwrap();
        assert_eq!(
            String::from_utf8(written).unwrap(),
            "note,tz,ty,tx,qz,qy,qx,qw,irmsd,rank,fnat\n\"a, b\",3,2,1,0,0,0,1,0.5,5,1\n"
        );
    }
}
