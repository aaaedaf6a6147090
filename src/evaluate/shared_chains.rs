//! Whether one molecule to dock is part of the other: a chain docked against the file of a complex that holds it.

use std::collections::HashSet;

use knotdock_structures::molecule::Molecule;

use super::residues::Residues;
use crate::evaluate::matching::alignment::align;
use crate::evaluate::residues::residue::Residue;

/// Fewest residues of a chain that counts.
const MIN_RESIDUES: usize = 5;

/// Fewest kinds of residues of such a chain: what has fewer is like any other of its kind.
const MIN_KINDS: usize = 3;

/// Least share of the residues of the longer chain that are equal in two copies of one chain, which may lack loops.
const MIN_EQUAL: f64 = 0.8;

/// The chains of one molecule that the other holds, and the other's further chains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SharedChains {
    /// Chain names: the one's, and the other's of the same sequence.
    pub pairs: Vec<(String, String)>,
    /// Names of the other's chains that are none of these; empty if its chains share one name.
    pub rest: Vec<String>,
}

/// The chains of `one` that `other` holds, if it holds all of them and further chains beside. Two copies of one
/// molecule, as of a homodimer, hold nothing beside one another.
pub fn shared_chains(one: &Molecule, other: &Molecule) -> Option<SharedChains> {
    let one = Residues::of(one, "molecule").ok()?;
    let other = Residues::of(other, "molecule").ok()?;
    let chains = |residues: &Residues| -> Vec<usize> {
        let long = |&place: &usize| residues.segments[place].members.len() >= MIN_RESIDUES;
        (0..residues.segments.len()).filter(long).collect()
    };
    let mut free = chains(&other);
    let sought = chains(&one);
    if sought.is_empty() || free.len() <= sought.len() {
        return None;
    }
    let mut shared = Vec::new();
    for segment in sought {
        let own = one.at(&one.segments[segment].members);
        let mut best = (0, None);
        for (index, &place) in free.iter().enumerate() {
            let equal = equal_residues(&own, &other.at(&other.segments[place].members));
            if equal > best.0 {
                best = (equal, Some(index));
            }
        }
        shared.push((segment, free.remove(best.1?)));
    }
    let pairs: Vec<(String, String)> = shared
        .into_iter()
        .map(|(own, place)| (name(&one, own), name(&other, place)))
        .collect();
    let mut rest: Vec<String> = Vec::new();
    for chain in free.into_iter().map(|place| name(&other, place)) {
        if !rest.contains(&chain) {
            rest.push(chain);
        }
    }
    if pairs.iter().any(|(_, taken)| rest.contains(taken)) {
        rest.clear();
    }
    Some(SharedChains { pairs, rest })
}

/// Equal residues of two chains of one sequence, loops that one of them lacks aside; 0 of other chains.
fn equal_residues(one: &[&Residue], other: &[&Residue]) -> usize {
    let least = MIN_EQUAL * one.len().max(other.len()) as f64;
    let kinds: HashSet<&str> = one.iter().map(|residue| residue.kind.as_str()).collect();
    if kinds.len() < MIN_KINDS || (one.len().min(other.len()) as f64) < least {
        return 0;
    }
    let equal = align(one, other).pairs.len();
    if equal as f64 >= least { equal } else { 0 }
}

fn name(residues: &Residues, segment: usize) -> String {
    residues.segments[segment].chain().to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::test_molecules::{chain_of, molecule, numbers, random_sequence};
    use super::*;

    fn of(chains: &[(&str, &str)]) -> Molecule {
        let atoms = chains
            .iter()
            .flat_map(|(name, letters)| chain_of(name, letters, &numbers(1, letters.len())));
        molecule(atoms.collect())
    }

    /// A user docked an inhibitor against the file of its complex: it was docked beside itself, without a word.
    #[test]
    fn a_complex_holds_its_own_chains() {
        let [enzyme, inhibitor] =
            [(1, 80), (2, 30)].map(|(seed, length)| random_sequence(seed, length));
        let complex = of(&[("E", &enzyme), ("I", &inhibitor)]);
        // The unbound form lacks its last residues.
        let ligand = of(&[("A", &inhibitor[..27])]);
        let found = shared_chains(&ligand, &complex).unwrap();
        assert_eq!(found.pairs, [("A".to_owned(), "I".to_owned())]);
        assert_eq!(found.rest, ["E"]);
        // Two chains of one name cannot be distinguished by it.
        let merged = of(&[("A", &enzyme), ("A", &inhibitor)]);
        assert_eq!(shared_chains(&ligand, &merged).unwrap().rest, [""; 0]);
        assert_eq!(shared_chains(&of(&[("E", &enzyme)]), &ligand), None);
        // Copies of one molecule are a homodimer's halves.
        assert_eq!(shared_chains(&complex, &complex), None);
        assert_eq!(shared_chains(&ligand, &ligand), None);
    }
}
