//! The atoms of receptor and ligand, by chain, residue and name, so that a test is made once per name or number.

use std::collections::{BTreeMap, BTreeSet};

use knotdock_structures::molecule::{Atom, Molecule};

use crate::restraints::tbl::hydrogens::hydrogen_names;

/// Number and insertion code of a residue. None comes before `A`.
pub(super) type ResidueNumber = (i64, Option<char>);

/// Atoms by their places, those of the receptor first.
pub(super) struct AtomIndex<'a> {
    pub(super) atoms: Vec<&'a Atom>,
    /// Number of the receptor's atoms.
    pub(super) receptor: usize,
    pub(super) chains: BTreeMap<&'a str, Vec<usize>>,
    pub(super) residue_names: BTreeMap<&'a str, Vec<usize>>,
    pub(super) names: BTreeMap<&'a str, Vec<usize>>,
    /// Names that the hydrogens of an atom of each name may have.
    pub(super) hydrogens: BTreeMap<&'a str, Vec<String>>,
    /// Residues of any chain, with number and insertion code as one text.
    pub(super) residues: BTreeMap<ResidueNumber, (String, Vec<usize>)>,
}

impl<'a> AtomIndex<'a> {
    pub(super) fn new(molecules: [&'a Molecule; 2]) -> Self {
        let mut index = Self {
            atoms: Vec::new(),
            receptor: molecules[0].atoms.len(),
            chains: BTreeMap::new(),
            residue_names: BTreeMap::new(),
            names: BTreeMap::new(),
            hydrogens: BTreeMap::new(),
            residues: BTreeMap::new(),
        };
        for (place, atom) in molecules.into_iter().flat_map(|one| &one.atoms).enumerate() {
            index.atoms.push(atom);
            for (by, value) in [
                (&mut index.chains, &atom.chain),
                (&mut index.residue_names, &atom.residue_name),
                (&mut index.names, &atom.name),
            ] {
                by.entry(value.as_str()).or_default().push(place);
            }
            let number = (atom.residue_number, atom.insertion_code);
            let (_, places) = index.residues.entry(number).or_insert_with(|| {
                let insertion = atom.insertion_code.map_or_else(String::new, String::from);
                (format!("{}{insertion}", atom.residue_number), Vec::new())
            });
            places.push(place);
        }
        let names = index.names.keys();
        index.hydrogens = names.map(|name| (*name, hydrogen_names(name))).collect();
        index
    }

    /// The chains of receptor (0) or ligand (1).
    pub(super) fn chains_of(&self, side: usize) -> BTreeSet<&'a str> {
        let is_own = |place: &usize| (*place >= self.receptor) == (side == 1);
        let chains = self.chains.iter();
        let own = chains.filter(|(_, places)| places.iter().any(is_own));
        own.map(|(chain, _)| *chain).collect()
    }

    /// Whether each atom is at one of some places.
    pub(super) fn at<'p>(&self, places: impl Iterator<Item = &'p Vec<usize>>) -> Vec<bool> {
        let mut chosen = vec![false; self.atoms.len()];
        for &place in places.flatten() {
            chosen[place] = true;
        }
        chosen
    }
}
