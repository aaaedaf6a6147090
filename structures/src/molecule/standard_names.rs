//! Names as the wwPDB has them today, for those that force fields and old files write.

use std::borrow::Cow;

use super::Atom;
use super::other_names::known_as;
use super::residues::{base, parent};

/// The plain name of a residue: of a protonation state or a disulphide's half the amino acid (`CYX` is `CYS`), of a nucleotide its base as one
/// letter (`DA`, `ADE` and `RA3` are `A`). Of all others the name itself.
pub fn plain_residue_name(residue_name: &str) -> &str {
    base(residue_name).unwrap_or_else(|| parent(residue_name))
}

/// The name under which the tables have a residue: that of a standard amino acid, or of a state of one, where its atoms or its name show that it
/// is one under another name (`DAL` is `ALA`, `NHIE` is `HIE`); else its own.
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

/// The plain name of an atom: `'` where files from before the remediation of 2007 have `*` in a sugar, and `OP1` for their `O1P`.
pub fn plain_atom_name(atom_name: &str) -> Cow<'_, str> {
    match atom_name {
        "O1P" => Cow::Borrowed("OP1"),
        "O2P" => Cow::Borrowed("OP2"),
        "O3P" => Cow::Borrowed("OP3"),
        starred if starred.contains('*') => Cow::Owned(starred.replace('*', "'")),
        plain => Cow::Borrowed(plain),
    }
}

/// Whether an atom of this name shows that a residue of a nucleotide's name is one: it links a sugar to its neighbour. Ruthenium (`RU`), indium
/// iodide (`IN`) and a thyroid hormone (`T3`) are named like nucleotides.
pub(super) fn links_nucleotides(atom_name: &str) -> bool {
    matches!(plain_atom_name(atom_name).as_ref(), "P" | "O3'" | "O5'")
}

#[cfg(test)]
mod tests {
    use super::*;

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
