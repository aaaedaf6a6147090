//! Contact types of amino acid atoms, from the table beside this file, which the script that derives the potential reads too.

use super::residues::parent;
use std::collections::HashMap;
use std::sync::LazyLock;

/// Lines of `#`, a header, then residue,atom,type.
const TABLE: &str = include_str!("contact_types.csv");

/// Names of the types; a type's number is its place here.
pub const CONTACT_TYPES: [&str; 18] = [
    "N", "CA", "C", "O", "GCA", "CB", "KNZ", "KCD", "DOD", "RNH", "NNN", "RNE", "SOG", "HNE",
    "YCZ", "FCZ", "LCD", "CSG",
];

static TYPES: LazyLock<HashMap<(&'static str, &'static str), u8>> = LazyLock::new(|| {
    TABLE
        .lines()
        .filter(|line| !line.starts_with('#'))
        .skip(1)
        .filter_map(|line| {
            let mut fields = line.split(',');
            let (residue, atom, name) = (fields.next()?, fields.next()?, fields.next()?);
            let number = CONTACT_TYPES.iter().position(|known| *known == name)?;
            Some(((residue, atom), u8::try_from(number).ok()?))
        })
        .collect()
});

/// The contact type of an atom; `None` outside the amino acids of the table.
pub(super) fn contact_type(residue_name: &str, atom_name: &str) -> Option<u8> {
    let name = match (parent(residue_name), atom_name) {
        ("ILE", "CD") => "CD1",
        (_, "OT1" | "OT2" | "O1" | "O2" | "OT") => "OXT",
        (_, other) => other,
    };
    TYPES.get(&(parent(residue_name), name)).copied()
}

#[cfg(test)]
mod tests {
    use super::super::residues::{amino_acid_type, side_chain};
    use super::*;

    #[test]
    fn every_atom_of_the_twenty_has_a_type() {
        let rows = TABLE.lines().filter(|line| !line.starts_with('#')).count() - 1;
        assert_eq!(TYPES.len(), rows);
        for name in [
            "ALA", "ARG", "ASN", "ASP", "CYS", "GLN", "GLU", "GLY", "HIS", "ILE", "LEU", "LYS",
            "MET", "PHE", "PRO", "SER", "THR", "TRP", "TYR", "VAL", "MSE", "SEC",
        ] {
            for (atom, _) in side_chain(name).unwrap() {
                assert!(contact_type(name, atom).is_some(), "{name} {atom}");
            }
            for atom in ["N", "CA", "C", "O", "OXT"] {
                assert!(contact_type(name, atom).is_some(), "{name} {atom}");
            }
        }
        // Nor does the table name an atom that no residue has.
        for (residue, atom) in TYPES.keys() {
            assert!(amino_acid_type(residue, atom).is_some(), "{residue} {atom}");
        }
        assert_eq!(contact_type("HSD", "ND1"), contact_type("HIS", "ND1"));
        assert_eq!(contact_type("HEM", "CA"), None);
    }
}
