//! Reading `poses.csv`, and any table with its columns for the rank and the pose.

use knotdock_structures::Error;
use std::io;
use std::path::{Path, PathBuf};

use csv::StringRecord;
use knotdock_scoring::se3::Pose;
use knotdock_structures::LARGEST_LENGTH;

use crate::bounded_read::{MAX_POSES, read_bounded};
use crate::output::tables::poses::{PoseRow, PoseTable};
use crate::table_text::cells::unquoted_row;
use crate::table_text::csv_lines::line_of;

/// Why a table of poses cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum PoseTableError {
    /// The file cannot be opened.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's message.
        source: io::Error,
    },
    /// The file is not CSV, or a row has more or fewer fields than the header.
    #[error("{} is not a table: {message}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// 1-based line, where known.
        line: Option<u64>,
        /// The fault, in words.
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
    #[error("the quaternion of {of} has length {length}; a rotation has 1")]
    Quaternion {
        /// The file.
        path: PathBuf,
        /// 1-based line.
        line: u64,
        /// The row: its rank or number.
        of: String,
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

    /// Remedy for the user.
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
    /// Reads a table, finding its columns by name; columns that are not needed are kept as they stand.
    ///
    /// # Errors
    /// [`PoseTableError`], with file and line.
    pub fn read(path: &Path) -> Result<Self, PoseTableError> {
        let bytes = read_bounded(path, MAX_POSES).map_err(|source| PoseTableError::Open {
            path: path.to_owned(),
            source,
        })?;
        let line = |position: &csv::Position| line_of(&bytes, position, None);
        let malformed = |error: csv::Error| PoseTableError::Csv {
            path: path.to_owned(),
            line: error.position().map(line),
            message: error.to_string(),
        };
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let header = unquoted_row(reader.headers().map_err(malformed)?);
        let columns = PoseColumns::find(path, &header)?;
        let mut records = Vec::new();
        let mut rows = Vec::new();
        for record in reader.into_records() {
            let record = record.map_err(malformed)?;
            let line = record.position().map_or(0, line);
            rows.push(columns.row(path, line, &record)?);
            records.push(unquoted_row(&record));
        }
        Ok(Self {
            header,
            records,
            rows,
        })
    }
}

/// Where the columns of a table of poses stand in a header.
struct PoseColumns {
    rank: usize,
    placement: PlacementColumns,
}

impl PoseColumns {
    fn find(path: &Path, header: &StringRecord) -> Result<Self, PoseTableError> {
        Ok(Self {
            rank: place_of(path, header, "rank")?,
            placement: PlacementColumns::find(path, header)?,
        })
    }

    fn row(
        &self,
        path: &Path,
        line: u64,
        record: &StringRecord,
    ) -> Result<PoseRow, PoseTableError> {
        let field = record.get(self.rank).unwrap_or("");
        let rank = field.parse::<usize>().ok().filter(|&rank| rank > 0);
        let rank = rank.ok_or_else(|| PoseTableError::Field {
            path: path.to_owned(),
            line,
            column: "rank",
            field: field.to_owned(),
            expected: "a whole number above zero",
        })?;
        let of = || format!("rank {rank}");
        let pose = self.placement.pose(path, line, record, of)?;
        Ok(PoseRow { rank, pose })
    }
}

/// Where the columns that place the ligand stand in a header.
pub struct PlacementColumns {
    quaternion: [(&'static str, usize); 4],
    translation: [(&'static str, usize); 3],
}

impl PlacementColumns {
    /// The columns in the order in which they stand without a header.
    pub const UNNAMED: Self = Self {
        quaternion: [("qw", 0), ("qx", 1), ("qy", 2), ("qz", 3)],
        translation: [("tx", 4), ("ty", 5), ("tz", 6)],
    };

    /// Finds the columns by their names.
    ///
    /// # Errors
    /// [`PoseTableError`] for a column that is missing.
    pub fn find(path: &Path, header: &StringRecord) -> Result<Self, PoseTableError> {
        let mut found = Self::UNNAMED;
        for (column, place) in found.quaternion.iter_mut().chain(&mut found.translation) {
            *place = place_of(path, header, column)?;
        }
        Ok(found)
    }

    /// The pose of a row, which `of` names.
    pub fn pose(
        &self,
        path: &Path,
        line: u64,
        record: &StringRecord,
        of: impl FnOnce() -> String,
    ) -> Result<Pose, PoseTableError> {
        let float = |(column, place): (&'static str, usize)| {
            let field = record.get(place).unwrap_or("").trim();
            match field.parse::<f64>() {
                Ok(value) if value.abs() <= LARGEST_LENGTH => Ok(value),
                _ => Err(PoseTableError::Field {
                    path: path.to_owned(),
                    line,
                    column,
                    field: field.to_owned(),
                    expected: "a number from -1e30 to 1e30",
                }),
            }
        };
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
                of: of(),
                length,
            });
        }
        Ok(Pose::from_parts(quaternion, translation))
    }
}

fn place_of(
    path: &Path,
    header: &StringRecord,
    column: &'static str,
) -> Result<usize, PoseTableError> {
    let place = header.iter().position(|name| name == column);
    place.ok_or_else(|| PoseTableError::MissingColumn {
        path: path.to_owned(),
        column,
    })
}

impl From<PoseTableError> for Error {
    fn from(error: PoseTableError) -> Self {
        Self::input(&error)
            .at(error.path())
            .on_line(error.line())
            .help(error.remedy())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            ("\n\n2,1,0,0,0,0,0,nan\n", 5),
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
