//! What can be wrong with a file of balls.

use std::path::PathBuf;

/// Why a file of balls was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{kind}")]
pub struct BallFileError {
    /// The file.
    pub path: PathBuf,
    /// Line at fault, from 1.
    pub line: Option<usize>,
    /// What is wrong.
    pub kind: BallFileErrorKind,
}

/// What is wrong with a file of balls.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BallFileErrorKind {
    /// The name ends in no known way.
    #[error("the ending of the name is not that of a file of balls")]
    Ending,
    /// The bytes are no text.
    #[error("the file is not text in UTF-8")]
    NotText,
    /// There is no ball in it.
    #[error("there are no balls in the file")]
    Empty,
    /// The header lacks a column.
    #[error("the header has no column '{0}'")]
    Column(&'static str),
    /// A row has another number of fields than the first.
    #[error("the row has {found} fields, not {expected}")]
    Fields {
        /// Fields of the row.
        found: usize,
        /// Fields of the first row.
        expected: usize,
    },
    /// A field is no number.
    #[error("{what} is '{value}', not a number from -1e30 to 1e30")]
    Number {
        /// Name of the field.
        what: &'static str,
        /// Its text, cut short.
        value: String,
    },
    /// A radius is zero, negative or too small to compute with.
    #[error("the radius is {0:?}; it must be 1e-30 or above")]
    Radius(f64),
    /// A weight is negative.
    #[error("the weight is {0}; it must not be negative")]
    Weight(f64),
    /// A sphere has no centre of three numbers.
    #[error("the sphere has a radius, but no 'center' or 'origin' of three numbers")]
    Center,
    /// The document is no YAML or JSON.
    #[error("the file is neither YAML nor JSON: {0}")]
    Syntax(String),
    /// The document is nested too deeply.
    #[error("the document is nested more than {0} levels deep")]
    Deep(usize),
    /// Tables have no groups.
    #[error("a table of balls has no links to pick")]
    NoGroups,
    /// There is no such group.
    #[error("there is no link '{name}' with spheres; there are {known}")]
    Unknown {
        /// The group requested.
        name: String,
        /// Those that are there.
        known: String,
    },
    /// Several groups, and none was named.
    #[error("the file has the spheres of several links, each in its own frame: {0}")]
    Several(String),
}

impl BallFileError {
    /// Remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match self.kind {
            BallFileErrorKind::Ending => "name it .csv, .yml, .yaml or .json",
            BallFileErrorKind::NotText => "save it as UTF-8 text",
            BallFileErrorKind::Empty => {
                "give a table with columns x,y,z,r, or spheres with 'center' and 'radius'"
            }
            BallFileErrorKind::Column(_) => {
                "name the columns x,y,z,r and perhaps weight, or leave the header out"
            }
            BallFileErrorKind::Fields { .. } => "give each row x,y,z,r and perhaps a weight",
            BallFileErrorKind::Number { .. } => "correct the number",
            BallFileErrorKind::Radius(_) | BallFileErrorKind::Weight(_) => {
                "correct the number, or leave the ball out"
            }
            BallFileErrorKind::Center => "add 'center: [x, y, z]', or remove the sphere",
            BallFileErrorKind::Syntax(_) => "correct the syntax at this line",
            BallFileErrorKind::Deep(_) => "keep to the lists of spheres",
            BallFileErrorKind::NoGroups => "leave out the colon and what follows it",
            BallFileErrorKind::Unknown { .. } | BallFileErrorKind::Several(_) => {
                "name one of them after a colon, as in robot.yml:hand"
            }
        }
    }
}

/// A kind with the line, before the path is known.
pub(super) struct Fault {
    pub kind: BallFileErrorKind,
    pub line: Option<usize>,
}

impl From<BallFileErrorKind> for Fault {
    fn from(kind: BallFileErrorKind) -> Self {
        Self { kind, line: None }
    }
}

impl BallFileErrorKind {
    pub(super) fn at(self, line: usize) -> Fault {
        Fault {
            kind: self,
            line: Some(line),
        }
    }

    /// A field that is no number.
    pub(super) fn number(what: &'static str, value: &str) -> Self {
        let value = value.trim().chars().take(40).collect();
        Self::Number { what, value }
    }
}

impl From<BallFileError> for crate::Error {
    fn from(error: BallFileError) -> Self {
        let line = error.line.and_then(|line| u64::try_from(line).ok());
        let refused = Self::input(&error).on_line(line).help(error.remedy());
        match Some(error.path.as_path()) {
            Some(file) => refused.at(file),
            None => refused,
        }
    }
}
