//! Chains as sequences: runs of amino acids, their letters and their numbers.

use super::groups::{GroupKind, Residue};
use super::residues::parent;

/// Runs of amino acids that stand in one chain, each in file order.
pub(super) fn peptides<'a, 'b>(groups: &'b [Residue<'a>]) -> Vec<&'b [Residue<'a>]> {
    let is_peptide = |residue: &Residue<'_>| {
        matches!(
            residue.kind,
            GroupKind::AminoAcid | GroupKind::ModifiedResidue
        )
    };
    groups
        .chunk_by(|a, b| a.key.0 == b.key.0 && is_peptide(a) == is_peptide(b))
        .filter(|run| run.first().is_some_and(is_peptide))
        .collect()
}

/// A residue's number with its insertion code.
pub(super) fn number(residue: &Residue<'_>) -> String {
    let (_, number, insertion, _) = residue.key;
    match insertion {
        Some(insertion) => format!("{number}{insertion}"),
        None => number.to_string(),
    }
}

/// One letter of an amino acid, X of one outside the twenty.
pub(super) fn letter(residue_name: &str) -> char {
    match parent(residue_name) {
        "ALA" => 'A',
        "ARG" => 'R',
        "ASN" => 'N',
        "ASP" => 'D',
        "CYS" | "SEC" => 'C',
        "GLN" => 'Q',
        "GLU" => 'E',
        "GLY" => 'G',
        "HIS" => 'H',
        "ILE" => 'I',
        "LEU" => 'L',
        "LYS" => 'K',
        "MET" | "MSE" => 'M',
        "PHE" => 'F',
        "PRO" => 'P',
        "SER" => 'S',
        "THR" => 'T',
        "TRP" => 'W',
        "TYR" => 'Y',
        "VAL" => 'V',
        _ => 'X',
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::molecule::Atom;

    /// The atoms of such `names` of each residue of a chain, numbered from `first`, all of them where `position` has their residue's number; X is a residue
    /// of an unknown name.
    pub fn chain(
        chain: &str,
        sequence: &str,
        first: i64,
        names: &[&str],
        position: impl Fn(i64) -> [f64; 3],
    ) -> Vec<Atom> {
        const RESIDUES: [&str; 20] = [
            "ALA", "ARG", "ASN", "ASP", "CYX", "GLN", "GLU", "GLY", "HIE", "ILE", "LEU", "LYS",
            "MSE", "PHE", "PRO", "SER", "THR", "TRP", "TYR", "VAL",
        ];
        let atom = |number: i64, one: char, name: &str| Atom {
            name: name.to_owned(),
            residue_name: RESIDUES
                .iter()
                .find(|name| letter(name) == one)
                .map_or("XYZ", |name| name)
                .to_string(),
            chain: chain.to_owned(),
            residue_number: number,
            insertion_code: None,
            alternate_location: None,
            element: "C".to_owned(),
            position: position(number),
            occupancy: 1.0,
            b_factor: 0.0,
            hetero: false,
            radius: 1.9,
            line: 1,
        };
        let mut atoms = Vec::new();
        for (number, one) in (first..).zip(sequence.chars()) {
            atoms.extend(names.iter().map(|name| atom(number, one, name)));
        }
        atoms
    }
}
