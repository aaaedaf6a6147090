//! The copies of one molecule that a file holds side by side, atom by atom.

use crate::molecule::model::atom::Atom;
use crate::molecule::model::molecule::Molecule;
use std::collections::HashMap;

/// Fewest atoms that copies must share.
const SHARED: usize = 3;

/// A molecule that does not consist of so many copies.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CopiesError {
    /// Its chains do not divide.
    #[error("its chains, {chains} in all, make no {copies} copies")]
    Chains {
        /// Its chains.
        chains: usize,
        /// Copies requested.
        copies: usize,
    },
    /// Chains in the same place of each copy are not alike.
    #[error("{shared} residues are common to its {copies} copies, which is too few")]
    Different {
        /// Copies requested.
        copies: usize,
        /// Residues that all of them have.
        shared: usize,
    },
}

impl Molecule {
    /// Positions of the CA and P atoms that all of so many copies have, copy by copy in the same order (Å). Copies
    /// follow one another in the file, each with all its chains in the same order, as complexes are written; residues
    /// are matched by their number.
    ///
    /// # Errors
    /// [`CopiesError`] where there are not so many.
    pub fn copies(&self, copies: usize) -> Result<Vec<Vec<[f64; 3]>>, CopiesError> {
        let mut place: HashMap<&str, usize> = HashMap::new();
        for atom in &self.atoms {
            let next = place.len();
            place.entry(&atom.chain).or_insert(next);
        }
        let chains = place.len();
        if chains == 0 || !chains.is_multiple_of(copies) {
            return Err(CopiesError::Chains { chains, copies });
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
            return Err(CopiesError::Different { copies, shared });
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
    use crate::molecule::model::format::Format;

    /// Residues 1 to `residues` of each chain, x their number and y the chain's place.
    fn molecule(chains: &str, residues: i64) -> Molecule {
        let atoms = chains.chars().zip(0..).flat_map(|(chain, place)| {
            (1..=residues).map(move |residue_number| Atom {
                name: "CA".to_owned(),
                residue_name: "ALA".to_owned(),
                chain: chain.to_string(),
                residue_number,
                insertion_code: None,
                alternate_location: None,
                element: "C".to_owned(),
                position: [residue_number as f64, f64::from(place), 0.0],
                occupancy: 1.0,
                b_factor: 0.0,
                hetero: false,
                radius: 1.7,
                line: 0,
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
        let of = |chains: &str, copies| molecule(chains, 4).copies(copies).unwrap_err();
        assert_eq!(
            of("ABC", 2),
            CopiesError::Chains {
                chains: 3,
                copies: 2
            }
        );
        assert_eq!(
            of("", 2),
            CopiesError::Chains {
                chains: 0,
                copies: 2
            }
        );
        let mut other = molecule("AB", 4);
        for atom in other.atoms.iter_mut().filter(|atom| atom.chain == "B") {
            atom.residue_number += 100;
        }
        let different = CopiesError::Different {
            copies: 2,
            shared: 0,
        };
        assert_eq!(other.copies(2), Err(different));
    }
}
