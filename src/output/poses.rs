//! `poses.csv`: one row a pose, best first (RFC 4180, but with LF as the line end).
//!
//! Columns are found by name, and later ones are appended after those of [`COLUMNS`]. Quaternions are Hamilton's, active,
//! right-handed, unit, `qw >= 0`; a ligand atom at x in its own file goes to R(q) x + t, in Å, in the receptor's file
//! frame. Numbers are in the shortest digits that read back to the same f64; a missing value is an empty field.

use std::io;
use std::path::{Path, PathBuf};

use csv::StringRecord;
use knotdock_scoring::se3::Pose;
use serde_json::Value;

use super::staging::{StagingError, write_whole};
use crate::search::outcome::RankedPose;

/// The columns that every run writes, in order.
pub const COLUMNS: [&str; 19] = [
    "rank",
    "score",
    "cluster",
    "cluster_size",
    "qw",
    "qx",
    "qy",
    "qz",
    "tx",
    "ty",
    "tz",
    "refined",
    "rotation",
    "score_grid",
    "score_unfiltered",
    "shape",
    "slice_0",
    "slice_r0",
    "slice_2r0",
];

/// A column to append: its name and one field a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name in the header.
    pub name: String,
    /// The fields, in the order of the rows.
    pub fields: Vec<String>,
}

/// A number as a field: the shortest digits that read back to the same f64, empty when it is not a finite number.
pub fn number(value: f64) -> String {
    if value.is_finite() {
        (value + 0.0).to_string() // + 0.0 prints a negative zero as 0
    } else {
        String::new()
    }
}

fn count(value: Option<usize>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

/// The fields of a pose under [`COLUMNS`].
fn fields(rank: usize, row: &RankedPose) -> [String; COLUMNS.len()] {
    let [qw, qx, qy, qz] = row.pose.quaternion();
    let translation = row.pose.translation;
    let [slice_0, slice_r0, slice_2r0] = row.slices;
    [
        rank.to_string(),
        number(row.score),
        count(row.cluster),
        count(row.cluster_size),
        number(qw),
        number(qx),
        number(qy),
        number(qz),
        number(translation.x),
        number(translation.y),
        number(translation.z),
        row.refined.to_string(),
        row.rotation.to_string(),
        number(row.score_grid),
        number(row.score_unfiltered),
        number(row.shape),
        number(slice_0),
        number(slice_r0),
        number(slice_2r0),
    ]
}

/// A table of poses as text, with the pose of each row made out: what `evaluate` and `complex` read.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseTable {
    header: StringRecord,
    records: Vec<StringRecord>,
    rows: Vec<PoseRow>,
}

/// What a row says of where the ligand goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseRow {
    /// 1-based rank.
    pub rank: usize,
    /// From the ligand's file frame to the receptor's.
    pub pose: Pose,
}

/// Why a table of poses cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum PoseTableError {
    /// The file cannot be opened.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is not CSV, or a row has more or fewer fields than the header.
    #[error("{} is not a table: {message}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// 1-based line, where known.
        line: Option<u64>,
        /// What is wrong.
        message: String,
    },
    /// A column that places the ligand is missing.
    #[error("{} has no column `{column}`", path.display())]
    MissingColumn {
        /// The file.
        path: PathBuf,
        /// The column.
        column: &'static str,
    },
    /// A field is not what its column holds.
    #[error("`{field}` in column `{column}` is not {expected}")]
    Field {
        /// The file.
        path: PathBuf,
        /// 1-based line.
        line: u64,
        /// The column.
        column: &'static str,
        /// The field as it stands.
        field: String,
        /// What it should be.
        expected: &'static str,
    },
    /// A quaternion is too far from unit length to be a rotation.
    #[error("the quaternion of rank {rank} has length {length}; a rotation has 1")]
    Quaternion {
        /// The file.
        path: PathBuf,
        /// 1-based line.
        line: u64,
        /// The row's rank.
        rank: usize,
        /// The quaternion's length.
        length: f64,
    },
}

impl PoseTableError {
    /// The file in question.
    pub fn path(&self) -> &Path {
        match self {
            Self::Open { path, .. }
            | Self::Csv { path, .. }
            | Self::MissingColumn { path, .. }
            | Self::Field { path, .. }
            | Self::Quaternion { path, .. } => path,
        }
    }

    /// The 1-based line in question, where there is one.
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::Open { .. } => None,
            Self::Csv { line, .. } => *line,
            Self::MissingColumn { .. } => Some(1),
            Self::Field { line, .. } | Self::Quaternion { line, .. } => Some(*line),
        }
    }

    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Open { .. } => "give the directory of a run, or its poses.csv",
            Self::Csv { .. } => "give the poses.csv of a run as `knotdock dock` wrote it",
            Self::MissingColumn { .. } => {
                "the columns rank, qw, qx, qy, qz, tx, ty and tz are needed, in any order"
            }
            Self::Field { .. } => "correct the field",
            Self::Quaternion { .. } => "give unit quaternions with at least four digits",
        }
    }
}

impl PoseTable {
    /// The table of a search's poses in the order given, ranked from 1.
    pub fn new(poses: &[RankedPose]) -> Self {
        let rows = poses.iter().enumerate().map(|(index, row)| PoseRow {
            rank: index + 1,
            pose: row.pose,
        });
        let records = poses.iter().enumerate();
        Self {
            header: StringRecord::from(COLUMNS.to_vec()),
            records: records
                .map(|(index, row)| StringRecord::from(fields(index + 1, row).to_vec()))
                .collect(),
            rows: rows.collect(),
        }
    }

    /// Reads a table, finding its columns by name; columns that are not needed are kept as they stand.
    ///
    /// # Errors
    /// [`PoseTableError`], with file and line.
    pub fn read(path: &Path) -> Result<Self, PoseTableError> {
        let bytes = std::fs::read(path).map_err(|source| PoseTableError::Open {
            path: path.to_owned(),
            source,
        })?;
        let malformed = |error: csv::Error| PoseTableError::Csv {
            path: path.to_owned(),
            line: error.position().map(csv::Position::line),
            message: error.to_string(),
        };
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let header = reader.headers().map_err(malformed)?.clone();
        let columns = PoseColumns::find(path, &header)?;
        let mut records = Vec::new();
        let mut rows = Vec::new();
        for record in reader.into_records() {
            let record = record.map_err(malformed)?;
            rows.push(columns.row(path, &record)?);
            records.push(record);
        }
        Ok(Self {
            header,
            records,
            rows,
        })
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
    /// [`StagingError`] when the file cannot be made or written.
    pub fn write(&self, path: &Path) -> Result<(), StagingError> {
        write_whole(path, |file| self.write_to(file))
    }

    /// Writes the table to a stream.
    ///
    /// # Errors
    /// Those of the stream.
    pub fn write_to(&self, stream: &mut dyn io::Write) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(stream);
        writer.write_record(&self.header)?;
        for record in &self.records {
            writer.write_record(record)?;
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

/// Where the columns that place the ligand stand in a header.
struct PoseColumns {
    rank: usize,
    quaternion: [(&'static str, usize); 4],
    translation: [(&'static str, usize); 3],
}

impl PoseColumns {
    fn find(path: &Path, header: &StringRecord) -> Result<Self, PoseTableError> {
        let place = |column: &'static str| {
            header
                .iter()
                .position(|name| name == column)
                .map(|place| (column, place))
                .ok_or_else(|| PoseTableError::MissingColumn {
                    path: path.to_owned(),
                    column,
                })
        };
        Ok(Self {
            rank: place("rank")?.1,
            quaternion: [place("qw")?, place("qx")?, place("qy")?, place("qz")?],
            translation: [place("tx")?, place("ty")?, place("tz")?],
        })
    }

    fn row(&self, path: &Path, record: &StringRecord) -> Result<PoseRow, PoseTableError> {
        let line = record.position().map_or(0, csv::Position::line);
        let fault = |column, field: &str, expected| PoseTableError::Field {
            path: path.to_owned(),
            line,
            column,
            field: field.to_owned(),
            expected,
        };
        let float = |(column, place): (&'static str, usize)| {
            let field = record.get(place).unwrap_or("");
            match field.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                _ => Err(fault(column, field, "a finite number")),
            }
        };
        let rank_field = record.get(self.rank).unwrap_or("");
        let rank = rank_field
            .parse::<usize>()
            .ok()
            .filter(|&rank| rank > 0)
            .ok_or_else(|| fault("rank", rank_field, "a whole number above zero"))?;
        let [w, x, y, z] = self.quaternion;
        let quaternion = [float(w)?, float(x)?, float(y)?, float(z)?];
        let [x, y, z] = self.translation;
        let translation = [float(x)?, float(y)?, float(z)?];
        let length = quaternion
            .iter()
            .map(|part| part * part)
            .sum::<f64>()
            .sqrt();
        // Three digits a component keep the length within 1e-3; more is no rotation that was rounded.
        if (length - 1.0).abs() > 1e-3 {
            return Err(PoseTableError::Quaternion {
                path: path.to_owned(),
                line,
                rank,
                length,
            });
        }
        Ok(PoseRow {
            rank,
            pose: Pose::from_parts(quaternion, translation),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(quaternion: [f64; 4], translation: [f64; 3]) -> RankedPose {
        RankedPose {
            pose: Pose::from_parts(quaternion, translation),
            score: 1.0 / 3.0,
            cluster: None,
            cluster_size: Some(4),
            refined: true,
            rotation: 17,
            score_grid: f64::NAN,
            score_unfiltered: 1e-7,
            shape: 0.1,
            slices: [-0.0, 2.0, 1e21],
        }
    }

    fn text(table: &PoseTable) -> String {
        let mut bytes = Vec::new();
        table.write_to(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn numbers_are_shortest_and_missing_ones_empty() {
        let table = PoseTable::new(&[pose([-0.5, 0.5, 0.5, -0.5], [1.5, -2.25, 0.1])]);
        assert_eq!(
            text(&table),
            "rank,score,cluster,cluster_size,qw,qx,qy,qz,tx,ty,tz,refined,rotation,score_grid,score_unfiltered,\
             shape,slice_0,slice_r0,slice_2r0\n\
             1,0.3333333333333333,,4,0.5,-0.5,-0.5,0.5,1.5,-2.25,0.1,true,17,,0.0000001,0.1,0,2,\
             1000000000000000000000\n"
        );
    }

    #[test]
    fn rows_as_objects_carry_types() {
        let table = PoseTable::new(&[pose([1.0, 0.0, 0.0, 0.0], [0.0; 3])]);
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
        PoseTable::new(&poses).write(&path).unwrap();
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

    #[test]
    fn faults_name_file_and_line() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("poses.csv");
        let header = "rank,qw,qx,qy,qz,tx,ty,tz\n1,1,0,0,0,0,0,0\n";
        for (rows, line) in [
            ("2,1,0,0,0,0,0,nan\n", 3),
            ("x,1,0,0,0,0,0,0\n", 3),
            ("2,0,0,0,0,0,0,0\n", 3),
            ("2,1,0,0\n", 3),
        ] {
            std::fs::write(&path, format!("{header}{rows}")).unwrap();
            let error = PoseTable::read(&path).unwrap_err();
            assert_eq!(error.line(), Some(line), "{error}");
            assert_eq!(error.path(), path);
        }
        std::fs::write(&path, "rank,qw,qx,qy,qz,tx,ty\n").unwrap();
        assert!(matches!(
            PoseTable::read(&path),
            Err(PoseTableError::MissingColumn { column: "tz", .. })
        ));
    }
}
