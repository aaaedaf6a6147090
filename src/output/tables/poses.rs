//! `poses.csv`: one row a pose, best first (RFC 4180, but with LF as the line end).
//!
//! Columns are found by name: those of `pose_columns`, and whatever is
//! appended. Quaternions are Hamilton's, active, right-handed, unit, `qw >= 0`; a ligand atom at x in its own file
//! goes to R(q) x + t, in Å, in the receptor's file frame. Numbers are in the shortest digits that read back to the
//! same f64; a missing value is an empty field.

use std::io;
use std::path::Path;

use csv::StringRecord;
use knotdock_scoring::se3::Pose;
use serde_json::Value;

use crate::dock::outcome::RankedPose;
use crate::output::files::whole_file::{FileError, write_whole};
use crate::output::tables::cells::TableWriter;
use crate::output::tables::fields::Column;
use crate::output::tables::pose_columns::columns;

/// A table of poses as text, with the pose of each row: what `evaluate` and `export` read.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseTable {
    pub(crate) header: StringRecord,
    pub(crate) records: Vec<StringRecord>,
    pub(crate) rows: Vec<PoseRow>,
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
    /// The table of a search's poses in the order given, ranked from 1; with columns for diagnosis if they are wanted.
    pub fn new(poses: &[RankedPose], diagnostics: bool) -> Self {
        let columns = columns(diagnostics);
        let rows = poses.iter().enumerate().map(|(index, row)| PoseRow {
            rank: index + 1,
            pose: row.pose,
        });
        let record = |(index, row): (usize, &RankedPose)| {
            let fields = columns.iter().map(|column| (column.field)(row));
            std::iter::once((index + 1).to_string())
                .chain(fields)
                .collect()
        };
        let names = columns.iter().map(|column| column.name);
        Self {
            header: std::iter::once("rank").chain(names).collect(),
            records: poses.iter().enumerate().map(record).collect(),
            rows: rows.collect(),
        }
    }

    /// The poses, in the table's order.
    pub fn rows(&self) -> &[PoseRow] {
        &self.rows
    }

    /// Rows as JSON objects with the columns' names: numbers, truth values and text, `null` for empty fields. Indices
    /// past the end are skipped.
    pub fn objects(&self, indices: impl IntoIterator<Item = usize>) -> Vec<Value> {
        let records = indices
            .into_iter()
            .filter_map(|index| self.records.get(index));
        records
            .map(|record| {
                let fields = self.header.iter().zip(record);
                fields
                    .map(|(name, field)| (name.to_owned(), value(field)))
                    .collect::<serde_json::Map<_, _>>()
                    .into()
            })
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
                    *record = record
                        .iter()
                        .enumerate()
                        .map(|(at, old)| if at == place { field } else { old })
                        .collect();
                }
            }
        }
    }

    /// Writes the table, whole or not at all.
    ///
    /// # Errors
    /// [`FileError`] when the file cannot be made or written.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        write_whole(path, |file| self.write_to(file))
    }

    /// Writes the table to a stream.
    ///
    /// # Errors
    /// Those of the stream.
    pub fn write_to(&self, stream: &mut dyn io::Write) -> io::Result<()> {
        let mut writer = TableWriter::new(stream);
        writer.row(&self.header)?;
        for record in &self.records {
            writer.row(record)?;
        }
        writer.flush()
    }
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
    use knotdock_scoring::terms::pose::{POSE_TERMS, TermValues};

    fn pose(quaternion: [f64; 4], translation: [f64; 3]) -> RankedPose {
        RankedPose {
            pose: Pose::from_parts(quaternion, translation),
            score: 1.0 / 3.0,
            search_score: 0.25,
            cluster: None,
            cluster_size: Some(4),
            cluster_score: None,
            refined: true,
            rotation: 17,
            score_grid: f64::NAN,
            score_unfiltered: 1e-7,
            terms: [Some(0.1), None, Some(-3.0), None],
            slices: [-0.0, 2.0, 1e21],
            pose_terms: TermValues::default()
                .with("atom_pair", -7.0)
                .with("relaxed", 2.5),
            other_copies: None,
            pose_score: 1.0 / 3.0,
            z_score: Some(2.5),
        }
    }

    fn text(table: &PoseTable) -> String {
        let mut bytes = Vec::new();
        table.write_to(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn numbers_are_shortest_and_missing_ones_empty() {
        let table = PoseTable::new(&[pose([-0.5, 0.5, 0.5, -0.5], [1.5, -2.25, 0.1])], true);
        assert_eq!(
            text(&table),
            "rank,score,cluster,cluster_size,pose_score,search_score,shape,electrostatics,contact,restraint,\
             fine_contact,atom_pair,relaxed,active_residues,unresolved,termini,other_copies,z_score,\
             qw,qx,qy,qz,tx,ty,tz,cluster_score,refined,rotation,score_grid,score_unfiltered,\
             slice_0,slice_r0,slice_2r0\n\
             1,0.3333333333333333,,4,0.3333333333333333,0.25,0.1,,-3,,,-7,2.5,,,,,2.5,\
             0.5,-0.5,-0.5,0.5,1.5,-2.25,0.1,,true,17,,0.0000001,0,2,1000000000000000000000\n"
        );
    }

    /// Every pose term has one column and one JSON key, which is its id.
    #[test]
    fn columns_of_pose_terms_are_those_of_the_registry() {
        let values = POSE_TERMS
            .iter()
            .zip(1..)
            .fold(TermValues::default(), |values, (term, number)| {
                values.with(term.id, f64::from(number))
            });
        let row = RankedPose {
            pose_terms: values,
            ..pose([1.0, 0.0, 0.0, 0.0], [0.0; 3])
        };
        let objects = PoseTable::new(&[row], false).objects([0]);
        let object = objects[0].as_object().unwrap();
        for (term, number) in POSE_TERMS.iter().zip(1..) {
            assert_eq!(object[term.id], number, "{}", term.id);
        }
        let record = serde_json::to_value(values).unwrap();
        let keys: Vec<&str> = POSE_TERMS.iter().map(|term| term.id).collect();
        assert_eq!(record.as_object().unwrap().len(), keys.len());
        let same = |key: &&str| record[*key].as_f64() == object[*key].as_f64();
        assert!(keys.iter().all(same), "{record}");
    }

    #[test]
    fn rows_as_objects_carry_types() {
        let table = PoseTable::new(&[pose([1.0, 0.0, 0.0, 0.0], [0.0; 3])], true);
        let objects = table.objects([0, 7]);
        assert_eq!(objects.len(), 1);
        assert_eq!(objects[0]["rank"], 1);
        assert_eq!(objects[0]["score"], 1.0 / 3.0);
        assert_eq!(objects[0]["refined"], true);
        assert_eq!(objects[0]["cluster"], Value::Null);
    }

    #[test]
    fn poses_read_back_bit_for_bit() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("poses.csv");
        let poses = [
            pose([0.1, 0.2, -0.3, 0.4], [1e6 + 0.1, -1.0 / 3.0, 5e-324]),
            pose([0.0, -1.0, 2.0, 3.0], [0.0; 3]),
        ];
        PoseTable::new(&poses, false).write(&path).unwrap();
        let read = PoseTable::read(&path).unwrap();
        for (row, expected) in read.rows().iter().zip(&poses) {
            assert_eq!(row.pose.translation, expected.pose.translation);
            // Normalising a unit quaternion again may move its last bit.
            assert!(row.pose.angle_to(&expected.pose) < 1e-15);
        }
        assert_eq!(
            read.rows().iter().map(|row| row.rank).collect::<Vec<_>>(),
            [1, 2]
        );
    }

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
        assert_eq!(
            text(&table),
            "note,tz,ty,tx,qz,qy,qx,qw,irmsd,rank,fnat\n\"a, b\",3,2,1,0,0,0,1,0.5,5,1\n"
        );
    }
}
