//! One alternate location a residue.

use std::collections::{BTreeMap, HashMap};

use super::Atom;
use super::policy::AlternateLocation;
use super::report::{AlternateChoice, DropKind, ReadReport};

/// What tells a position in the chain from all others. The residue's name is left out: alternate locations may differ in it
/// (microheterogeneity), and one choice must hold for both names.
type Position<'a> = (&'a str, i64, Option<char>);

fn position(atom: &Atom) -> Position<'_> {
    (&atom.chain, atom.residue_number, atom.insertion_code)
}

/// Keeps, in each residue, the atoms without an alternate location and those of one: the one named by the policy where it is
/// offered, otherwise the location of the highest occupancy summed over its atoms, the alphabetically first of equals.
pub(super) fn choose(
    atoms: Vec<Atom>,
    policy: AlternateLocation,
    report: &mut ReadReport,
    dropped: &mut dyn FnMut(Atom, DropKind),
) -> Vec<Atom> {
    let mut offers: HashMap<Position<'_>, BTreeMap<char, f64>> = HashMap::new();
    let mut order: Vec<Position<'_>> = Vec::new();
    for atom in &atoms {
        if let Some(location) = atom.alternate_location {
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
        .map(|atom| {
            atom.alternate_location.is_none()
                || atom.alternate_location == chosen.get(&position(atom)).copied()
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
