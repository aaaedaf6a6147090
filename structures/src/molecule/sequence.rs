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
