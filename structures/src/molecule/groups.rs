//! Residues as wholes: which atoms belong together, and what kind of group they make.

use std::collections::{HashMap, HashSet};

use serde::Serialize;

use super::Atom;
use super::residues::{is_amino_acid, is_nucleotide};

/// What a residue is, as far as it can be told from its name and atoms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GroupKind {
    /// One of the twenty amino acids, or a protonation variant of one.
    AminoAcid,
    /// An amino acid outside the twenty, linked or free: it has N, CA and C.
    ModifiedResidue,
    /// A nucleotide of DNA or RNA.
    Nucleotide,
    /// A sugar.
    Glycan,
    /// A metal ion.
    Metal,
    /// A cofactor, a ligand, a cap or anything else.
    Cofactor,
}

impl GroupKind {
    /// The kind in words, for a count of one and for more.
    pub(super) fn words(self, several: bool) -> &'static str {
        match (self, several) {
            (Self::AminoAcid, false) => "amino acid",
            (Self::AminoAcid, true) => "amino acids",
            (Self::ModifiedResidue, false) => "modified residue",
            (Self::ModifiedResidue, true) => "modified residues",
            (Self::Nucleotide, false) => "nucleotide",
            (Self::Nucleotide, true) => "nucleotides",
            (Self::Glycan, false) => "glycan",
            (Self::Glycan, true) => "glycans",
            (Self::Metal, false) => "metal",
            (Self::Metal, true) => "metals",
            (Self::Cofactor, false) => "cofactor or ligand",
            (Self::Cofactor, true) => "cofactors or ligands",
        }
    }
}

/// Residue names of the sugars met in glycoproteins and lectins (wwPDB Chemical Component Dictionary).
const GLYCANS: [&str; 30] = [
    "NAG", "NDG", "NGA", "A2G", "BMA", "MAN", "GAL", "GLA", "GLC", "BGC", "FUC", "FUL", "SIA",
    "SLB", "XYS", "XYP", "RAM", "RIB", "FRU", "GCS", "BDP", "GCU", "IDS", "SGN", "MAL", "SUC",
    "LAT", "TRE", "NGS", "M6P",
];

/// Elements whose ions count as metals; everything not listed is none.
const NON_METALS: [&str; 22] = [
    "H", "D", "He", "B", "C", "N", "O", "F", "Ne", "Si", "P", "S", "Cl", "Ar", "As", "Se", "Br",
    "Kr", "Te", "I", "Xe", "At",
];

/// What tells one residue from all others in a file: chain, number, insertion code, name.
pub(super) type ResidueKey<'a> = (&'a str, i64, Option<char>, &'a str);

/// The residue that an atom belongs to.
pub(super) fn residue_key(atom: &Atom) -> ResidueKey<'_> {
    (
        &atom.chain,
        atom.residue_number,
        atom.insertion_code,
        &atom.residue_name,
    )
}

/// One residue: its key, the indices of its atoms, and its kind.
pub(super) struct Residue<'a> {
    pub(super) key: ResidueKey<'a>,
    pub(super) atoms: Vec<usize>,
    pub(super) kind: GroupKind,
}

/// The residues of a list of atoms, in order of first appearance.
pub(super) fn residues(atoms: &[Atom]) -> Vec<Residue<'_>> {
    let mut place: HashMap<ResidueKey<'_>, usize> = HashMap::new();
    let mut grouped: Vec<(ResidueKey<'_>, Vec<usize>)> = Vec::new();
    for (index, atom) in atoms.iter().enumerate() {
        let key = residue_key(atom);
        let at = *place.entry(key).or_insert(grouped.len());
        match grouped.get_mut(at) {
            Some((_, members)) => members.push(index),
            None => grouped.push((key, vec![index])),
        }
    }
    grouped
        .into_iter()
        .map(|(key, members)| Residue {
            key,
            kind: kind(
                key.3,
                members.iter().filter_map(|&index| {
                    let atom = atoms.get(index)?;
                    Some((atom.name.as_str(), atom.element.as_str()))
                }),
            ),
            atoms: members,
        })
        .collect()
}

/// The residues of a list of atoms as they follow each other: where chains were merged under one name and numbers begin again, residues
/// that share a key stay apart.
pub(super) fn residue_runs(atoms: &[Atom]) -> Vec<Residue<'_>> {
    let mut runs = Vec::new();
    let mut first = 0;
    for run in atoms.chunk_by(|a, b| residue_key(a) == residue_key(b)) {
        let last = first + run.len();
        if let Some(atom) = run.first() {
            runs.push(Residue {
                key: residue_key(atom),
                atoms: (first..last).collect(),
                kind: kind(
                    &atom.residue_name,
                    run.iter()
                        .map(|atom| (atom.name.as_str(), atom.element.as_str())),
                ),
            });
        }
        first = last;
    }
    runs
}

/// The kind of a residue from its name and its atoms' names and elements.
pub(super) fn kind<'a>(
    residue_name: &str,
    atoms: impl Iterator<Item = (&'a str, &'a str)>,
) -> GroupKind {
    if matches!(residue_name, "MSE" | "SEC") {
        return GroupKind::ModifiedResidue;
    }
    if is_amino_acid(residue_name) {
        return GroupKind::AminoAcid;
    }
    if is_nucleotide(residue_name) {
        return GroupKind::Nucleotide;
    }
    if GLYCANS.contains(&residue_name) {
        return GroupKind::Glycan;
    }
    let atoms: Vec<(&str, &str)> = atoms.collect();
    if let [(_, element)] = atoms.as_slice()
        && !NON_METALS.contains(element)
    {
        return GroupKind::Metal;
    }
    let names: HashSet<&str> = atoms.iter().map(|(name, _)| *name).collect();
    if ["N", "CA", "C"].iter().all(|name| names.contains(name)) {
        GroupKind::ModifiedResidue
    } else if ["C1'", "C3'", "O3'"]
        .iter()
        .all(|name| names.contains(name))
        && names.contains("P")
    {
        // Modified nucleotides; free ones (ATP) have numbered phosphorus atoms.
        GroupKind::Nucleotide
    } else {
        GroupKind::Cofactor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str, atoms: &[(&str, &str)]) -> GroupKind {
        kind(name, atoms.iter().copied())
    }

    #[test]
    fn kinds_follow_names_and_atoms() {
        let backbone = [("N", "N"), ("CA", "C"), ("C", "C"), ("O", "O")];
        assert_eq!(of("HIE", &backbone), GroupKind::AminoAcid);
        assert_eq!(of("SEP", &backbone), GroupKind::ModifiedResidue);
        assert_eq!(of("MSE", &backbone), GroupKind::ModifiedResidue);
        assert_eq!(of("NAG", &[("C1", "C")]), GroupKind::Glycan);
        assert_eq!(of("ZN", &[("ZN", "Zn")]), GroupKind::Metal);
        assert_eq!(of("XE", &[("XE", "Xe")]), GroupKind::Cofactor);
        assert_eq!(of("HEM", &[("FE", "Fe"), ("NA", "N")]), GroupKind::Cofactor);
        assert_eq!(of("DG", &[("P", "P")]), GroupKind::Nucleotide);
        let psu = [("P", "P"), ("C1'", "C"), ("C3'", "C"), ("O3'", "O")];
        assert_eq!(of("PSU", &psu), GroupKind::Nucleotide);
        let atp = [("PG", "P"), ("C1'", "C"), ("C3'", "C"), ("O3'", "O")];
        assert_eq!(of("ATP", &atp), GroupKind::Cofactor);
    }
}
