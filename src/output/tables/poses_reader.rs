//! Reading `poses.csv`, and any table with its columns for the rank and the pose.

use std::path::Path;

use csv::StringRecord;
use knotdock_scoring::se3::Pose;
use knotdock_structures::{Error, LARGEST_LENGTH};

use crate::bounded_read::{MAX_POSES, read_bounded};
use crate::output::tables::poses::{PoseRow, PoseTable};
use crate::table_text::cells::unquoted_row;
use crate::table_text::named_columns::line_of;

/// A table that is no CSV, or a row with more or fewer fields than the header.
pub fn no_table(path: &Path, error: &csv::Error, line: Option<u64>) -> Error {
    Error::input(format!("{} is not a table: {error}", path.display()))
        .at(path)
        .on_line(line)
        .help("give the poses.csv of a run as `knotdock dock` wrote it")
}

/// A field that is not what its column holds.
pub(crate) fn no_value(path: &Path, line: u64, column: &str, field: &str, expected: &str) -> Error {
    Error::input(format!("`{field}` in column `{column}` is not {expected}"))
        .at(path)
        .on_line(line)
        .help("correct the field")
}

impl PoseTable {
    /// Reads a table, finding its columns by name; columns that are not needed are kept as they stand.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let bytes = read_bounded(path, MAX_POSES).map_err(|error| {
            Error::input(format!("cannot read {}: {error}", path.display()))
                .at(path)
                .help("give the directory of a run, or its poses.csv")
        })?;
        let line = |position: &csv::Position| line_of(&bytes, position, None);
        let malformed = |error: csv::Error| no_table(path, &error, error.position().map(line));
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let header = unquoted_row(reader.headers().map_err(malformed)?);
        let rank = column_place(path, &header, "rank")?;
        let placement = PlacementColumns::find(path, &header)?;
        let mut records = Vec::new();
        let mut rows = Vec::new();
        for record in reader.into_records() {
            let record = record.map_err(malformed)?;
            let line = record.position().map_or(0, line);
            let field = record.get(rank).unwrap_or("");
            let rank = field.parse::<usize>().ok().filter(|&rank| rank > 0);
            let rank = rank
                .ok_or_else(|| no_value(path, line, "rank", field, "a whole number above zero"))?;
            let pose = placement.pose(path, line, &record, || format!("rank {rank}"))?;
            rows.push(PoseRow { rank, pose });
            records.push(unquoted_row(&record));
        }
        Ok(Self {
            header,
            records,
            rows,
        })
    }
}

/// Columns that place the ligand, with their places in a header.
pub struct PlacementColumns {
    quaternion: [(&'static str, usize); 4],
    translation: [(&'static str, usize); 3],
}

impl PlacementColumns {
    /// The columns of a table without a header.
    pub const UNNAMED: Self = Self {
        quaternion: [("qw", 0), ("qx", 1), ("qy", 2), ("qz", 3)],
        translation: [("tx", 4), ("ty", 5), ("tz", 6)],
    };

    /// Finds the columns by their names.
    pub fn find(path: &Path, header: &StringRecord) -> Result<Self, Error> {
        let mut found = Self::UNNAMED;
        for (column, place) in found.quaternion.iter_mut().chain(&mut found.translation) {
            *place = column_place(path, header, column)?;
        }
        Ok(found)
    }

    /// The pose of a row, which `row_name` names.
    ///
    /// # Errors
    /// [`Error`] for fields that are no numbers, or for a quaternion whose length is not 1.
    pub fn pose(
        &self,
        path: &Path,
        line: u64,
        record: &StringRecord,
        row_name: impl FnOnce() -> String,
    ) -> Result<Pose, Error> {
        let float = |(column, place): (&'static str, usize)| {
            let field = record.get(place).unwrap_or("").trim();
            match field.parse::<f64>() {
                Ok(value) if value.abs() <= LARGEST_LENGTH => Ok(value),
                _ => {
                    let expected = "a number from -1e30 to 1e30";
                    Err(no_value(path, line, column, field, expected))
                }
            }
        };
        let [w, x, y, z] = self.quaternion;
        let quaternion = [float(w)?, float(x)?, float(y)?, float(z)?];
        let [x, y, z] = self.translation;
        let translation = [float(x)?, float(y)?, float(z)?];
        let squares = quaternion.iter().map(|part| part * part);
        let length = squares.sum::<f64>().sqrt();
        // Three digits per component keep the length within 1e-3; more is no rotation that was rounded.
        if (length - 1.0).abs() > 1e-3 {
            let row = row_name();
            let message = format!("the quaternion of {row} has length {length}; a rotation has 1");
            return Err(Error::input(message)
                .at(path)
                .on_line(line)
                .help("give unit quaternions with at least four digits"));
        }
        Ok(Pose::from_parts(quaternion, translation))
    }
}

/// Place of a column that a table needs.
pub(crate) fn column_place(
    path: &Path,
    header: &StringRecord,
    column: &str,
) -> Result<usize, Error> {
    let place = header.iter().position(|name| name == column);
    place.ok_or_else(|| {
        Error::input(format!("{} has no column `{column}`", path.display()))
            .at(path)
            .on_line(1)
            .help("the columns rank, qw, qx, qy, qz, tx, ty and tz are needed, in any order")
    })
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
            assert_eq!(error.file(), Some(path.as_path()));
        }
        std::fs::write(&path, "rank,qw,qx,qy,qz,tx,ty\n").unwrap();
        let error = PoseTable::read(&path).unwrap_err();
        assert!(error.message().contains("no column `tz`"), "{error}");
    }
}
