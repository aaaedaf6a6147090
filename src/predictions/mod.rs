//! Interface predictions: how likely each residue of a molecule is in the interface, as some predictor says.
//!
//! They are read from a table (columns `chain`, `residue` and `probability`, in any order), or from the B values of the
//! molecule's own file, where predictors leave them. Residues without a prediction count as average.
//!
//! # Conventions
//!
//! Probabilities lie between 0 and 1. Log-odds are natural logarithms, ln(p / (1 - p)).

mod b_values;
mod error;
mod table;

pub use self::error::{PredictionError, PredictionFault};

use std::path::{Path, PathBuf};

use knotdock_scoring::terms::pose::PredictedResidue;
use knotdock_structures::molecule::Molecule;
use serde::{Deserialize, Serialize};

use crate::bounded_read::{MAX_TABLE, read_bounded_text};

/// The word in place of a file for the B values of the molecule's own file.
pub const B_VALUES: &str = "bfactor";

/// No predictor is surer than this.
const SUREST: f64 = 0.99;

/// Where predictions are read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PredictionSource {
    /// The B values of the molecule.
    #[serde(rename = "bfactor")]
    BValues,
    /// A table.
    #[serde(rename = "table")]
    Table {
        /// Name of the file.
        path: PathBuf,
        /// What it holds.
        text: String,
    },
}

/// A residue with its prediction: indices of its atoms, and a probability.
type Prediction = (Vec<usize>, f64);

impl PredictionSource {
    /// The source with a name: the B values, or a file, which is read.
    ///
    /// # Errors
    /// [`PredictionError`] where the file cannot be read, is too large or no text.
    pub fn read(name: &str) -> Result<Self, PredictionError> {
        let path = Path::new(name);
        // A file of options puts its folder before the word.
        if path.file_name().is_some_and(|word| word == B_VALUES) && !path.exists() {
            return Ok(Self::BValues);
        }
        let text = read_bounded_text(path, MAX_TABLE);
        let text = text.map_err(|error| PredictionError {
            path: Some(path.to_owned()),
            line: None,
            fault: Box::new(PredictionFault::Unreadable(error.to_string())),
        })?;
        Ok(Self::Table {
            path: path.to_owned(),
            text,
        })
    }

    /// The residues of a molecule with their log-odds less those of the mean.
    ///
    /// # Errors
    /// [`PredictionError`] where a residue is unknown, a number is no probability, or all are equal.
    pub fn residues(&self, molecule: &Molecule) -> Result<Vec<PredictedResidue>, PredictionError> {
        let (path, read) = match self {
            Self::BValues => (None, b_values::read(molecule)),
            Self::Table { path, text } => (Some(path.clone()), table::read(text, molecule)),
        };
        let read = read.and_then(|predictions| {
            log_odds(&predictions).ok_or_else(|| PredictionFault::AllEqual.in_file())
        });
        read.map_err(|at| PredictionError {
            path,
            line: at.line,
            fault: Box::new(at.fault),
        })
    }
}

impl std::fmt::Display for PredictionSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::BValues => f.write_str(B_VALUES),
            Self::Table { path, .. } => write!(f, "{}", path.display()),
        }
    }
}

/// Log-odds of probabilities less those of their mean; `None` where all are equal.
fn log_odds(predictions: &[Prediction]) -> Option<Vec<PredictedResidue>> {
    let logit = |p: f64| {
        let p = p.clamp(1.0 - SUREST, SUREST);
        (p / (1.0 - p)).ln()
    };
    let sum: f64 = predictions.iter().map(|(_, p)| p).sum();
    let mean = logit(sum / predictions.len() as f64);
    let (_, first) = predictions.first()?;
    if predictions.iter().all(|(_, p)| p == first) {
        return None;
    }
    let residues = predictions.iter().map(|(atoms, p)| PredictedResidue {
        atoms: atoms.clone(),
        log_odds: logit(*p) - mean,
    });
    Some(residues.collect())
}

/// Whether a number is a probability.
fn is_probability(p: f64) -> bool {
    (0.0..=1.0).contains(&p)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ln 9 and its negative about a mean of one half.
    #[test]
    fn log_odds_are_those_beyond_the_mean() {
        let residues = log_odds(&[(vec![0, 1], 0.9), (vec![2], 0.1)]).unwrap();
        assert_eq!(residues[0].atoms, [0, 1]);
        assert!((residues[0].log_odds - 9f64.ln()).abs() < 1e-12);
        assert!((residues[1].log_odds + 9f64.ln()).abs() < 1e-12);
        // Of 0.2 and 0.4 the mean is 0.3.
        let residues = log_odds(&[(vec![0], 0.2), (vec![1], 0.4)]).unwrap();
        assert!((residues[1].log_odds - (4.0f64 / 6.0 * 7.0 / 3.0).ln()).abs() < 1e-12);
        // Certainty has a limit.
        let residues = log_odds(&[(vec![0], 1.0), (vec![1], 0.0)]).unwrap();
        assert!((residues[0].log_odds - 99f64.ln()).abs() < 1e-9);
        assert!(log_odds(&[(vec![0], 0.3), (vec![1], 0.3)]).is_none());
        assert!(log_odds(&[]).is_none());
    }

    #[test]
    fn the_word_is_no_file() {
        assert_eq!(
            PredictionSource::read("bfactor"),
            Ok(PredictionSource::BValues)
        );
        let in_folder = PredictionSource::read("some/where/bfactor");
        assert_eq!(in_folder, Ok(PredictionSource::BValues));
        let error = PredictionSource::read("nowhere.csv").unwrap_err();
        assert_eq!(error.path.as_deref(), Some(Path::new("nowhere.csv")));
        assert!(
            error
                .to_string()
                .starts_with("the predictions cannot be read")
        );
    }
}
