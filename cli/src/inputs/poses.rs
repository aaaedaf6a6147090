//! Poses named on the command line: one as seven numbers, or a table of many.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use clap::Args;

use knotdock::bounded_read::{MAX_POSES, read_bounded};
use knotdock::output::files::whole_file::StagedFile;
use knotdock::output::tables::poses_reader::{PlacementColumns, no_table};
use knotdock::table_text::cells::unquoted_row;
use knotdock::table_text::named_columns::line_of;
use knotdock_scoring::se3::Pose;
use knotdock_structures::{Error, LARGEST_LENGTH};

/// How far from 1 the length of a quaternion may be: what digits left off explain.
const UNIT_LENGTH: f64 = 1e-3;

/// Poses of the moved solid.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Poses")]
pub struct PoseArguments {
    /// One pose: a unit quaternion and a translation. A point at x goes to R x + t [default: as the files stand].
    #[arg(
        long,
        value_name = "QW,QX,QY,QZ,TX,TY,TZ",
        allow_hyphen_values = true,
        conflicts_with = "poses"
    )]
    pub pose: Option<String>,
    /// Many poses: a CSV file with columns qw, qx, qy, qz, tx, ty, tz, such as a poses.csv, or - for standard input.
    #[arg(long, value_name = "FILE")]
    pub poses: Option<PathBuf>,
}

impl PoseArguments {
    /// The poses, and the file that they came from. Neither option means the one pose of the files as they stand.
    pub fn read(&self) -> Result<Vec<Pose>, Error> {
        match (&self.pose, &self.poses) {
            (Some(text), _) => Ok(vec![pose(text)?]),
            (None, Some(path)) => pose_file(path),
            (None, None) => Ok(vec![Pose::identity()]),
        }
    }

    /// The file that is read, if any.
    pub fn file(&self) -> Option<&Path> {
        let file = self.poses.as_deref();
        file.filter(|path| *path != Path::new("-"))
    }
}

/// The poses of a file, at least one; `-` is standard input.
pub fn pose_file(path: &Path) -> Result<Vec<Pose>, Error> {
    let is_standard = path == Path::new("-");
    let name = if is_standard {
        Path::new("standard input")
    } else {
        path
    };
    let text = if is_standard {
        standard_input()
    } else {
        read_bounded(path, MAX_POSES)
    };
    let text = text.map_err(|error| {
        Error::input(format!("cannot read the poses: {error}"))
            .at(name)
            .help("check the name and the permissions of the file")
    })?;
    let poses = read_list(name, &text)?;
    if poses.is_empty() {
        return Err(Error::input("there are no poses in the file")
            .at(name)
            .help("give a row of qw,qx,qy,qz,tx,ty,tz for each pose"));
    }
    Ok(poses)
}

/// Most bytes of standard input.
const MAX_STANDARD_INPUT: u64 = 1 << 30;

fn standard_input() -> io::Result<Vec<u8>> {
    let mut text = Vec::new();
    io::stdin()
        .lock()
        .take(MAX_STANDARD_INPUT + 1)
        .read_to_end(&mut text)?;
    if text.len() as u64 > MAX_STANDARD_INPUT {
        return Err(io::ErrorKind::FileTooLarge.into());
    }
    Ok(text)
}

/// A rotation from four numbers, as a pose without translation.
pub fn rotation(text: &str) -> Result<Pose, Error> {
    let parts = text.split(',').count();
    if parts != 4 {
        return Err(
            Error::input(format!("--rotation has {parts} numbers, not four"))
                .help("give a unit quaternion, the scalar part first: qw,qx,qy,qz"),
        );
    }
    pose(&format!("{text},0,0,0"))
}

/// A pose from seven numbers.
pub fn pose(text: &str) -> Result<Pose, Error> {
    let refused = |message: String, remedy: &str| Error::input(message).help(remedy);
    let numbers = text.split(',').map(|part| {
        let number = part.trim().parse::<f64>().ok();
        let number = number.filter(|number| number.abs() <= LARGEST_LENGTH);
        number.ok_or_else(|| {
            refused(
                format!(
                    "--pose: '{}' is not a number from -1e30 to 1e30",
                    part.trim()
                ),
                "give seven numbers, qw,qx,qy,qz,tx,ty,tz, with commas between them",
            )
        })
    });
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
    let [qw, qx, qy, qz, tx, ty, tz] = numbers[..] else {
        return Err(refused(
            format!("--pose has {} numbers, not seven", numbers.len()),
            "give a unit quaternion and a translation: qw,qx,qy,qz,tx,ty,tz",
        ));
    };
    let length = [qw, qx, qy, qz]
        .iter()
        .fold(0.0f64, |length, part| length.hypot(*part));
    if (length - 1.0).abs() > UNIT_LENGTH {
        return Err(refused(
            format!(
                "--pose: the quaternion has length {length}; a rotation has length 1, to within {UNIT_LENGTH}"
            ),
            "divide qw, qx, qy and qz by their length, and check that the scalar part comes first",
        ));
    }
    Ok(Pose::from_parts([qw, qx, qy, qz], [tx, ty, tz]))
}

/// A byte that begins a remark.
const COMMENT: Option<u8> = Some(b'#');

/// Remedy for a table that is no list of poses.
const COLUMNS_NEEDED: &str = "give columns qw, qx, qy, qz, tx, ty and tz";

/// Reads the text of a list; `path` is its name in errors.
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

    #[test]
    fn poses_are_normalised_when_they_nearly_are() {
        let found = pose("1.0005, 0,0,0, -1,2.5,3e1").unwrap();
        assert_eq!(
            found,
            Pose::from_parts([1.0, 0.0, 0.0, 0.0], [-1.0, 2.5, 30.0])
        );
        for text in [
            "1,0,0,0,0,0",
            "1,0,0,0,0,0,0,0",
            "",
            "1,0,0,0,0,0,nan",
            "1,0,0,0,0,inf,0",
            "1,0,0,0,0,,0",
            "1.002,0,0,0,0,0,0",
            "0,0,0,0,0,0,0",
            "1e300,1e300,0,0,0,0,0",
            "1,0,0,0,1e31,0,0",
        ] {
            let failure = pose(text).unwrap_err();
            assert_eq!(failure.exit_code(), 2, "{text}");
            assert!(failure.remedy().is_some(), "{text}");
        }
    }

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
