//! Files of balls: tables (CSV) and the sphere lists of robot descriptions (YAML, JSON).
//!
//! # Formats, by the ending of the name
//!
//! - **`.csv`**: one row per ball, columns `x,y,z,r` and perhaps `weight`, named by a header or in this order without one
//!   (`table`). `knotdock sample` writes such tables.
//! - **`.yml`, `.yaml`, `.json`**: any mapping with a `radius` and a `center` or `origin` of three numbers is a ball
//!   (`spheres`). This reads cuRobo's `collision_spheres` and foam's files. Balls are grouped by the link, or the
//!   level of detail above them.
//!
//! Lengths are in the file's unit. Errors carry the line.

mod spheres;
mod table;

use std::path::Path;

use crate::ball::{Ball, LARGEST_LENGTH};
use crate::error::Error;

/// Endings of files of balls, and how each is read.
const ENDINGS: [(&str, Format); 4] = [
    ("csv", Format::Table),
    ("yml", Format::Spheres),
    ("yaml", Format::Spheres),
    ("json", Format::Spheres),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Table,
    Spheres,
}

/// Balls of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BallFile {
    /// The balls.
    pub balls: Vec<Ball>,
    /// One weight per ball; `None` if the file gives none.
    pub weights: Option<Vec<f64>>,
    /// The link or level that was read, where the file has groups.
    pub group: Option<String>,
    /// Names of all groups of the file.
    pub groups: Vec<String>,
    /// Spheres left out because their radius is not above zero, by which cuRobo switches spheres off.
    pub switched_off: usize,
}

/// Whether a file is one of balls, by its name.
pub fn is_ball_file(path: &Path) -> bool {
    format_of(path).is_some()
}

fn format_of(path: &Path) -> Option<Format> {
    let ending = path.extension()?.to_string_lossy().to_ascii_lowercase();
    let known = ENDINGS.iter().find(|(name, _)| *name == ending);
    known.map(|(_, format)| *format)
}

/// Reads the bytes of a file of balls; of one with several groups the one named.
///
/// # Errors
/// Text that is no such file, a row or sphere that is no ball, a group that is not there, several groups of which none
/// is named, or a file without balls.
pub fn parse(path: &Path, bytes: &[u8], group: Option<&str>) -> Result<BallFile, Error> {
    read(path, bytes, group).map_err(|error| error.at(path))
}

fn read(path: &Path, bytes: &[u8], group: Option<&str>) -> Result<BallFile, Error> {
    let format = format_of(path).ok_or_else(|| {
        Error::input("the ending of the name is not that of a file of balls")
            .help("name it .csv, .yml, .yaml or .json")
    })?;
    let text = std::str::from_utf8(bytes)
        .map_err(|_| Error::input("the file is not text in UTF-8").help("save it as UTF-8 text"))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let file = match (format, group) {
        (Format::Table, Some(_)) => {
            return Err(Error::input("a table of balls has no links to pick")
                .help("leave out the colon and what follows it"));
        }
        (Format::Table, None) => table::read(text)?,
        (Format::Spheres, group) => spheres::read(text, group)?,
    };
    if file.balls.is_empty() {
        return Err(Error::input("there are no balls in the file")
            .help("give a table with columns x,y,z,r, or spheres with 'center' and 'radius'"));
    }
    Ok(file)
}

/// A number of at most [`LARGEST_LENGTH`].
fn number(text: &str) -> Option<f64> {
    let number = text.trim().parse::<f64>().ok();
    number.filter(|number| number.abs() <= LARGEST_LENGTH)
}

/// The number of a field, or its refusal.
fn number_of(what: &str, text: &str, line: u64) -> Result<f64, Error> {
    number(text).ok_or_else(|| {
        let text: String = text.trim().chars().take(40).collect();
        Error::input(format!(
            "{what} is '{text}', not a number from -1e30 to 1e30"
        ))
        .on_line(line)
        .help("correct the number")
    })
}

/// The refusal of a radius that is zero, negative or too small to compute with.
fn bad_radius(radius: f64, line: u64) -> Error {
    Error::input(format!(
        "the radius is {radius:?}; it must be 1e-30 or above"
    ))
    .on_line(line)
    .help("correct the number, or leave the ball out")
}

#[cfg(test)]
mod tests;
