//! A membrane in which one molecule lies, and which the other is to stay out of.

use std::fmt;
use std::str::FromStr;

use knotdock_scoring::terms::pose::Membrane;
use knotdock_structures::molecule::Molecule;
use serde::{Deserialize, Serialize};

use knotdock_structures::Error;

/// Where a membrane lies: between two planes across the z axis of one molecule's file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum MembraneChoice {
    /// Between the planes that a molecule's file marks: that of the receptor (0) or of the ligand (1).
    Marked(usize),
    /// Between two z of the receptor's file, in Å, the lower one first.
    Between(f64, f64),
}

/// Names of the sides.
const SIDES: [&str; 2] = ["receptor", "ligand"];

/// A text that says of no membrane where it lies.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "receptor or ligand, whose file has the planes (OPM, PPM), or the lowest and highest z in Å of the receptor's \
     file, such as -15,15"
)]
pub struct MembraneError;

impl MembraneChoice {
    /// The membrane of two molecules.
    ///
    /// # Errors
    /// [`Error`] where the file that should mark its planes does not.
    pub(crate) fn of(self, molecules: [&Molecule; 2]) -> Result<Membrane, Error> {
        match self {
            Self::Between(low, high) => Ok(Membrane { side: 0, low, high }),
            Self::Marked(side) => match molecules[side].report.membrane {
                Some([low, high]) => Ok(Membrane { side, low, high }),
                None => Err(Error::input(format!(
                    "the file of the {} marks no flat membrane across its z axis",
                    SIDES[side]
                ))
                .help(
                    "give a file of OPM or PPM, which has two planes of DUM records, or the lowest and highest z in Å \
                     as in --membrane=-15,15",
                )),
            },
        }
    }
}

impl FromStr for MembraneChoice {
    type Err = MembraneError;

    fn from_str(text: &str) -> Result<Self, MembraneError> {
        if let Some(side) = SIDES.iter().position(|side| *side == text) {
            return Ok(Self::Marked(side));
        }
        let z = |text: &str| {
            let number = text.trim().parse::<f64>().ok();
            number.filter(|z| z.abs() <= 1e6)
        };
        let (low, high) = text.split_once(',').ok_or(MembraneError)?;
        match (z(low), z(high)) {
            (Some(low), Some(high)) if low < high => Ok(Self::Between(low, high)),
            _ => Err(MembraneError),
        }
    }
}

impl fmt::Display for MembraneChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Marked(side) => f.write_str(SIDES[*side]),
            Self::Between(low, high) => write!(f, "{low},{high}"),
        }
    }
}

impl TryFrom<String> for MembraneChoice {
    type Error = MembraneError;

    fn try_from(text: String) -> Result<Self, MembraneError> {
        text.parse()
    }
}

impl From<MembraneChoice> for String {
    fn from(choice: MembraneChoice) -> Self {
        choice.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn membranes_are_read_as_they_are_written() {
        for text in ["receptor", "ligand", "-15.5,15", "0,30"] {
            let choice: MembraneChoice = text.parse().unwrap();
            assert_eq!(choice.to_string(), text);
        }
        assert_eq!("-1, 2".parse(), Ok(MembraneChoice::Between(-1.0, 2.0)));
        for text in ["", "both", "15,-15", "3,3", "3", "nan,3", "0,inf", "1,2,3"] {
            assert_eq!(text.parse::<MembraneChoice>(), Err(MembraneError), "{text}");
        }
    }
}
