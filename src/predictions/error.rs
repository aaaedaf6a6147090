//! Why predictions cannot be used, where, and what to do about it.

use std::path::PathBuf;

use knotdock_structures::Error;

use crate::predictions::table::COLUMNS;
use crate::table_text::named_columns::{AtLine, TableFault};

/// Why predictions cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{fault}")]
pub struct PredictionError {
    /// The table; `None` for the molecule's own file.
    pub path: Option<PathBuf>,
    /// 1-based line, where one is at fault.
    pub line: Option<usize>,
    /// The fault.
    pub fault: Box<PredictionFault>,
}

impl From<PredictionError> for Error {
    fn from(error: PredictionError) -> Self {
        let refused = Self::input(&error)
            .on_line(error.line.map(|line| line as u64))
            .help(error.remedy());
        match error.path.as_deref() {
            Some(path) => refused.at(path),
            None => refused,
        }
    }
}

impl PredictionError {
    /// Remedy for the user.
    pub fn remedy(&self) -> String {
        self.fault.remedy()
    }
}

/// What is wrong with predictions.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PredictionFault {
    /// The file cannot be opened, is too large or no text.
    #[error("the predictions cannot be read: {0}")]
    Unreadable(String),
    /// The rows are no table with the columns of predictions.
    #[error(transparent)]
    Table(TableFault),
    /// Nothing but comments and blank lines, or no more than a header.
    #[error("there is no prediction in the file")]
    NoPrediction,
    /// A field that may not be empty is.
    #[error("the row has no {0}")]
    MissingField(&'static str),
    /// A number that is no probability.
    #[error("the probability is `{0}`; it must be a number from 0 to 1")]
    Probability(String),
    /// A field that names no residue.
    #[error("`{0}` does not name one residue")]
    ResidueSyntax(String),
    /// A residue that the molecule does not have.
    #[error("there is no residue {residue}; there are {present}")]
    UnknownResidue {
        /// As `A:57`.
        residue: String,
        /// The chains and numbers that there are, in words.
        present: String,
    },
    /// A residue that an earlier row has, too.
    #[error("residue {residue} has a prediction on line {first} already")]
    Repeated {
        /// As `A:57`.
        residue: String,
        /// 1-based line of that row.
        first: usize,
    },
    /// B values of amino acids outside the range of probabilities.
    #[error(
        "the B values of {outside} of {of} amino acids are no probabilities, which run from 0 to 1: {residues}; all \
         run from {low} to {high}"
    )]
    BValues {
        /// How many amino acids.
        outside: usize,
        /// The first of them, as `A:57`.
        residues: String,
        /// How many amino acids there are.
        of: usize,
        /// The smallest.
        low: f64,
        /// The largest.
        high: f64,
    },
    /// A molecule without amino acids, whose B values are asked for.
    #[error("there is no amino acid, and only those have predictions as B values")]
    NoAminoAcid,
    /// Predictions that say nothing.
    #[error("all residues have the same probability, which says nothing")]
    AllEqual,
}

impl PredictionFault {
    /// Remedy for the user.
    pub fn remedy(&self) -> String {
        match self {
            Self::Unreadable(_) | Self::Table(TableFault::Unreadable(_)) => {
                "give a CSV table in UTF-8, or bfactor for the B values of the molecule's own file".into()
            }
            Self::Table(TableFault::FieldCount { .. }) => TableFault::FIELD_COUNT_REMEDY.into(),
            Self::Table(_) | Self::NoPrediction => {
                format!("the first row names the columns, all of which are needed: {}", COLUMNS.join(", "))
            }
            Self::MissingField(_) | Self::ResidueSyntax(_) => {
                "give the chain and the number of one residue, as in A and 57 or 52A; a chain without a name is _".into()
            }
            Self::Probability(_) => "write a number such as 0.25; divide percentages by 100".into(),
            Self::UnknownResidue { .. } => {
                "leave out rows of residues that the file of the molecule lacks, and number as it does".into()
            }
            Self::Repeated { .. } => "leave out one of the two rows".into(),
            Self::BValues { .. } | Self::NoAminoAcid => {
                "give the predictions as a CSV table, or a file with probabilities as B values: those of crystals and \
                 the confidence of predicted models are no predictions of the interface"
                    .into()
            }
            Self::AllEqual => "give a probability for each residue, or leave the option out".into(),
        }
    }

    /// The fault of a whole file.
    pub(super) fn in_file(self) -> AtLine<Self> {
        AtLine {
            line: None,
            fault: self,
        }
    }
}

impl From<TableFault> for PredictionFault {
    fn from(fault: TableFault) -> Self {
        Self::Table(fault)
    }
}
