//! The molecule of a selection. Statements do not name it: the chains that only one molecule has decide.

use std::collections::BTreeSet;

use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;

use crate::restraints::side_atoms::{NO_ATOM, heavy, residue};
use crate::restraints::tbl::atom_index::AtomIndex;
use crate::restraints::tbl::expression::{Expression, Tested};
use crate::table_text::named_columns::listed;

/// Receptor and ligand with all their atoms in one index.
pub(super) struct Sides<'a> {
    molecules: [&'a Molecule; 2],
    index: AtomIndex<'a>,
    chains: [BTreeSet<&'a str>; 2],
}

/// The atoms of a selection.
pub(super) struct Selected {
    /// The molecule, 0 or 1.
    pub(super) side: usize,
    /// Its atoms, rising.
    pub(super) atoms: Vec<usize>,
    /// Whether HADDOCK would count hydrogens bonded to them, too.
    pub(super) has_hydrogens: bool,
}

const SIDES: [&str; 2] = ["receptor", "ligand"];

impl<'a> Sides<'a> {
    pub(super) fn new(molecules: [&'a Molecule; 2]) -> Self {
        let index = AtomIndex::new(molecules);
        Self {
            molecules,
            chains: [0, 1].map(|side| index.chains_of(side)),
            index,
        }
    }

    /// The chains of both.
    pub(super) fn all_chains(&self) -> BTreeSet<&'a str> {
        self.chains[0].union(&self.chains[1]).copied().collect()
    }

    /// The molecule that a selection is of, and its atoms. `written` is the selection's text.
    pub(super) fn select(
        &self,
        expression: &Expression,
        written: impl Fn() -> String,
    ) -> Result<Selected, Error> {
        let chosen = expression.select(&self.index, Tested::Atoms);
        let chosen: [&[bool]; 2] = chosen.split_at(self.index.receptor).into();
        let [receptor, ligand] = [0, 1].map(|side| {
            let atoms = chosen[side].iter().enumerate();
            let atoms = atoms.filter(|(_, chosen)| **chosen).map(|(at, _)| at);
            heavy(&self.molecules[side].atoms, atoms.collect())
        });
        let chain_names = |side: usize, chosen: &[usize]| -> BTreeSet<&str> {
            let atoms = &self.molecules[side].atoms;
            chosen.iter().map(|&at| atoms[at].chain.as_str()).collect()
        };
        let names = [chain_names(0, &receptor), chain_names(1, &ligand)];
        let is_shared = |chain: &&&str| self.chains.iter().all(|chains| chains.contains(**chain));
        if let Some(shared) = names.iter().flatten().find(is_shared) {
            let (selection, chain) = (written(), shown(shared));
            return Err(Error::input(format!(
                "{selection} selects atoms of chain {chain}, and both receptor and ligand have a chain of that name"
            ))
            .help(
                "give the restraints as a CSV table, whose columns say the side, or rename the chain of one molecule",
            ));
        }
        match (receptor.is_empty(), ligand.is_empty()) {
            (false, true) => Ok(self.selected(0, receptor, expression)),
            (true, false) => Ok(self.selected(1, ligand, expression)),
            (false, false) => {
                let [receptor, ligand] = names.map(|names| in_words(&names));
                Err(Error::input(format!(
                    "{} selects atoms of both molecules: of the receptor's {receptor} and the ligand's {ligand}",
                    written()
                ))
                .help("name the chain of one of the two, as in `segid A`"))
            }
            (true, true) => {
                let (written, present) = (written(), self.present(expression));
                Err(Error::input(format!("{written} selects no atom; {present}")).help(NO_ATOM))
            }
        }
    }

    /// The atoms of a side, with whether the selection holds hydrogens bonded to them, in the file or not.
    fn selected(&self, side: usize, atoms: Vec<usize>, expression: &Expression) -> Selected {
        let carries = expression.select(&self.index, Tested::Hydrogens);
        let first = [0, self.index.receptor][side];
        let has_hydrogens = |&at: &usize| {
            let element = self.molecules[side].atoms[at].element.as_str();
            matches!(element, "C" | "N" | "O" | "S") && carries[first + at]
        };
        Selected {
            side,
            has_hydrogens: atoms.iter().any(has_hydrogens),
            atoms,
        }
    }

    /// The alternatives to atoms that a selection does not find: the atoms of its first residue if only their names are
    /// wrong, else chains and numbers.
    fn present(&self, expression: &Expression) -> String {
        let chosen = expression.select(&self.index, Tested::Residues);
        let chosen: [&[bool]; 2] = chosen.split_at(self.index.receptor).into();
        for ((side, molecule), chosen) in SIDES.iter().zip(self.molecules).zip(chosen) {
            if let Some(first) = chosen.iter().position(|chosen| *chosen) {
                let own = residue(&molecule.atoms[first]);
                let others = molecule.atoms.iter().filter(|atom| residue(atom) == own);
                let names = listed(others.map(|atom| atom.name.as_str()));
                return format!("{own} of the {side} has {names}");
            }
        }
        let [receptor, ligand] = self.molecules.map(Molecule::chains_in_words);
        format!("the receptor has {receptor}; the ligand has {ligand}")
    }
}

/// A chain as messages name it.
fn shown(chain: &str) -> &str {
    if chain.is_empty() { "_" } else { chain }
}

/// `chain A`, `chains A, B`.
fn in_words(chains: &BTreeSet<&str>) -> String {
    let word = if chains.len() == 1 { "chain" } else { "chains" };
    format!("{word} {}", listed(chains.iter().map(|chain| shown(chain))))
}
