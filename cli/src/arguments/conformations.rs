//! Options that name several conformations of a side.

use std::str::FromStr;

use clap::{Args, ValueHint};

use crate::arguments::ranks::Ranks;

/// Conformations of receptor and ligand that are docked pair by pair, and ranked together.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Ensembles")]
pub struct ConformationArguments {
    /// Models of the receptor's file to dock and to rank together: all, or numbers such as 1,3,5-10.
    ///
    /// Each is docked in its own run. 1 is the first model in the file.
    #[arg(long, value_name = "all|LIST", conflicts_with_all = NOT_WITH)]
    pub receptor_models: Option<ModelList>,
    /// Models of the ligand's file, in the same way.
    #[arg(long, value_name = "all|LIST", conflicts_with_all = NOT_WITH)]
    pub ligand_models: Option<ModelList>,
    /// The receptor in another conformation, docked and ranked with the first.
    ///
    /// May be given several times. FILE:H,L picks chains.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with_all = NOT_WITH)]
    pub receptor_also: Vec<String>,
    /// The ligand in another conformation.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with_all = NOT_WITH)]
    pub ligand_also: Vec<String>,
}

/// Options that several conformations exclude.
const NOT_WITH: [&str; 3] = ["symmetry", "budget", "model"];

impl ConformationArguments {
    pub fn are_given(&self) -> bool {
        self.receptor_models.is_some()
            || self.ligand_models.is_some()
            || !self.receptor_also.is_empty()
            || !self.ligand_also.is_empty()
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ModelList {
    All,
    These(Vec<usize>),
}

impl FromStr for ModelList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "all" => Ok(Self::All),
            _ => match text.parse::<Ranks>() {
                Ok(Ranks(numbers)) => Ok(Self::These(numbers)),
                Err(_) => Err(format!(
                    "`{text}` is no list of models; give all, or numbers from 1 such as 1,3,5-10"
                )),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_models() {
        assert_eq!("all".parse(), Ok(ModelList::All));
        assert_eq!("1,3,5-7".parse(), Ok(ModelList::These(vec![1, 3, 5, 6, 7])));
        for text in ["", "0", "1,", "7-5", "first", "ALL"] {
            assert!(text.parse::<ModelList>().is_err(), "{text}");
        }
    }
}
