//! A membrane around one molecule, which the other is to stay out of.

use knotdock_scoring::terms::pose::Membrane;
use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;
use serde::{Deserialize, Serialize};

/// Place of a membrane: between two planes across the z axis of one molecule's file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum MembraneChoice {
    /// Between the planes that the file of the receptor (0) or of the ligand (1) marks.
    Marked(usize),
    /// Between two z of the receptor's file, in Å, the lower one first.
    Between(f64, f64),
}

/// Names of the sides.
const SIDES: [&str; 2] = ["receptor", "ligand"];

/// The forms of its text.
const FORMS: &str = "receptor or ligand, whose file has the planes (OPM, PPM), or the lowest and highest z in Å of the \
    receptor's file, such as -15,15";

impl MembraneChoice {
    /// The membrane of two molecules.
    ///
    /// # Errors
    /// [`Error`] if the file that should mark its planes does not.
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

impl TryFrom<String> for MembraneChoice {
    type Error = &'static str;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        if let Some(side) = SIDES.iter().position(|side| *side == text) {
            return Ok(Self::Marked(side));
        }
        let z = |text: &str| {
            let number = text.trim().parse::<f64>().ok();
            number.filter(|z| z.abs() <= 1e6)
        };
        let (low, high) = text.split_once(',').ok_or(FORMS)?;
        match (z(low), z(high)) {
            (Some(low), Some(high)) if low < high => Ok(Self::Between(low, high)),
            _ => Err(FORMS),
        }
    }
}

impl From<MembraneChoice> for String {
    fn from(choice: MembraneChoice) -> Self {
        match choice {
            MembraneChoice::Marked(side) => SIDES[side].to_owned(),
            MembraneChoice::Between(low, high) => format!("{low},{high}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn membranes_are_read_as_they_are_written() {
        for text in ["receptor", "ligand", "-15.5,15", "0,30"] {
            let choice = MembraneChoice::try_from(text.to_owned()).unwrap();
            assert_eq!(String::from(choice), text);
        }
        let between = MembraneChoice::Between(-1.0, 2.0);
        assert_eq!("-1, 2".to_owned().try_into(), Ok(between));
        for text in ["", "both", "15,-15", "3,3", "3", "nan,3", "0,inf", "1,2,3"] {
            let read = MembraneChoice::try_from(text.to_owned());
            assert_eq!(read, Err(FORMS), "{text}");
        }
    }
}
