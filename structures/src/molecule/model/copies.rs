//! The copies of one molecule that a file holds side by side, atom by atom.

use crate::Error;
use crate::molecule::model::{Atom, Molecule};
use std::collections::HashMap;

/// Fewest atoms that copies must share.
const SHARED: usize = 3;

impl Molecule {
    /// Positions of the CA and P atoms that all copies have, copy by copy in the same order (Å). Copies follow one another
    /// in the file, each with all its chains in the same order, as complexes are written; residues match by number.
    ///
    /// # Errors
    /// The chains do not divide into that many copies, or chains in one place of each copy are not alike.
    pub fn copies(&self, copies: usize) -> Result<Vec<Vec<[f64; 3]>>, Error> {
        let mut place: HashMap<&str, usize> = HashMap::new();
        for atom in &self.atoms {
            let next = place.len();
            place.entry(&atom.chain).or_insert(next);
        }
        let chains = place.len();
        if chains == 0 || !chains.is_multiple_of(copies) {
            let message = format!("its chains, {chains} in all, make no {copies} copies");
            return Err(Error::input(message));
        }
        let each = chains / copies;
        // By place in the copy, residue and name: each copy's position.
        let mut found: HashMap<_, Vec<Option<[f64; 3]>>> = HashMap::new();
        let mut order = Vec::new();
        for atom in self.atoms.iter().filter(|atom| is_backbone(atom)) {
            let chain = place[atom.chain.as_str()];
            let residue = (atom.residue_number, atom.insertion_code);
            let key = (chain % each, residue, atom.name.as_str());
            let positions = found.entry(key).or_insert_with(|| {
                order.push(key);
                vec![None; copies]
            });
            positions[chain / each].get_or_insert(atom.position);
        }
        let shared: Vec<Vec<[f64; 3]>> = order
            .iter()
            .filter_map(|key| found[key].iter().copied().collect())
            .collect();
        if shared.len() < SHARED || 2 * shared.len() < order.len() {
            let shared = shared.len();
            return Err(Error::input(format!(
                "{shared} residues are common to its {copies} copies, which is too few"
            )));
        }
        let copy = |copy: usize| shared.iter().map(|positions| positions[copy]).collect();
        Ok((0..copies).map(copy).collect())
    }
}

/// One atom of each residue or nucleotide.
fn is_backbone(atom: &Atom) -> bool {
    matches!(
        (atom.name.as_str(), atom.element.as_str()),
        ("CA", "C") | ("P", "P")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::model::Format;

    /// Residues 1 to `residues` of each chain, x their number and y the chain's place.
    fn molecule(chains: &str, residues: i64) -> Molecule {
        let atoms = chains.chars().zip(0..).flat_map(|(chain, place)| {
            (1..=residues).map(move |residue_number| Atom {
                name: "CA".to_owned(),
                residue_name: "ALA".to_owned(),
                chain: chain.to_string(),
                residue_number,
                element: "C".to_owned(),
                position: [residue_number as f64, f64::from(place), 0.0],
                ..Atom::default()
            })
        });
        Molecule::new(atoms.collect(), Format::Pdb)
    }

    #[test]
    fn copies_are_matched_residue_by_residue() {
        let mut ring = molecule("HLMN", 5);
        // A residue that one copy lacks is left out of all.
        ring.atoms
            .retain(|atom| (atom.chain.as_str(), atom.residue_number) != ("M", 2));
        let copies = ring.copies(2).unwrap();
        assert_eq!(copies[0].len(), 9);
        assert_eq!(copies[0].len(), copies[1].len());
        for (first, second) in copies[0].iter().zip(&copies[1]) {
            assert_eq!((first[0], first[1] + 2.0), (second[0], second[1]));
            assert!(!(first[0] == 2.0 && first[1] == 0.0));
        }
        assert_eq!(ring.copies(4).unwrap().len(), 4);
    }

    #[test]
    fn what_is_no_number_of_copies_is_refused() {
        let of = |molecule: &Molecule, copies| molecule.copies(copies).unwrap_err().to_string();
        let refused = of(&molecule("ABC", 4), 2);
        assert!(refused.contains("3 in all, make no 2 copies"), "{refused}");
        let refused = of(&molecule("", 4), 2);
        assert!(refused.contains("0 in all"), "{refused}");
        let mut other = molecule("AB", 4);
        for atom in other.atoms.iter_mut().filter(|atom| atom.chain == "B") {
            atom.residue_number += 100;
        }
        let refused = of(&other, 2);
        assert!(
            refused.starts_with("0 residues are common to its 2 copies"),
            "{refused}"
        );
    }
}
