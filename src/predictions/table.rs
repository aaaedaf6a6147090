//! Tables of predictions.
//!
//! ```text
//! chain,residue,probability
//! A,57,0.83
//! A,52A,0.12
//! ```
//!
//! Columns go by their names, in any order. A chain without a name is `_` or empty.

use std::collections::HashMap;

use knotdock_structures::molecule::{Molecule, ResidueSelection};

use super::{Prediction, PredictionFault, is_probability};
use crate::table_text::named_columns::{AtLine, read_rows, shortened};

/// The columns of a table.
pub(super) const COLUMNS: [&str; 3] = ["chain", "residue", "probability"];

/// The predictions of a table for the residues of a molecule.
pub(super) fn read(
    text: &str,
    molecule: &Molecule,
) -> Result<Vec<Prediction>, AtLine<PredictionFault>> {
    let mut predictions: Vec<Prediction> = Vec::new();
    // Lines by the first atom of their residue.
    let mut lines = HashMap::new();
    // Line ends of all systems, so that lines are counted as editors do.
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    read_rows(text.into_bytes(), COLUMNS, &COLUMNS, |line, row| {
        let (residue, atoms) = residue(row, molecule)?;
        if let Some(first) = lines.insert(atoms.first().copied(), line) {
            return Err(PredictionFault::Repeated { residue, first });
        }
        predictions.push((atoms, probability(row[2])?));
        Ok(())
    })?;
    if predictions.is_empty() {
        return Err(PredictionFault::NoPrediction.in_file());
    }
    Ok(predictions)
}

/// The residue of a row: its name, and the indices of its heavy atoms.
fn residue(
    [chain, residue, _]: &[&str; 3],
    molecule: &Molecule,
) -> Result<(String, Vec<usize>), PredictionFault> {
    if residue.is_empty() {
        return Err(PredictionFault::MissingField("residue"));
    }
    let chain = if chain.is_empty() { "_" } else { chain };
    let name = format!("{chain}:{residue}");
    let no_residue = || PredictionFault::ResidueSyntax(shortened(&name));
    let selection: ResidueSelection = name.parse().map_err(|_| no_residue())?;
    let mut selected =
        molecule
            .selected(&selection)
            .map_err(|unknown| PredictionFault::UnknownResidue {
                residue: shortened(&unknown.part),
                present: unknown.present(),
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

/// Whether several residues are called alike.
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

fn probability(field: &str) -> Result<f64, PredictionFault> {
    let number = field.parse().ok().filter(|number| is_probability(*number));
    match (number, field) {
        (Some(number), _) => Ok(number),
        (None, "") => Err(PredictionFault::MissingField("probability")),
        (None, text) => Err(PredictionFault::Probability(shortened(text))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table_text::named_columns::TableFault;
    use crate::test_molecules::molecules;
    use proptest::prelude::*;

    fn of_receptor(text: &str) -> Result<Vec<Prediction>, AtLine<PredictionFault>> {
        let [receptor, _] = molecules();
        read(text, &receptor)
    }

    /// Of the receptor A:10 has the atoms 0 to 4, the last a hydrogen, A:52 has 9 to 11, A:52A 12 to 14, D:-3 15 and
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
        let nameless = super::read("chain,residue,probability\n,7,0.5\n", &ligand).unwrap();
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
        let found = super::read("chain,residue,probability\nA,52,0.5\n", &receptor).unwrap();
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
            let AtLine { line: at, fault } = of_receptor(&text).unwrap_err();
            assert_eq!(at, line, "{text:?}");
            assert!(fault.to_string().starts_with(message), "{fault}");
            assert!(!fault.remedy().is_empty());
        }
        let columns = PredictionFault::Table(TableFault::UnknownColumn(String::new()));
        assert!(columns.remedy().contains("chain, residue, probability"));
    }

    proptest! {
        /// Any text is read or refused, and what is read can be used.
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
                Err(at) => prop_assert!(!at.fault.to_string().is_empty() && at.line != Some(0)),
            }
        }
    }
}
