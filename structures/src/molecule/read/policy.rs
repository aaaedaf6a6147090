//! Policies of reading: what becomes of waters, HETATM records, hydrogens, alternate locations and models.
//!
//! Each is written and read as on the command line, in `run.json` too.

use std::fmt;
use std::str::FromStr;

use serde::de::IntoDeserializer;
use serde::de::value::{Error as ValueError, StrDeserializer};
use serde::{Deserialize, Serialize};

use crate::Error;

/// Options on reading a structure file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ReadOptions {
    /// Policy on waters.
    pub waters: Waters,
    /// Policy on the other groups in HETATM records.
    pub hetatm: Hetatm,
    /// Policy on hydrogens.
    pub hydrogens: Hydrogens,
    /// Choice of the alternate location.
    pub altloc: AlternateLocation,
    /// Model that is read, or all of them as one molecule. A file of one model has it read.
    pub model: ModelChoice,
    /// Biological assembly to build of the chains, by its name in the file; a file that says nothing of assemblies is
    /// read as it stands.
    pub assembly: Option<String>,
    /// Residues of a predicted model with a pLDDT (0 to 100) below this are left out; of other files nothing is.
    pub min_plddt: Option<f64>,
    /// Residues of these names are left out, whatever they are.
    pub drop_residue: Vec<String>,
    /// Whether the B column is pLDDT wherever it can be, as the user says who gives a least one and no file is known as
    /// a prediction.
    #[serde(skip)]
    pub trust_plddt: bool,
    /// Residue names to keep though they are dropped as water or as a buffer or cryo additive.
    #[serde(skip)]
    pub keep: Vec<String>,
}

/// Choice of a file's models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "WrittenModel", into = "WrittenModel")]
pub enum ModelChoice {
    /// One: 1 is the first in the file, whatever number it carries.
    Number(usize),
    /// All of them, as parts of one molecule.
    All,
}

/// A choice of models as in `run.json`: a number, or `all`.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum WrittenModel {
    Number(usize),
    Word(String),
}

impl Default for ModelChoice {
    fn default() -> Self {
        Self::Number(1)
    }
}

impl ModelChoice {
    pub(crate) fn takes(self, number: usize) -> bool {
        match self {
            Self::Number(wanted) => number == wanted,
            Self::All => true,
        }
    }
}

impl FromStr for ModelChoice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        match (text, text.parse()) {
            ("all", _) => Ok(Self::All),
            (_, Ok(number)) if number > 0 => Ok(Self::Number(number)),
            _ => Err(none_of("a whole number above zero and all", text)),
        }
    }
}

impl fmt::Display for ModelChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::All => f.write_str("all"),
        }
    }
}

impl From<ModelChoice> for WrittenModel {
    fn from(choice: ModelChoice) -> Self {
        match choice {
            ModelChoice::Number(number) => Self::Number(number),
            ModelChoice::All => Self::Word(choice.to_string()),
        }
    }
}

impl TryFrom<WrittenModel> for ModelChoice {
    type Error = Error;

    fn try_from(written: WrittenModel) -> Result<Self, Error> {
        match written {
            WrittenModel::Number(number) => number.to_string().parse(),
            WrittenModel::Word(word) => word.parse(),
        }
    }
}

/// Policy on waters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Waters {
    /// They are dropped.
    #[default]
    Drop,
    /// They are kept, whatever the policy on HETATM records.
    Keep,
}

/// Policy on HETATM records other than water.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hetatm {
    /// Known buffer and cryo additives are dropped (whatever their record), all else is kept.
    #[default]
    NoAdditives,
    /// All are kept.
    Keep,
    /// All are dropped but modified amino acids: residues with N, CA and C. Known additives are dropped whatever
    /// their record.
    Drop,
}

/// Policy on hydrogens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hydrogens {
    /// They are dropped: united-atom radii stand for them.
    #[default]
    Drop,
    /// They are kept, and all radii of a molecule that has some are all-atom radii.
    Keep,
}

/// Choice of the alternate location of a residue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum AlternateLocation {
    /// The one of the highest summed occupancy, the alphabetically first of equals.
    #[default]
    Occupancy,
    /// The one of this name, in residues that offer it; in others as by occupancy.
    Named(char),
}

fn none_of(choices: &str, text: &str) -> Error {
    Error::input(format!("'{text}' is none of {choices}")).help(format!("give one of {choices}"))
}

/// Reads and writes policies as in records: one of a few words.
macro_rules! words {
    ($($policy:ty: $choices:literal),+) => {$(
        impl FromStr for $policy {
            type Err = Error;

            fn from_str(text: &str) -> Result<Self, Error> {
                let word: StrDeserializer<'_, ValueError> = text.into_deserializer();
                Self::deserialize(word).map_err(|_| none_of($choices, text))
            }
        }

        impl fmt::Display for $policy {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.serialize(f)
            }
        }
    )+};
}

words!(Waters: "drop and keep", Hetatm: "no-additives, keep and drop", Hydrogens: "drop and keep");

impl FromStr for AlternateLocation {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let mut characters = text.chars();
        match (text, characters.next(), characters.next()) {
            ("occupancy", ..) => Ok(Self::Occupancy),
            (_, Some(name), None) if name.is_ascii_graphic() => Ok(Self::Named(name)),
            _ => Err(none_of("occupancy and a single character, such as A", text)),
        }
    }
}

impl fmt::Display for AlternateLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Occupancy => f.write_str("occupancy"),
            Self::Named(name) => write!(f, "{name}"),
        }
    }
}

impl From<AlternateLocation> for String {
    fn from(location: AlternateLocation) -> Self {
        location.to_string()
    }
}

impl TryFrom<String> for AlternateLocation {
    type Error = Error;

    fn try_from(text: String) -> Result<Self, Error> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_as_they_are_written() {
        for text in ["no-additives", "keep", "drop"] {
            assert_eq!(text.parse::<Hetatm>().unwrap().to_string(), text);
        }
        for text in ["keep", "drop"] {
            assert_eq!(text.parse::<Waters>().unwrap().to_string(), text);
            assert_eq!(text.parse::<Hydrogens>().unwrap().to_string(), text);
        }
        for text in ["occupancy", "A", "2"] {
            assert_eq!(text.parse::<AlternateLocation>().unwrap().to_string(), text);
        }
        assert!("Keep".parse::<Waters>().is_err());
        assert!("no-additives".parse::<Hydrogens>().is_err());
        for text in ["", "AB", " ", "\u{e9}"] {
            let error = text.parse::<AlternateLocation>().unwrap_err();
            assert!(error.to_string().contains("occupancy"));
        }
    }
}
