//! The element of a PDB record: columns 77-78, or the atom type of AutoDock in columns 78-79 of PDBQT.
//!
//! PDBQT is PDB with a partial charge in columns 71-76 and an atom type behind it (AutoDock 4.2 User Guide). Chlorine
//! and the metals have types of two letters, of which columns 77-78 hold but the first.

use crate::molecule::read::record_filter::record::number;

/// Types of AutoDock that are not named after their element.
const TYPES: [(&str, &str); 9] = [
    ("A", "C"),
    ("HD", "H"),
    ("HS", "H"),
    ("NA", "N"),
    ("NS", "N"),
    ("OA", "O"),
    ("OS", "O"),
    ("SA", "S"),
    ("G", "C"),
];

/// The element as the record has it; may be empty or nonsense.
pub(crate) fn element(record: &str) -> &str {
    let columns = |from: usize, to: usize| record.get(from..to.min(record.len())).unwrap_or("");
    if !has_partial_charge(record) {
        return columns(76, 78).trim();
    }
    let kind = columns(77, 79).trim();
    let other = TYPES.iter().find(|(known, _)| *known == kind);
    other.map_or(kind, |(_, element)| element)
}

/// Whether a record has PDBQT's partial charge.
pub(crate) fn has_partial_charge(record: &str) -> bool {
    let charge = record.get(70..76).unwrap_or("").trim();
    charge.contains('.') && number(charge).is_some() && record.get(76..77) == Some(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_of_autodock_are_read_as_elements() {
        let head = "HETATM    1  C1  LIG A   1      16.792  12.871   4.991  1.00  0.00";
        for (tail, expected) in [
            ("    +0.123 A ", "C"),
            ("    -0.346 OA", "O"),
            ("    -0.080 Cl", "Cl"),
            ("     0.500 Zn", "Zn"),
            ("    -0.346 N ", "N"),
            ("    -0.346 NA", "N"),
            ("     0.163 HD", "H"),
            ("           C  ", "C"),
            ("      A    C", "C"),
            ("          CL1-", "CL"),
            ("", ""),
        ] {
            assert_eq!(element(&format!("{head}{tail}")), expected, "{tail:?}");
        }
    }
}
