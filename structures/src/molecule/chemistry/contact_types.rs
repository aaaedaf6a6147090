//! Contact types and kinds of amino acid atoms, from the table beside this file, which the scripts that derive
//! potentials read too.

use crate::molecule::chemistry::residues::{parent, standard_atom_name};
use std::collections::HashMap;
use std::sync::LazyLock;

/// Lines of `#`, a header, then residue,atom,type,kind.
const TABLE: &str = include_str!("contact_types.csv");

/// Names of the types; a type's number is its place here.
pub const CONTACT_TYPES: [&str; 18] = [
    "N", "CA", "C", "O", "GCA", "CB", "KNZ", "KCD", "DOD", "RNH", "NNN", "RNE", "SOG", "HNE",
    "YCZ", "FCZ", "LCD", "CSG",
];

/// What potentials know an atom by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AtomTypes {
    /// Place in [`CONTACT_TYPES`].
    pub contact: u8,
    /// Place in [`atom_kinds`].
    pub kind: u8,
}

/// Residue, atom, contact type and kind of each row.
fn rows() -> impl Iterator<Item = [&'static str; 4]> {
    let lines = TABLE.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| {
        // The table is part of the program, and tests read it.
        let fields = line.split(',').collect::<Vec<_>>().try_into();
        fields.unwrap_or_else(|_| unreachable!("contact_types.csv: not four fields in `{line}`"))
    })
}

static KINDS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let mut kinds = Vec::new();
    for [_, _, _, kind] in rows() {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    kinds
});

static TYPES: LazyLock<HashMap<(&'static str, &'static str), AtomTypes>> = LazyLock::new(|| {
    let place = |names: &[&str], name: &str| {
        let place = names.iter().position(|known| *known == name);
        place
            .and_then(|place| u8::try_from(place).ok())
            .unwrap_or_else(|| unreachable!("contact_types.csv: no type or kind `{name}`"))
    };
    rows()
        .map(|[residue, atom, contact, kind]| {
            let types = AtomTypes {
                contact: place(&CONTACT_TYPES, contact),
                kind: place(&KINDS, kind),
            };
            ((residue, atom), types)
        })
        .collect()
});

/// Names of the kinds of amino acid atoms, residue and atom as in `ARG_CZ`; a kind's number is its place here.
///
/// Atoms that a rotation or a proton's choice makes alike are of one kind. These are the oxygens of a carboxylate, both
/// sides of a ring, and the two methyls of valine and of leucine, whose names files exchange.
pub fn atom_kinds() -> &'static [&'static str] {
    &KINDS
}

/// Contact type and kind of an atom; `None` outside the amino acids of the table.
pub(crate) fn atom_types(residue_name: &str, atom_name: &str) -> Option<AtomTypes> {
    let name = standard_atom_name(residue_name, atom_name);
    TYPES.get(&(parent(residue_name), name)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::chemistry::residues::{amino_acid_type, side_chain};

    #[test]
    fn every_atom_of_the_twenty_has_a_type() {
        let rows = TABLE.lines().filter(|line| !line.starts_with('#')).count() - 1;
        assert_eq!(TYPES.len(), rows);
        for name in [
            "ALA", "ARG", "ASN", "ASP", "CYS", "GLN", "GLU", "GLY", "HIS", "ILE", "LEU", "LYS",
            "MET", "PHE", "PRO", "SER", "THR", "TRP", "TYR", "VAL", "MSE", "SEC",
        ] {
            for (atom, _) in side_chain(name).unwrap() {
                assert!(atom_types(name, atom).is_some(), "{name} {atom}");
            }
            for atom in ["N", "CA", "C", "O", "OXT"] {
                assert!(atom_types(name, atom).is_some(), "{name} {atom}");
            }
        }
        // Nor does the table name an atom that no residue has.
        for (residue, atom) in TYPES.keys() {
            assert!(amino_acid_type(residue, atom).is_some(), "{residue} {atom}");
        }
        assert_eq!(atom_types("HSD", "ND1"), atom_types("HIS", "ND1"));
        assert_eq!(atom_types("HEM", "CA"), None);
        // 167 atoms without OXT, of which nine are alike by symmetry.
        assert_eq!(atom_kinds().len(), 158);
        let kind = |residue, atom| atom_types(residue, atom).unwrap().kind;
        assert_eq!(kind("ARG", "NH1"), kind("ARG", "NH2"));
        assert_ne!(kind("ALA", "CB"), kind("SER", "CB"));
        assert_eq!(atom_kinds()[usize::from(kind("ALA", "OXT"))], "ALA_O");
    }
}
