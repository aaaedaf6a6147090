//! One alternate location a residue.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use crate::molecule::model::{AlternateChoice, Atom, DropKind, Place, number_text, residue_key};
use crate::molecule::read::{AlternateLocation, Drops};
use crate::vector::squared_distance;

/// A position in a chain. The residue's name is left out: alternate locations may differ in it (microheterogeneity), and
/// one choice must hold for both names.
fn place(atom: &Atom) -> Place<'_> {
    residue_key(atom).place()
}

/// Stands for the blank location where atoms without a letter are one of the alternatives.
const UNNAMED: char = ' ';

/// Largest distance in Å of an atom from itself at another location: the tip of an arginine turned over.
const MAX_DISPLACEMENT: f64 = 12.0;

/// The same where the other location has another residue: backbones stay where they are.
const MAX_BACKBONE_DISPLACEMENT: f64 = 2.0;

/// Most lettered atoms of one name and residue that are compared with one without a letter: there are letters for some
/// 60, and more than one atom a letter is a mistake of the file.
const MAX_OF_NAME: usize = 1000;

#[derive(Default)]
struct Lettered<'a> {
    letters: HashMap<&'a str, BTreeSet<char>>,
    of_name: HashMap<&'a str, Vec<(&'a Atom, char)>>,
}

impl<'a> Lettered<'a> {
    fn add(&mut self, atom: &'a Atom, letter: char) {
        let letters = self.letters.entry(&atom.residue_name).or_default();
        letters.insert(letter);
        let of_name = self.of_name.entry(&atom.name).or_default();
        if of_name.len() < MAX_OF_NAME {
            of_name.push((atom, letter));
        }
    }
}

/// The locations of atoms that have no letter beside lettered atoms of their residue, by index.
///
/// If a lettered atom of the same name is elsewhere, they are the locations of the letters that lack that name: their
/// letter was left out. Else it is the blank location. The whole residue belongs to that if letters have another residue
/// on its backbone.
fn unnamed_alternatives(atoms: &[Atom]) -> HashMap<usize, Vec<char>> {
    let mut lettered: HashMap<Place<'_>, Lettered<'_>> = HashMap::new();
    for atom in atoms {
        if let Some(letter) = atom.alternate_location {
            lettered.entry(place(atom)).or_default().add(atom, letter);
        }
    }
    let mut unnamed = HashMap::new();
    if lettered.is_empty() {
        return unnamed;
    }
    // Residues of which one atom shows that they are an alternative as a whole.
    let mut whole: HashSet<(Place<'_>, &str)> = HashSet::new();
    let blank = || {
        let all = atoms.iter().enumerate();
        all.filter(|(_, atom)| atom.alternate_location.is_none())
    };
    for (index, atom) in blank() {
        let Some(there) = lettered.get(&place(atom)) else {
            continue;
        };
        let within = |other: &Atom, limit: f64| {
            squared_distance(other.position, atom.position) <= limit * limit
        };
        let of_name = there.of_name.get(atom.name.as_str());
        let of_residue = |own: bool| {
            let is_own = move |other: &Atom| (other.residue_name == atom.residue_name) == own;
            let of_name = of_name.into_iter().flatten();
            of_name.filter(move |(other, _)| is_own(other))
        };
        let no_letters = BTreeSet::new();
        let letters = there.letters.get(atom.residue_name.as_str());
        let letters = letters.unwrap_or(&no_letters);
        let having = of_residue(true).filter(|(other, _)| within(other, MAX_DISPLACEMENT));
        let having: BTreeSet<char> = having.map(|(_, letter)| *letter).collect();
        if !having.is_empty() {
            let lacking: Vec<char> = letters.difference(&having).copied().collect();
            let own = if lacking.is_empty() {
                vec![UNNAMED]
            } else {
                lacking
            };
            unnamed.insert(index, own);
        } else if letters.is_empty()
            && of_residue(false).any(|(other, _)| within(other, MAX_BACKBONE_DISPLACEMENT))
        {
            whole.insert((place(atom), &atom.residue_name));
        }
    }
    for (index, atom) in blank() {
        if whole.contains(&(place(atom), atom.residue_name.as_str())) {
            unnamed.insert(index, vec![UNNAMED]);
        }
    }
    unnamed
}

/// Keeps, in each residue, the atoms without an alternate location and those of one. Atoms without one beside the same
/// atoms with a letter are the blank one's. Kept is the one named by the policy where it is offered, otherwise the
/// location of the highest occupancy summed over its atoms, the alphabetically first of equals.
pub(crate) fn choose(
    mut atoms: Vec<Atom>,
    policy: AlternateLocation,
    drops: &mut Drops,
) -> Vec<Atom> {
    // The locations of each atom that has any, by its index.
    let mut locations = unnamed_alternatives(&atoms);
    let lettered = atoms.iter().enumerate();
    locations.extend(lettered.filter_map(|(i, atom)| Some((i, vec![atom.alternate_location?]))));
    let mut offers: HashMap<Place<'_>, BTreeMap<char, f64>> = HashMap::new();
    let mut order: Vec<Place<'_>> = Vec::new();
    for (index, atom) in atoms.iter().enumerate() {
        for &location in locations.get(&index).into_iter().flatten() {
            let offered = offers.entry(place(atom)).or_insert_with(|| {
                order.push(place(atom));
                BTreeMap::new()
            });
            *offered.entry(location).or_insert(0.0) += atom.occupancy;
        }
    }
    let mut chosen: HashMap<Place<'_>, char> = HashMap::new();
    for at in order {
        let offered = &offers[&at];
        // Occupancies are decimals: sums of the same ones in another order may differ in the last bits, which is no
        // preference.
        let best = offered.values().copied().fold(f64::MIN, f64::max);
        let by_occupancy = offered.iter().find(|(_, sum)| **sum > best - 1e-6);
        let named = match policy {
            AlternateLocation::Occupancy => None,
            AlternateLocation::Named(name) => offered.get_key_value(&name),
        };
        let Some((&location, _)) = named.or(by_occupancy) else {
            continue;
        };
        chosen.insert(at, location);
        if offered.len() > 1 {
            drops
                .report
                .altered
                .alternate_locations
                .push(AlternateChoice {
                    chain: at.0.to_owned(),
                    residue: number_text(at.1, at.2),
                    chosen: location,
                    offered: offered.keys().collect(),
                });
        }
    }
    let is_kept = |(index, atom): (usize, &Atom)| {
        let chosen = || chosen.get(&place(atom));
        let own = locations.get(&index);
        own.is_none_or(|own| chosen().is_some_and(|chosen| own.contains(chosen)))
    };
    let kept: Vec<bool> = atoms.iter().enumerate().map(is_kept).collect();
    let mut kept = kept.into_iter();
    atoms.retain(|atom| {
        let is_kept = kept.next() == Some(true);
        if !is_kept {
            drops.add(atom, DropKind::AlternateLocation);
        }
        is_kept
    });
    atoms
}
