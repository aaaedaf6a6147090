//! Names as the wwPDB has them today, for those that force fields and old files write.

use crate::molecule::chemistry::other_names::known_as;
use crate::molecule::chemistry::residues::{base, parent};
use crate::molecule::model::atom::Atom;

/// The plain name of a residue: of a protonation state or a disulphide's half the amino acid (`CYX` is `CYS`), of a
/// nucleotide its base as one letter (`DA`, `ADE` and `RA3` are `A`). Of all others the name itself.
pub fn plain_residue_name(residue_name: &str) -> &str {
    base(residue_name).unwrap_or_else(|| parent(residue_name))
}

/// The name under which the tables have a residue: that of a standard amino acid or of a state of one, else its own.
///
/// A standard amino acid under another name is recognised by its atoms or its name (`DAL` is `ALA`, `NHIE` is `HIE`).
pub fn standard_residue_name<'a>(
    residue_name: &'a str,
    atoms: impl IntoIterator<Item = &'a Atom>,
) -> &'a str {
    let atoms = atoms.into_iter();
    known_as(
        residue_name,
        atoms.map(|atom| (atom.name.as_str(), atom.element.as_str())),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::chemistry::atom_names::plain_atom_name;

    #[test]
    fn names_of_force_fields_and_old_files_become_plain() {
        for (name, plain) in [
            ("LSN", "LYS"),
            ("ARN", "ARG"),
            ("ASPP", "ASP"),
            ("HIM", "HIS"),
            ("CYZ", "CYS"),
            ("DA5", "A"),
            ("RA3", "A"),
            ("RU", "U"),
            ("URI", "U"),
            ("THY", "T"),
            ("ALA", "ALA"),
            ("HEM", "HEM"),
        ] {
            assert_eq!(plain_residue_name(name), plain);
        }
        for (name, plain) in [("O1P", "OP1"), ("C5*", "C5'"), ("O5'", "O5'"), ("CA", "CA")] {
            assert_eq!(plain_atom_name(name), plain);
        }
    }
}
