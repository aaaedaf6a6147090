//! `poses.csv` of a run: rows are made as they are written, so that a table of many poses is never held as text.

use std::io;

use csv::StringRecord;
use serde_json::Value;

use crate::output::tables::fields::Column;
use crate::output::tables::pose_columns::{PoseColumn, columns};
use crate::output::tables::poses::{PoseRow, PoseTable, row_object};
use crate::rank::ranking::RankedPose;
use crate::table_text::cells::TableWriter;

/// The table of a search's poses in the order given, ranked from 1.
pub struct RunTable<'a> {
    poses: &'a [RankedPose],
    columns: Vec<PoseColumn>,
    further: &'a [Column],
}

impl<'a> RunTable<'a> {
    /// The table of some poses: with columns of sharp fits if these were made, with columns for diagnosis if requested, and
    /// further columns after them. A row for which a further column has no field gets an empty one.
    pub fn new(poses: &'a [RankedPose], choice: (bool, bool), further: &'a [Column]) -> Self {
        Self {
            poses,
            columns: columns(choice, |term| {
                let has = |pose: &RankedPose| pose.pose_terms.get(term.id).is_some();
                term.is_shown_always || poses.iter().any(has)
            }),
            further,
        }
    }

    /// The table with the columns that any run may have, so that tables of several runs can follow one another.
    pub fn wide(poses: &'a [RankedPose], further: &'a [Column]) -> Self {
        Self {
            poses,
            columns: columns((true, false), |_| true),
            further,
        }
    }

    /// Its rows without their names.
    pub fn records(&self) -> impl Iterator<Item = StringRecord> + '_ {
        let poses = self.poses.iter().enumerate();
        poses.map(|(index, pose)| self.record(index, pose))
    }

    /// Names of the columns.
    pub fn header(&self) -> StringRecord {
        let own = self.columns.iter().map(|column| column.name);
        let further = self.further.iter().map(|column| column.name.as_str());
        std::iter::once("rank").chain(own).chain(further).collect()
    }

    /// The row of a pose.
    fn record(&self, index: usize, pose: &RankedPose) -> StringRecord {
        let mut record = StringRecord::new();
        record.push_field(&(index + 1).to_string());
        for column in &self.columns {
            record.push_field(&(column.field)(pose));
        }
        for column in self.further {
            record.push_field(column.fields.get(index).map_or("", String::as_str));
        }
        record
    }

    /// The first `count` rows as they would be read from the file.
    pub fn first(&self, count: usize) -> PoseTable {
        let poses = self.poses.get(..count).unwrap_or(self.poses);
        PoseTable {
            header: self.header(),
            records: self.records().take(count).collect(),
            rows: pose_rows(poses),
        }
    }

    /// Rows as JSON objects with the columns' names, as those of a table that is read have. Indices past the end are
    /// skipped.
    pub fn objects(&self, indices: impl IntoIterator<Item = usize>) -> Vec<Value> {
        let header = self.header();
        let poses = indices.into_iter();
        let poses = poses.filter_map(|index| Some((index, self.poses.get(index)?)));
        let objects = poses.map(|(index, pose)| row_object(&header, &self.record(index, pose)));
        objects.collect()
    }

    /// Writes the table to a stream.
    pub fn write_to(&self, stream: &mut dyn io::Write) -> io::Result<()> {
        let mut table = TableWriter::new(stream);
        table.row(&self.header())?;
        for record in self.records() {
            table.row(&record)?;
        }
        table.flush()
    }
}

/// Rank and pose of each row of a search's poses.
pub fn pose_rows(poses: &[RankedPose]) -> Vec<PoseRow> {
    let row = |(index, row): (usize, &RankedPose)| PoseRow {
        rank: index + 1,
        pose: row.pose,
    };
    poses.iter().enumerate().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tables::poses::PoseTable;
    use knotdock_scoring::exact::ShapeParts;
    use knotdock_scoring::se3::Pose;
    use knotdock_scoring::terms::pose::{POSE_TERMS, TermValues};

    fn pose(quaternion: [f64; 4], translation: [f64; 3]) -> RankedPose {
        RankedPose {
            pose: Pose::from_parts(quaternion, translation),
            score: 1.0 / 3.0,
            search_score: Some(0.25),
            cluster: None,
            cluster_size: Some(4),
            cluster_score: None,
            refined: true,
            sharp: None,
            rotation: 17,
            score_grid: f64::NAN,
            terms: [Some(0.1), None, Some(-3.0), None],
            shape: Some(ShapeParts {
                slices: [-0.0, 2.0, 1e21],
                unfiltered: 1e-7,
            }),
            pose_terms: TermValues::default()
                .with("atom_pair", -7.0)
                .with("relaxed", 2.5),
            other_copies: None,
            pose_score: Some(1.0 / 3.0),
            z_score: Some(2.5),
        }
    }

    fn text(table: &RunTable) -> String {
        let mut bytes = Vec::new();
        table.write_to(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn numbers_are_shortest_and_missing_ones_empty() {
        let poses = [pose([-0.5, 0.5, 0.5, -0.5], [1.5, -2.25, 0.1])];
        let table = RunTable::new(&poses, (false, true), &[]);
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
        let objects = RunTable::new(&[row], (false, false), &[]).objects([0]);
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
        let poses = [pose([1.0, 0.0, 0.0, 0.0], [0.0; 3])];
        let table = RunTable::new(&poses, (false, true), &[]);
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
        let mut file = std::fs::File::create(&path).unwrap();
        RunTable::new(&poses, (false, false), &[])
            .write_to(&mut file)
            .unwrap();
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
}
