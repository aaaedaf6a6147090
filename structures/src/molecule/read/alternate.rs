//! One alternate location a residue.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use crate::molecule::model::atom::{Atom, squared_distance};
use crate::molecule::model::report::{AlternateChoice, DropKind, ReadReport};
use crate::molecule::read::policy::AlternateLocation;

/// What distinguishes a position in the chain from all others. The residue's name is left out: alternate locations may
/// differ in it (microheterogeneity), and one choice must hold for both names.
type Position<'a> = (&'a str, i64, Option<char>);

fn position(atom: &Atom) -> Position<'_> {
    (&atom.chain, atom.residue_number, atom.insertion_code)
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

/// The lettered atoms of a residue.
#[derive(Default)]
struct Lettered<'a> {
    /// Letters by the residue's name.
    letters: HashMap<&'a str, BTreeSet<char>>,
    /// Atoms with their letters by the atom's name.
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
/// Where a lettered atom of the same name is elsewhere, they are the locations of the letters that lack that name:
/// their letter was left out. Else it is the blank location. The whole residue belongs to that if letters have another
/// residue on its backbone.
fn unnamed_alternatives(atoms: &[Atom]) -> HashMap<usize, Vec<char>> {
    let mut lettered: HashMap<Position<'_>, Lettered<'_>> = HashMap::new();
    for atom in atoms {
        if let Some(letter) = atom.alternate_location {
            lettered
                .entry(position(atom))
                .or_default()
                .add(atom, letter);
        }
    }
    let mut unnamed = HashMap::new();
    if lettered.is_empty() {
        return unnamed;
    }
    // Residues of which one atom shows that they are an alternative as a whole.
    let mut whole: HashSet<(Position<'_>, &str)> = HashSet::new();
    let blank = || {
        let all = atoms.iter().enumerate();
        all.filter(|(_, atom)| atom.alternate_location.is_none())
    };
    for (index, atom) in blank() {
        let Some(there) = lettered.get(&position(atom)) else {
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
            whole.insert((position(atom), &atom.residue_name));
        }
    }
    for (index, atom) in blank() {
        if whole.contains(&(position(atom), atom.residue_name.as_str())) {
            unnamed.insert(index, vec![UNNAMED]);
        }
    }
    unnamed
}

/// Keeps, in each residue, the atoms without an alternate location and those of one. Atoms without one beside the same
/// atoms with a letter are the blank one's. Kept is the one named by the policy where it is offered, otherwise the
/// location of the highest occupancy summed over its atoms, the alphabetically first of equals.
pub(crate) fn choose(
    atoms: Vec<Atom>,
    policy: AlternateLocation,
    report: &mut ReadReport,
    dropped: &mut dyn FnMut(Atom, DropKind),
) -> Vec<Atom> {
    let mut offers: HashMap<Position<'_>, BTreeMap<char, f64>> = HashMap::new();
    let mut order: Vec<Position<'_>> = Vec::new();
    let unnamed = unnamed_alternatives(&atoms);
    let locations = |index: usize, atom: &Atom| -> Vec<char> {
        match (atom.alternate_location, unnamed.get(&index)) {
            (Some(letter), _) => vec![letter],
            (None, Some(own)) => own.clone(),
            (None, None) => Vec::new(),
        }
    };
    for (index, atom) in atoms.iter().enumerate() {
        for location in locations(index, atom) {
            let offered = offers.entry(position(atom)).or_insert_with(|| {
                order.push(position(atom));
                BTreeMap::new()
            });
            *offered.entry(location).or_insert(0.0) += atom.occupancy;
        }
    }
    if order.is_empty() {
        return atoms;
    }
    let mut chosen: HashMap<Position<'_>, char> = HashMap::new();
    for at in order {
        let Some(offered) = offers.get(&at) else {
            continue;
        };
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
            report.altered.alternate_locations.push(AlternateChoice {
                chain: at.0.to_string(),
                residue: format!("{}{}", at.1, at.2.map_or(String::new(), String::from)),
                chosen: location,
                offered: offered.keys().collect(),
            });
        }
    }
    let keep: Vec<bool> = atoms
        .iter()
        .enumerate()
        .map(|(index, atom)| {
            let own = locations(index, atom);
            let chosen = chosen.get(&position(atom));
            own.is_empty() || chosen.is_some_and(|chosen| own.contains(chosen))
        })
        .collect();
    let mut kept = Vec::with_capacity(atoms.len());
    for (atom, keep) in atoms.into_iter().zip(keep) {
        if keep {
            kept.push(atom);
        } else {
            report.drop_atoms(DropKind::AlternateLocation, &atom.residue_name, 1);
            dropped(atom, DropKind::AlternateLocation);
        }
    }
    kept
}
