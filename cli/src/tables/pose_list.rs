//! Lists of poses: any CSV table with columns qw, qx, qy, qz, tx, ty and tz, or of seven numbers a row without a header.
//!
//! A `poses.csv` of a run is one. Columns that are not needed are passed over.

use knotdock_structures::Error;
use std::path::Path;

use knotdock_scoring::se3::Pose;

use knotdock::output::files::whole_file::StagedFile;
use knotdock::output::tables::poses_reader::{PlacementColumns, no_table};
use knotdock::table_text::cells::unquoted_row;
use knotdock::table_text::named_columns::line_of;

/// A byte that begins a remark.
const COMMENT: Option<u8> = Some(b'#');

/// Remedy for a table that is no list of poses.
const COLUMNS_NEEDED: &str = "give columns qw, qx, qy, qz, tx, ty and tz";

/// Reads the text of a list; `path` is its name in errors.
///
/// # Errors
/// [`Error`], with file and line. A table without a row is no error.
pub fn read_list(path: &Path, text: &[u8]) -> Result<Vec<Pose>, Error> {
    let line = |position: &csv::Position| line_of(text, position, COMMENT);
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .comment(COMMENT)
        .trim(csv::Trim::All)
        .from_reader(text);
    let mut columns: Option<PlacementColumns> = None;
    let mut poses = Vec::new();
    let mut record = csv::StringRecord::new();
    loop {
        let read = reader.read_record(&mut record);
        let read = read.map_err(|error| {
            no_table(path, &error, error.position().map(line)).help(COLUMNS_NEEDED)
        })?;
        if !read {
            return Ok(poses);
        }
        let at = || record.position().map_or(0, line);
        let placed = match &columns {
            Some(placed) => placed,
            None if record.len() == 7
                && record.iter().all(|field| field.parse::<f64>().is_ok()) =>
            {
                columns.insert(PlacementColumns::UNNAMED)
            }
            None => {
                let found = PlacementColumns::find(path, &unquoted_row(&record));
                columns = Some(found.map_err(|error| error.help(COLUMNS_NEEDED))?);
                continue;
            }
        };
        let of = || format!("pose {}", poses.len() + 1);
        let pose = placed.pose(path, at(), &record, of)?;
        poses.push(pose);
    }
}

/// Writes a list, with a header; numbers read back to the same double.
///
/// # Errors
/// [`Error`] when the file cannot be made or written.
pub fn write_list(path: &Path, poses: &[Pose]) -> Result<StagedFile, Error> {
    StagedFile::write(path, |file| {
        writeln!(file, "qw,qx,qy,qz,tx,ty,tz")?;
        for pose in poses {
            let ([w, i, j, k], t) = (pose.quaternion(), pose.translation);
            writeln!(
                file,
                "{w:?},{i:?},{j:?},{k:?},{:?},{:?},{:?}",
                t.x, t.y, t.z
            )?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Pose>, Error> {
        read_list(Path::new("poses.csv"), text.as_bytes())
    }

    #[test]
    fn with_and_without_a_header() {
        let expected = [
            Pose::from_parts([1.0, 0.0, 0.0, 0.0], [1.0, 2.0, 3.0]),
            Pose::from_parts([0.0, 1.0, 0.0, 0.0], [-1.0, 0.5, 1e6]),
        ];
        for text in [
            "qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,1,2,3\n0,1,0,0,-1,0.5,1e6\n",
            "# a remark\n1,0,0,0,1,2,3\n\n0, 1, 0, 0, -1, 0.5, 1e6",
            "rank,score,tz,ty,tx,qz,qy,qx,qw\n1,9,3,2,1,0,0,0,1\n2,8,1e6,0.5,-1,0,0,1,0\n",
        ] {
            assert_eq!(read(text).unwrap(), expected, "{text}");
        }
        assert!(read("").unwrap().is_empty());
        assert!(read("qw,qx,qy,qz,tx,ty,tz\n").unwrap().is_empty());
    }

    #[test]
    fn faults_name_their_line() {
        for (text, line) in [
            ("1,0,0,0,1,2,3\n1,0,0,0,1,2\n", 2),
            ("1,0,0,0,1,2,3\n\n# no\n1,0,0,0,1,2,inf\n", 4),
            ("qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,1,2,\n", 2),
            ("1,1,0,0,1,2,3\n", 1),
            ("1,0,0,0,1,2\n", 1),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.line(), Some(line), "{error}");
            assert!(error.remedy().is_some());
        }
    }
}
