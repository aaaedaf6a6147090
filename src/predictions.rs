//! Interface predictions: the probability of each residue of a molecule to be in the interface.
//!
//! They are read from a table, or from the B values of the molecule's own file, as some predictors write them. Residues
//! without a prediction count as average.
//!
//! ```text
//! chain,residue,probability
//! A,57,0.83
//! A,52A,0.12
//! ```
//!
//! Columns go by their names, in any order. A chain without a name is `_` or empty. As a B value, an amino acid's
//! prediction is the mean over its heavy atoms; predictors rate no ions, glycans, cofactors and nucleic acids, whose
//! B values remain those of the crystal.
//!
//! # Conventions
//!
//! Probabilities are between 0 and 1. Log-odds are natural logarithms, ln(p / (1 - p)).

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use knotdock_scoring::terms::pose::PredictedResidue;
use knotdock_structures::Error;
use knotdock_structures::molecule::{Molecule, ResidueSelection};
use serde::{Deserialize, Serialize};

use crate::bounded_read::{MAX_TABLE, read_bounded_text};
use crate::table_text::named_columns::{Columns, listed, read_rows, shortened};

/// The word in place of a file for the B values of the molecule's own file.
pub const B_VALUES: &str = "bfactor";

/// Largest probability that counts: no predictor is surer.
const MAX_PROBABILITY: f64 = 0.99;

/// The columns of a table.
const COLUMNS: Columns<3> = Columns {
    names: ["chain", "residue", "probability"],
    needed: &["chain", "residue", "probability"],
    remedy: "the first row names the columns, all of which are needed: chain, residue, probability",
};

/// Source of predictions.
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
        /// Its content.
        text: String,
    },
}

/// A residue with its prediction: indices of its heavy atoms, and a probability.
type Prediction = (Vec<usize>, f64);

impl PredictionSource {
    /// The source with a name: the B values, or a file, which is read.
    ///
    /// # Errors
    /// [`Error`] if the file cannot be read, is too large or no text.
    pub fn read(name: &str) -> Result<Self, Error> {
        let path = Path::new(name);
        // A file of options puts its folder before the word.
        if path.file_name().is_some_and(|word| word == B_VALUES) && !path.exists() {
            return Ok(Self::BValues);
        }
        let text = read_bounded_text(path, MAX_TABLE).map_err(|error| {
            Error::input(format!("the predictions cannot be read: {error}"))
                .at(path)
                .help("give a CSV table in UTF-8, or bfactor for the B values of the molecule's own file")
        })?;
        Ok(Self::Table {
            path: path.to_owned(),
            text,
        })
    }

    /// The residues of a molecule with their log-odds less those of the mean.
    ///
    /// # Errors
    /// [`Error`] if a residue is unknown, a number is no probability, or all are equal.
    pub fn residues(&self, molecule: &Molecule) -> Result<Vec<PredictedResidue>, Error> {
        let log_odds = |predictions: Vec<Prediction>| {
            log_odds(&predictions).ok_or_else(|| {
                Error::input("all residues have the same probability, which says nothing")
                    .help("give a probability for each residue, or leave the option out")
            })
        };
        match self {
            Self::BValues => of_b_values(molecule).and_then(log_odds),
            Self::Table { path, text } => of_table(text, molecule)
                .and_then(log_odds)
                .map_err(|error| error.at(path)),
        }
    }
}

/// The predictions of a molecule, amino acid by amino acid.
fn of_b_values(molecule: &Molecule) -> Result<Vec<Prediction>, Error> {
    let atoms = &molecule.atoms;
    let (mut predictions, mut outside): (Vec<Prediction>, Vec<String>) = Default::default();
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let chains = molecule.peptide_chains();
    let chains = chains.iter();
    let residues = chains.flat_map(|chain| chain.residues.iter().map(|one| (chain.name, one)));
    for (chain, residue) in residues {
        let is_heavy = |at: &usize| !atoms[*at].is_hydrogen();
        let heavy: Vec<usize> = residue.atoms.clone().filter(is_heavy).collect();
        if heavy.is_empty() {
            continue;
        }
        let values = || heavy.iter().map(|&at| atoms[at].b_factor);
        (low, high) = values().fold((low, high), |(low, high), value| {
            (value.min(low), value.max(high))
        });
        if values().all(is_probability) {
            let mean = values().sum::<f64>() / heavy.len() as f64;
            predictions.push((heavy, mean));
        } else {
            let chain = if chain.is_empty() { "_" } else { chain };
            outside.push(format!("{chain}:{}", residue.number));
        }
    }
    let refused = |message: String| {
        Err(Error::input(message).help(
            "give the predictions as a CSV table, or a file with probabilities as B values: those of crystals and \
             the confidence of predicted models are no predictions of the interface",
        ))
    };
    if !outside.is_empty() {
        return refused(format!(
            "the B values of {} of {} amino acids are no probabilities, which run from 0 to 1: {}; all run from {low} \
             to {high}",
            outside.len(),
            outside.len() + predictions.len(),
            listed(outside.iter().map(String::as_str))
        ));
    }
    if predictions.is_empty() {
        let message = "there is no amino acid, and only those have predictions as B values";
        return refused(message.to_owned());
    }
    Ok(predictions)
}

/// The predictions of a table for the residues of a molecule.
fn of_table(text: &str, molecule: &Molecule) -> Result<Vec<Prediction>, Error> {
    let mut predictions: Vec<Prediction> = Vec::new();
    // Lines by the first atom of their residue.
    let mut lines = HashMap::new();
    // Line ends of all systems, so that lines are counted as editors do.
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    read_rows(text.into_bytes(), &COLUMNS, |line, row| {
        let (residue, atoms) = residue(row, molecule)?;
        if let Some(first) = lines.insert(atoms.first().copied(), line) {
            let message = format!("residue {residue} has a prediction on line {first} already");
            return Err(Error::input(message).help("leave out one of the two rows"));
        }
        predictions.push((atoms, probability(row[2])?));
        Ok(())
    })?;
    if predictions.is_empty() {
        return Err(Error::input("there is no prediction in the file").help(COLUMNS.remedy));
    }
    Ok(predictions)
}

/// The residue of a row: its name, and the indices of its heavy atoms.
fn residue(
    [chain, residue, _]: &[&str; 3],
    molecule: &Molecule,
) -> Result<(String, Vec<usize>), Error> {
    if residue.is_empty() {
        return Err(no_field("residue"));
    }
    let chain = if chain.is_empty() { "_" } else { chain };
    let name = format!("{chain}:{residue}");
    let no_residue = || {
        Error::input(format!("`{}` does not name one residue", shortened(&name))).help(ONE_RESIDUE)
    };
    let selection: ResidueSelection = name.parse().map_err(|_| no_residue())?;
    let mut selected = molecule.selected(&selection).map_err(|unknown| {
        let (residue, present) = (shortened(&unknown.part), unknown.present());
        let message = format!("there is no residue {residue}; there are {present}");
        Error::input(message).help(
            "leave out rows of residues that the file of the molecule lacks, and number as it does",
        )
    })?;
    for (selected, atom) in selected.iter_mut().zip(&molecule.atoms) {
        *selected &= !atom.is_hydrogen();
    }
    let mut residues = molecule.atoms_by_residue(&selected);
    if has_one_number(&residues, molecule) {
        // Older files number the cofactors of a chain from 1, too.
        residues.retain(|atoms| has_backbone(atoms, molecule));
    }
    match <[Vec<usize>; 1]>::try_from(residues) {
        Ok([atoms]) => Ok((name, atoms)),
        Err(_) => Err(no_residue()),
    }
}

/// Whether these are several residues with one number.
fn has_one_number(residues: &[Vec<usize>], molecule: &Molecule) -> bool {
    let number = |atoms: &Vec<usize>| {
        let atom = atoms.first().and_then(|&at| molecule.atoms.get(at))?;
        Some((atom.residue_number, atom.insertion_code))
    };
    let first = residues.first().and_then(number);
    residues.len() > 1 && residues.iter().all(|atoms| number(atoms) == first)
}

/// Whether a residue is one of a protein or a nucleic acid.
fn has_backbone(atoms: &[usize], molecule: &Molecule) -> bool {
    let mut names = atoms.iter().filter_map(|&at| molecule.atoms.get(at));
    names.any(|atom| atom.element == "C" && ["CA", "C1'"].contains(&atom.name.as_str()))
}

/// Remedy for a row that does not name a residue.
const ONE_RESIDUE: &str = "give the chain and the number of one residue, as in A and 57 or 52A; a chain without a name is _";

/// A row with an empty field that it needs.
fn no_field(column: &str) -> Error {
    Error::input(format!("the row has no {column}")).help(ONE_RESIDUE)
}

fn probability(field: &str) -> Result<f64, Error> {
    let number = field.parse().ok().filter(|number| is_probability(*number));
    number.ok_or_else(|| match field {
        "" => no_field("probability"),
        text => Error::input(format!(
            "the probability is `{}`; it must be a number from 0 to 1",
            shortened(text)
        ))
        .help("write a number such as 0.25; divide percentages by 100"),
    })
}

impl std::fmt::Display for PredictionSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::BValues => f.write_str(B_VALUES),
            Self::Table { path, .. } => write!(f, "{}", path.display()),
        }
    }
}

/// Log-odds of probabilities less those of their mean; `None` if all are equal.
fn log_odds(predictions: &[Prediction]) -> Option<Vec<PredictedResidue>> {
    let logit = |p: f64| {
        let p = p.clamp(1.0 - MAX_PROBABILITY, MAX_PROBABILITY);
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
    use crate::test_molecules::molecules;
    use knotdock_structures::molecule::{InputSpec, ReadOptions, read_bytes};
    use proptest::prelude::*;

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
        assert_eq!(error.file(), Some(Path::new("nowhere.csv")));
        assert!(
            error
                .to_string()
                .starts_with("the predictions cannot be read")
        );
    }

    fn with_b_values(b_values: [f64; 4]) -> Molecule {
        let rows = [
            ("ATOM  ", " CA ", "GLY", 1, " C"),
            ("ATOM  ", " CB ", "ALA", 2, " C"),
            ("ATOM  ", " CA ", "ALA", 2, " C"),
            ("HETATM", "CA  ", " CA", 3, "CA"),
        ];
        let line = |((record, name, residue, number, element), b): ((_, _, _, _, _), f64)| {
            format!(
                "{record}    1 {name} {residue} A{number:>4}    {0:8.3}{0:8.3}{0:8.3}  1.00{b:6.2}          {element}\n",
                4.0 * b
            )
        };
        let text: String = rows.into_iter().zip(b_values).map(line).collect();
        let options = ReadOptions::default();
        read_bytes(&InputSpec::whole("x.pdb"), text.into(), &options).unwrap()
    }

    /// A calcium ion with its crystal's B value of 25 stopped a docking with predictions for every amino acid.
    #[test]
    fn ions_are_no_predictions() {
        let molecule = with_b_values([0.25, 0.5, 1.0, 25.0]);
        assert_eq!(molecule.atoms.len(), 4);
        let expected = [(vec![0], 0.25), (vec![1, 2], 0.75)];
        assert_eq!(of_b_values(&molecule).unwrap(), expected);
    }

    #[test]
    fn residues_out_of_range_are_named() {
        let error = of_b_values(&with_b_values([0.25, 0.5, 7.0, 25.0])).unwrap_err();
        assert_eq!(
            error.message(),
            "the B values of 1 of 2 amino acids are no probabilities, which run from 0 to 1: A:2; all run from 0.25 to 7"
        );
        assert!(error.remedy().is_some());
        let mut ion = with_b_values([0.25; 4]);
        ion.atoms.drain(..3);
        assert!(
            of_b_values(&ion)
                .unwrap_err()
                .message()
                .contains("no amino acid")
        );
    }

    fn of_receptor(text: &str) -> Result<Vec<Prediction>, Error> {
        let [receptor, _] = molecules();
        of_table(text, &receptor)
    }

    /// In the receptor A:10 has the atoms 0 to 4, the last a hydrogen, A:52 has 9 to 11, A:52A 12 to 14, D:-3 15 and
    /// 16.
    #[test]
    fn residues_go_by_chain_and_number() {
        let text =
            "Probability;chain;residue\r\n0.25;A;52A\r\n1;D;-3\r\n\r\n# none\r\n0.5;A;10\r\n";
        let read = of_receptor(text).unwrap();
        let expected = [
            (vec![12, 13, 14], 0.25),
            (vec![15, 16], 1.0),
            (vec![0, 1, 2, 3], 0.5),
        ];
        assert_eq!(read, expected);
        let [_, ligand] = molecules();
        let nameless = of_table("chain,residue,probability\n,7,0.5\n", &ligand).unwrap();
        assert_eq!(nameless.len(), 1);
    }

    /// Cytochrome c of 2PCC has GLY 1 and, in the same chain, HEC 1: its predictions were refused.
    #[test]
    fn a_cofactor_of_the_same_number_is_passed_over() {
        let [mut receptor, _] = molecules();
        let mut iron = receptor.atoms[0].clone();
        (iron.name, iron.element) = ("FE".to_owned(), "FE".to_owned());
        (iron.residue_name, iron.residue_number) = ("HEC".to_owned(), 52);
        receptor.atoms.push(iron);
        let found = of_table("chain,residue,probability\nA,52,0.5\n", &receptor).unwrap();
        assert_eq!(found, [(vec![9, 10, 11], 0.5)]);
    }

    #[test]
    fn rows_are_refused_by_their_line() {
        let row = |row: &str| format!("chain,residue,probability\nA,10,0.5\n{row}\n");
        for (text, line, message) in [
            (
                row("A,99,0.5"),
                Some(3),
                "there is no residue A:99; there are",
            ),
            (
                row("A,10-11,0.5"),
                Some(3),
                "`A:10-11` does not name one residue",
            ),
            (row("A,x,0.5"), Some(3), "`A:x` does not name one residue"),
            (row("A,,0.5"), Some(3), "the row has no residue"),
            (row("A,11,"), Some(3), "the row has no probability"),
            (row("A,11,nan"), Some(3), "the probability is `nan`"),
            (row("A,11,50"), Some(3), "the probability is `50`"),
            (row("A,11,-0.1"), Some(3), "the probability is `-0.1`"),
            (
                row("A,10,0.5"),
                Some(3),
                "residue A:10 has a prediction on line 2",
            ),
            (row("A,11"), Some(3), "the row has 2 fields"),
            (
                "chain,residue\nA,10\n".into(),
                Some(1),
                "there is no column `probability`",
            ),
            ("# none\n".into(), None, "there is no prediction"),
            (
                "chain,residue,probability\n".into(),
                None,
                "there is no prediction",
            ),
        ] {
            let error = of_receptor(&text).unwrap_err();
            assert_eq!(error.line(), line, "{text:?}");
            assert!(error.message().starts_with(message), "{error}");
            assert!(error.remedy().is_some());
        }
        let error = of_receptor("chain,mass\n").unwrap_err();
        assert!(
            error
                .remedy()
                .unwrap()
                .contains("chain, residue, probability")
        );
    }

    proptest! {
        /// Any text is read or refused, and all predictions that are read can be used.
        #[test]
        fn any_text_is_read_or_refused(
            words in prop::collection::vec(prop::sample::select(vec![
                "chain", "residue", "probability", ",", ",", "\n", "\r", "A", "D", "10", "52A", "-3", "0.5", "1e-3",
                "inf", "\"", "#", ";", "\t", "\u{feff}", "é", "\0", "A,10,0.5\n", "chain,residue,probability\n",
            ]), 0..40),
        ) {
            match of_receptor(&words.concat()) {
                Ok(predictions) => {
                    prop_assert!(!predictions.is_empty());
                    for (atoms, p) in predictions {
                        prop_assert!(!atoms.is_empty() && is_probability(p));
                    }
                }
                Err(error) => prop_assert!(!error.message().is_empty() && error.line() != Some(0)),
            }
        }
    }
}
