//! Peptide chains as sequences: runs of amino acids, their letters and their numbers.

use std::ops::Range;

use crate::molecule::chemistry::one_letter;
use crate::molecule::model::{Molecule, Residue, residue_runs};

/// A run of amino acids in one chain of a file, one after another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PeptideChain<'a> {
    /// The author's name of the chain; may be empty.
    pub name: &'a str,
    /// Its residues in file order; none may be missing between two that follow each other here.
    pub residues: Vec<PeptideResidue>,
}

/// An amino acid of a chain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PeptideResidue {
    /// The author's number with the insertion code, e.g. `52A`.
    pub number: String,
    /// One letter, X of an amino acid outside the twenty.
    pub letter: char,
    /// The indices of its atoms in the molecule.
    pub atoms: Range<usize>,
}

impl PeptideChain<'_> {
    /// The letters of all residues.
    pub fn sequence(&self) -> String {
        self.residues.iter().map(|residue| residue.letter).collect()
    }
}

impl Molecule {
    /// The peptide chains in file order, modified amino acids included.
    ///
    /// A new chain begins if the name changes or another kind of residue is between; it goes on if numbers begin again
    /// under one name.
    pub fn peptide_chains(&self) -> Vec<PeptideChain<'_>> {
        let runs = residue_runs(&self.atoms);
        runs.chunk_by(|a, b| a.key.chain == b.key.chain && a.is_peptide() == b.is_peptide())
            .filter(|run| run.first().is_some_and(Residue::is_peptide))
            .map(|run| PeptideChain {
                name: run.first().map_or("", |residue| residue.key.chain),
                residues: run.iter().map(peptide_residue).collect(),
            })
            .collect()
    }
}

fn peptide_residue(residue: &Residue<'_>) -> PeptideResidue {
    // The atoms of a run stand together.
    let start = residue.atoms.first().copied().unwrap_or(0);
    PeptideResidue {
        number: residue.key.number_text(),
        letter: one_letter(residue.known_as),
        atoms: start..start + residue.atoms.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::model::{Atom, Format};

    #[test]
    fn chains_are_runs_of_amino_acids_under_one_name() {
        let residue = |chain: &str, name: &str, number: i64, insertion: Option<char>| Atom {
            name: "CA".to_owned(),
            residue_name: name.to_owned(),
            chain: chain.to_owned(),
            residue_number: number,
            insertion_code: insertion,
            element: "C".to_owned(),
            position: [0.0; 3],
            ..Atom::default()
        };
        let atoms = vec![
            residue("H", "GLY", 52, None),
            residue("H", "HIE", 52, Some('A')),
            residue("H", "MSE", 1, None),
            residue("L", "ALA", 1, None),
            residue("L", "HEM", 2, None),
            residue("L", "SER", 3, None),
        ];
        let molecule = Molecule::new(atoms, Format::Pdb);
        let chains = molecule.peptide_chains();
        let shown: Vec<(&str, String)> = chains.iter().map(|c| (c.name, c.sequence())).collect();
        let expected = [("H", "GHM"), ("L", "A"), ("L", "S")];
        assert_eq!(
            shown,
            expected.map(|(name, letters)| (name, letters.to_owned()))
        );
        let second = &chains[0].residues[1];
        assert_eq!(
            (second.number.as_str(), second.atoms.clone()),
            ("52A", 1..2)
        );
        assert_eq!(chains[2].residues[0].atoms, 5..6);
    }
}
