//! Atoms on top of atoms of other residues: chains, copies and residues that a file holds twice in one place.

use std::collections::{BTreeMap, BTreeSet};

use crate::molecule::model::atom::{Atom, squared_distance};
use crate::molecule::model::groups::{Residue, ResidueKey};
use crate::molecule::model::wording::{count, show_chain};
use crate::neighbours::SpatialHash;

/// Distance in Å below which atoms of different residues are in one place. Bonded ones are separated by more than 1.2
/// Å, except hydrogens.
const ON_TOP: f64 = 0.5;

/// The same of fewer than [`FEW`] atoms between two chains, which come to lie so by chance where bodies overlap.
const IN_ONE_PLACE: f64 = 0.1;
const FEW: usize = 3;

/// The same of residues of one number and different names, which are alternatives of one place.
const ONE_NUMBER: f64 = 1.2;

/// Most atoms of a cell that are looked at: where there are more, they are counted as far as these show.
const MAX_IN_CELL: usize = 64;

/// Residues that are shown as examples.
const SHOWN: usize = 3;

/// Warnings about atoms of different residues in one place.
pub(crate) fn warnings(atoms: &[Atom], residues: &[Residue<'_>]) -> Vec<String> {
    // Atoms without any place of their own have a warning of their own, or are made up.
    let mut places = atoms.iter().map(|atom| atom.position);
    let first = places.next();
    if places.all(|place| Some(place) == first) {
        return Vec::new();
    }
    let pairs = on_top(atoms, residues);
    let mut one_number = BTreeSet::new();
    // By the two chains: the atoms of the second on the first, their least distance squared, and their residues.
    let mut on: BTreeMap<(&str, &str), (usize, f64, BTreeSet<usize>)> = BTreeMap::new();
    for (residue, other, squared) in pairs {
        let (Some(own), Some(there)) = (residues.get(residue), residues.get(other)) else {
            continue;
        };
        if is_one_number(own.key, there.key) {
            one_number.insert((other, residue));
        } else {
            let chains = (there.key.0, own.key.0);
            let none = || (0, f64::INFINITY, BTreeSet::new());
            let (count, least, named) = on.entry(chains).or_insert_with(none);
            *count += 1;
            *least = least.min(squared);
            named.insert(residue);
        }
    }
    let mut warnings: Vec<String> = on
        .iter()
        .filter(|(_, (atoms, least, _))| *atoms >= FEW || *least < IN_ONE_PLACE * IN_ONE_PLACE)
        .map(|((first, second), (atoms, _, named))| {
            in_words(first, second, *atoms, named, residues)
        })
        .collect();
    if !one_number.is_empty() {
        let examples = one_number
            .iter()
            .take(SHOWN)
            .filter_map(|&(first, second)| {
                let (chain, number, insertion, name) = residues.get(first)?.key;
                let insertion = insertion.map_or(String::new(), String::from);
                let other = residues.get(second)?.key.3;
                Some(format!(
                    "{} {number}{insertion} as {name} and {other}",
                    show_chain(chain)
                ))
            });
        let examples: Vec<String> = examples.collect();
        let more = if one_number.len() > SHOWN {
            ", ..."
        } else {
            ""
        };
        let places = count(one_number.len(), "residue number");
        let stand = if one_number.len() == 1 {
            "holds"
        } else {
            "hold"
        };
        warnings.push(format!(
            "{places} {stand} two residues in one place ({}{more}), and all their atoms are counted: keep one in the file, or mark them as \
             alternate locations",
            examples.join(", ")
        ));
    }
    warnings
}

fn in_words(
    first: &str,
    second: &str,
    atoms: usize,
    named: &BTreeSet<usize>,
    residues: &[Residue<'_>],
) -> String {
    let lie = if atoms == 1 { "lies" } else { "lie" };
    let atoms = count(atoms, "atom");
    let chain = show_chain(second);
    if first == second {
        let examples = named.iter().take(SHOWN).filter_map(|&residue| {
            let (_, number, insertion, name) = residues.get(residue)?.key;
            let insertion = insertion.map_or(String::new(), String::from);
            Some(format!("{name} {chain} {number}{insertion}"))
        });
        let examples: Vec<String> = examples.collect();
        let more = if named.len() > SHOWN { ", ..." } else { "" };
        format!(
            "{atoms} of chain {chain} {lie} on atoms of its other residues ({}{more}), and all are counted: are residues there twice?",
            examples.join(", ")
        )
    } else {
        let first = show_chain(first);
        format!(
            "{atoms} of chain {chain} {lie} on atoms of chain {first}, and all are counted: are these copies or \
             models of one molecule? FILE:{first} \
             reads one"
        )
    }
}

/// Whether two residues are alternatives of one number.
fn is_one_number(a: ResidueKey<'_>, b: ResidueKey<'_>) -> bool {
    (a.0, a.1, a.2) == (b.0, b.1, b.2) && a.3 != b.3
}

/// For each atom that lies on one of an earlier residue, its own residue, that one, and the square of their distance
/// (Å²).
fn on_top(atoms: &[Atom], residues: &[Residue<'_>]) -> Vec<(usize, usize, f64)> {
    let mut residue_of = vec![usize::MAX; atoms.len()];
    for (index, residue) in residues.iter().enumerate() {
        for &atom in &residue.atoms {
            if let Some(place) = residue_of.get_mut(atom) {
                *place = index;
            }
        }
    }
    let positions = atoms.iter().map(|atom| atom.position);
    let cells = SpatialHash::of_crowded_points(positions, ONE_NUMBER, MAX_IN_CELL);
    let is_on = |residue: usize, other: usize, squared: f64| {
        let (Some(own), Some(there)) = (residues.get(residue), residues.get(other)) else {
            return false;
        };
        // What repeats the residue and the name of another has a warning of its own.
        let limit = if is_one_number(own.key, there.key) {
            ONE_NUMBER
        } else {
            ON_TOP
        };
        own.key != there.key && squared < limit * limit
    };
    let mut found = Vec::new();
    for (atom, &residue) in atoms.iter().zip(&residue_of) {
        let mut others = cells.around(atom.position).copied().filter_map(|index| {
            let (there, &other) = (atoms.get(index)?, residue_of.get(index)?);
            let squared = squared_distance(there.position, atom.position);
            (other < residue && is_on(residue, other, squared)).then_some((other, squared))
        });
        let first = others.next();
        found.extend(first.map(|(other, squared)| (residue, other, squared)));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::model::format::Format;
    use crate::molecule::model::groups::residues;
    use crate::molecule::model::molecule::Molecule;

    /// Residues of a chain along x, 4 Å apart, each with three atoms.
    fn chain(name: &str, residue_name: &str, numbers: std::ops::Range<i64>, y: f64) -> Vec<Atom> {
        let atom = |number: i64, place: i64| Atom {
            name: ["N", "CA", "C"][place as usize].to_owned(),
            residue_name: residue_name.to_owned(),
            chain: name.to_owned(),
            residue_number: number,
            insertion_code: None,
            alternate_location: None,
            element: "C".to_owned(),
            position: [4.0 * number as f64 + 1.3 * place as f64, y, 0.0],
            occupancy: 1.0,
            b_factor: 10.0,
            hetero: false,
            radius: 1.7,
            line: 1,
        };
        numbers
            .flat_map(|number| (0..3).map(move |place| atom(number, place)))
            .collect()
    }

    fn of(atoms: &[Vec<Atom>]) -> Vec<String> {
        let molecule = Molecule::new(atoms.concat(), Format::Pdb);
        warnings(&molecule.atoms, &residues(&molecule.atoms))
    }

    #[test]
    fn chains_and_residues_in_one_place_are_named() {
        let first = chain("A", "ALA", 1..11, 0.0);
        assert!(of(&[first.clone(), chain("B", "ALA", 1..11, 3.0)]).is_empty());
        let warned = of(&[first.clone(), chain("B", "ALA", 1..11, 0.1)]);
        assert_eq!(warned.len(), 1);
        assert!(
            warned[0].starts_with("30 atoms of chain B lie on atoms of chain A"),
            "{warned:?}"
        );
        // Bodies that overlap have an atom on another by chance; an ion given twice is in one place.
        let ion = |x: f64| {
            let mut ion = chain("C", "ZN", 1..2, 0.0);
            ion.truncate(1);
            ion[0].position[0] = 4.0 + x;
            ion
        };
        assert!(of(&[first.clone(), ion(0.3)]).is_empty());
        let warned = of(&[first.clone(), ion(0.0)]);
        assert!(
            warned[0].starts_with("1 atom of chain C lies on atoms of chain A"),
            "{warned:?}"
        );
        // Two names at one number, on one another and a little apart.
        for y in [0.0, 0.9] {
            let warned = of(&[first.clone(), chain("A", "SER", 5..6, y)]);
            assert_eq!(warned.len(), 1);
            assert!(
                warned[0].starts_with(
                    "1 residue number holds two residues in one place (A 5 as ALA and SER)"
                ),
                "{warned:?}"
            );
        }
        // Merged chains may repeat a number elsewhere.
        assert!(of(&[first.clone(), chain("A", "SER", 5..6, 9.0)]).is_empty());
        // Other numbers in one place.
        let mut shifted = chain("A", "ALA", 1..11, 0.0);
        for atom in &mut shifted {
            atom.residue_number += 100;
        }
        let warned = of(&[first, shifted]);
        assert!(
            warned[0].contains("of its other residues (ALA A 101, ALA A 102, ALA A 103, ...)"),
            "{warned:?}"
        );
    }

    /// Atoms without places of their own must not cost the square of their number.
    #[test]
    fn many_atoms_in_one_place_take_no_longer_than_others() {
        let mut atoms = chain("A", "ALA", 1..20_001, 0.0);
        for atom in &mut atoms {
            atom.position = [0.0; 3];
        }
        assert!(of(std::slice::from_ref(&atoms)).is_empty());
        let last = atoms.len() - 1;
        atoms[last].position = [9.0; 3];
        assert_eq!(of(&[atoms]).len(), 1);
    }
}
