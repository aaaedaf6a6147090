//! The warning of ligands that are kept though nothing but their shape is known.

use std::collections::BTreeMap;

use crate::molecule::chemistry::charge_table::cofactor;
use crate::molecule::chemistry::residues::is_water;
use crate::molecule::model::atom::Atom;
use crate::molecule::model::groups::{GroupKind, Residue};
use crate::molecule::model::wording::count;

/// Fewest heavy atoms of what counts as a ligand: caps of chains and small ions have fewer.
const MIN_ATOMS: usize = 6;

/// Most ligands that are named.
const NAMED: usize = 3;

/// A warning where ligands are kept that have neither charges nor contact types: an inhibitor fills the site that the
/// partner would take.
pub(crate) fn warning(atoms: &[Atom], groups: &[Residue<'_>]) -> Option<String> {
    let mut found: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    let mut hetero = false;
    for group in groups {
        let members = || group.atoms.iter().filter_map(|&index| atoms.get(index));
        let heavy = members().filter(|atom| !atom.is_hydrogen()).count();
        let name = group.key.3;
        let is_unknown = group.kind == GroupKind::Cofactor && cofactor(name).is_none();
        if is_unknown && heavy >= MIN_ATOMS && !is_water(name) {
            let (residues, atoms) = found.entry(name).or_default();
            *residues += 1;
            *atoms += heavy;
            hetero |= members().any(|atom| atom.hetero);
        }
    }
    if found.is_empty() {
        return None;
    }
    let named = found.iter().take(NAMED);
    let mut ligands = named
        .map(|(name, (residues, atoms))| {
            format!("{residues} {name} ({})", count(*atoms, "heavy atom"))
        })
        .collect::<Vec<_>>()
        .join(", ");
    if found.len() > NAMED {
        ligands += &format!(" and {} more", count(found.len() - NAMED, "kind"));
    }
    let names: Vec<&str> = found.keys().copied().collect();
    let mut remedies = vec![format!("--drop-residue {}", names.join(","))];
    if hetero {
        remedies.insert(0, "--hetatm drop".to_owned());
    }
    Some(format!(
        "small molecules are kept as solid atoms without charges or contact types, which are not known: {ligands}; if one fills the \
         binding site, leave it out with {}",
        remedies.join(" or ")
    ))
}
