//! Which molecule a selection is of. Statements do not say: the chains that only one molecule has decide.

use std::collections::BTreeSet;

use knotdock_structures::molecule::Molecule;

use crate::named_columns::listed;
use crate::restraints::error::RestraintFault;
use crate::restraints::side_atoms::{heavy, residue};
use crate::restraints::tbl::expression::Expression;

/// Receptor and ligand as statements see them: all their atoms in one.
pub(super) struct Sides<'a> {
    molecules: [&'a Molecule; 2],
    chains: [BTreeSet<&'a str>; 2],
}

/// The words for the molecules.
pub(super) const SIDES: [&str; 2] = ["receptor", "ligand"];

impl<'a> Sides<'a> {
    pub(super) fn new(molecules: [&'a Molecule; 2]) -> Self {
        Self {
            molecules,
            chains: molecules.map(|molecule| {
                let atoms = molecule.atoms.iter();
                atoms.map(|atom| atom.chain.as_str()).collect()
            }),
        }
    }

    /// The chains of both.
    pub(super) fn all_chains(&self) -> BTreeSet<&'a str> {
        self.chains[0].union(&self.chains[1]).copied().collect()
    }

    /// The molecule (0 or 1) that a selection is of, and its atoms, rising. `written` is the selection's text.
    pub(super) fn select(
        &self,
        expression: &Expression,
        written: impl Fn() -> String,
    ) -> Result<(usize, Vec<usize>), RestraintFault> {
        let [receptor, ligand] = self.molecules.map(|molecule| {
            let atoms = &molecule.atoms;
            let is_selected = |index: &usize| expression.holds(&atoms[*index]);
            heavy(atoms, (0..atoms.len()).filter(is_selected).collect())
        });
        let chain_names = |side: usize, atoms: &[usize]| -> BTreeSet<&str> {
            let atoms = atoms
                .iter()
                .map(|&index| &self.molecules[side].atoms[index]);
            atoms.map(|atom| atom.chain.as_str()).collect()
        };
        let names = [chain_names(0, &receptor), chain_names(1, &ligand)];
        let is_shared = |chain: &&&str| self.chains.iter().all(|chains| chains.contains(**chain));
        if let Some(shared) = names.iter().flatten().find(is_shared) {
            return Err(RestraintFault::SharedChain {
                selection: written(),
                chain: shown(shared).to_owned(),
            });
        }
        match (receptor.is_empty(), ligand.is_empty()) {
            (false, true) => Ok((0, receptor)),
            (true, false) => Ok((1, ligand)),
            (false, false) => Err(RestraintFault::BothSides {
                selection: written(),
                chains: names.map(|names| in_words(&names)),
            }),
            (true, true) => Err(RestraintFault::NoAtom {
                selection: written(),
                present: self.present(expression),
            }),
        }
    }

    /// What there is in place of atoms that a selection does not find: the atoms of its first residue where only
    /// their names are wrong, else chains and numbers.
    fn present(&self, expression: &Expression) -> String {
        for (side, molecule) in SIDES.iter().zip(self.molecules) {
            let mut atoms = molecule.atoms.iter();
            if let Some(first) = atoms.find(|atom| expression.holds_but_for_names(atom)) {
                let own = residue(first);
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
