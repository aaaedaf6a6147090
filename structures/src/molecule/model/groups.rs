//! Residues as wholes: which atoms belong together, and the kind of their group.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::fmt;
use std::ops::Range;

use crate::molecule::chemistry::{
    is_amino_acid, is_metal, is_nucleotide, known_as, links_nucleotides, plain_atom_name,
};
use crate::molecule::model::{Atom, show_chain};
use serde::Serialize;

/// Kind of a residue, detected from its name and atoms.
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
    pub(crate) fn words(self, several: bool) -> &'static str {
        let words = match self {
            Self::AminoAcid => ["amino acid", "amino acids"],
            Self::ModifiedResidue => ["modified residue", "modified residues"],
            Self::Nucleotide => ["nucleotide", "nucleotides"],
            Self::Glycan => ["glycan", "glycans"],
            Self::Metal => ["metal", "metals"],
            Self::Cofactor => ["cofactor or ligand", "cofactors or ligands"],
        };
        words[usize::from(several)]
    }
}

/// Residue names of the sugars met in glycoproteins and lectins (wwPDB Chemical Component Dictionary).
const GLYCANS: [&str; 30] = [
    "NAG", "NDG", "NGA", "A2G", "BMA", "MAN", "GAL", "GLA", "GLC", "BGC", "FUC", "FUL", "SIA",
    "SLB", "XYS", "XYP", "RAM", "RIB", "FRU", "GCS", "BDP", "GCU", "IDS", "SGN", "MAL", "SUC",
    "LAT", "TRE", "NGS", "M6P",
];

pub(crate) type Place<'a> = (&'a str, i64, Option<char>);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ResidueKey<'a> {
    pub(crate) chain: &'a str,
    pub(crate) number: i64,
    pub(crate) insertion: Option<char>,
    pub(crate) name: &'a str,
}

impl<'a> ResidueKey<'a> {
    pub(crate) fn place(self) -> Place<'a> {
        (self.chain, self.number, self.insertion)
    }

    pub(crate) fn number_text(self) -> String {
        number_text(self.number, self.insertion)
    }
}

impl fmt::Display for ResidueKey<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (chain, number) = (show_chain(self.chain), self.number_text());
        write!(f, "{} {chain} {number}", self.name)
    }
}

/// A residue's number with its insertion code, e.g. `52A`.
pub(crate) fn number_text(number: i64, insertion: Option<char>) -> String {
    number.to_string() + insertion.map_or(String::new(), String::from).as_str()
}

pub(crate) fn residue_key(atom: &Atom) -> ResidueKey<'_> {
    ResidueKey {
        chain: &atom.chain,
        number: atom.residue_number,
        insertion: atom.insertion_code,
        name: &atom.residue_name,
    }
}

/// One residue: its key, the name under which the tables have it, the indices of its atoms, and its kind.
pub(crate) struct Residue<'a> {
    pub(crate) key: ResidueKey<'a>,
    /// A standard amino acid's name where it is one under another (`other_names`), else its own.
    pub(crate) known_as: &'a str,
    pub(crate) atoms: Vec<usize>,
    pub(crate) kind: GroupKind,
}

impl<'a> Residue<'a> {
    fn new(key: ResidueKey<'a>, members: Vec<usize>, atoms: &'a [Atom]) -> Self {
        let names = || {
            let members = members.iter().map(|&index| &atoms[index]);
            members.map(|atom| (atom.name.as_str(), atom.element.as_str()))
        };
        let known_as = known_as(key.name, names());
        Self {
            key,
            known_as,
            kind: kind(known_as, names()),
            atoms: members,
        }
    }
}

impl Residue<'_> {
    /// Its atoms, of those of the molecule.
    pub(crate) fn members<'b>(&self, atoms: &'b [Atom]) -> impl Iterator<Item = &'b Atom> + Clone {
        self.atoms.iter().map(|&index| &atoms[index])
    }

    pub(crate) fn is_peptide(&self) -> bool {
        matches!(self.kind, GroupKind::AminoAcid | GroupKind::ModifiedResidue)
    }
}

/// The residues of a list of atoms, in order of first appearance.
///
/// Atoms of one key need not stand together (hydrogens at the end of a file, say). Where they do not and a name comes
/// again, chains were merged under one name whose numbers begin anew: that is another residue. A name that comes
/// again among atoms that stand together is an atom given twice, and stays.
pub(crate) fn residues(atoms: &[Atom]) -> Vec<Residue<'_>> {
    let mut place: HashMap<ResidueKey<'_>, usize> = HashMap::new();
    let mut grouped: Vec<(ResidueKey<'_>, Vec<usize>)> = Vec::new();
    // Of residues that come again, the names that they have.
    let mut names: HashMap<usize, HashSet<&str>> = HashMap::new();
    for (key, members) in runs(atoms) {
        let name = |index: usize| atoms[index].name.as_str();
        if let Some(&at) = place.get(&key) {
            let there = &mut grouped[at].1;
            let of_residue = || there.iter().copied().map(name).collect();
            let names = names.entry(at).or_insert_with(of_residue);
            if !members.clone().map(name).any(|name| names.contains(name)) {
                names.extend(members.clone().map(name));
                there.extend(members);
                continue;
            }
        }
        place.insert(key, grouped.len());
        grouped.push((key, members.collect()));
    }
    let residue = |(key, members)| Residue::new(key, members, atoms);
    grouped.into_iter().map(residue).collect()
}

/// Runs of atoms that share a key: the key, and the indices of the atoms.
fn runs(atoms: &[Atom]) -> impl Iterator<Item = (ResidueKey<'_>, Range<usize>)> {
    let mut last = 0;
    let runs = atoms.chunk_by(|a, b| residue_key(a) == residue_key(b));
    runs.map(move |run| {
        last += run.len();
        (residue_key(&run[0]), last - run.len()..last)
    })
}

/// The residues of a list of atoms as they follow each other: where chains were merged under one name and numbers
/// begin again, residues that share a key stay separate.
pub(crate) fn residue_runs(atoms: &[Atom]) -> Vec<Residue<'_>> {
    let residue = |(key, members): (_, Range<usize>)| Residue::new(key, members.collect(), atoms);
    runs(atoms).map(residue).collect()
}

/// The kind of a residue from its name and its atoms' names and elements.
pub(crate) fn kind<'a>(
    residue_name: &str,
    atoms: impl Iterator<Item = (&'a str, &'a str)>,
) -> GroupKind {
    if matches!(residue_name, "MSE" | "SEC") {
        return GroupKind::ModifiedResidue;
    }
    if is_amino_acid(residue_name) {
        return GroupKind::AminoAcid;
    }
    let atoms: Vec<(&str, &str)> = atoms.collect();
    if is_nucleotide(residue_name) {
        // Of a trace the sugar's carbon is all there is.
        let is_trace = matches!(atoms.as_slice(), [(name, _)] if name.ends_with(['\'', '*']));
        if is_trace || atoms.iter().any(|(name, _)| links_nucleotides(name)) {
            return GroupKind::Nucleotide;
        }
    }
    if GLYCANS.contains(&residue_name) {
        return GroupKind::Glycan;
    }
    if let [(_, element)] = atoms.as_slice()
        && is_metal(element)
    {
        return GroupKind::Metal;
    }
    let names: HashSet<Cow<'_, str>> = atoms
        .iter()
        .map(|(name, _)| plain_atom_name(name))
        .collect();
    let has_all = |wanted: &[&str]| wanted.iter().all(|name| names.contains(*name));
    if has_all(&["N", "CA", "C"]) {
        GroupKind::ModifiedResidue
    } else if has_all(&["P", "C1'", "C3'", "O3'"]) {
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
        assert_eq!(of("A", &[("C4'", "C")]), GroupKind::Nucleotide);
        let psu = [("P", "P"), ("C1'", "C"), ("C3'", "C"), ("O3'", "O")];
        assert_eq!(of("PSU", &psu), GroupKind::Nucleotide);
        let old = [("P", "P"), ("C1*", "C"), ("C3*", "C"), ("O3*", "O")];
        assert_eq!(of("PSU", &old), GroupKind::Nucleotide);
        let atp = [("PG", "P"), ("C1'", "C"), ("C3'", "C"), ("O3'", "O")];
        assert_eq!(of("ATP", &atp), GroupKind::Cofactor);
    }

    /// Found by a review: these passed for uridine, inosine and thymidine.
    #[test]
    fn names_like_nucleotides_are_none_without_their_atoms() {
        assert_eq!(of("RU", &[("RU", "Ru")]), GroupKind::Metal);
        let iodide = [("IN", "In"), ("I1", "I"), ("I2", "I"), ("I3", "I")];
        assert_eq!(of("IN", &iodide), GroupKind::Cofactor);
        let hormone = [("C1'", "C"), ("C4'", "C"), ("O4'", "O"), ("I3", "I")];
        assert_eq!(of("T3", &hormone), GroupKind::Cofactor);
    }

    #[test]
    fn residues_part_where_a_name_comes_again_in_another_place() {
        let atom = |residue: &str, number: i64, name: &str| Atom {
            name: name.to_owned(),
            residue_name: residue.to_owned(),
            chain: "A".to_owned(),
            residue_number: number,
            element: "C".to_owned(),
            position: [0.0; 3],
            ..Atom::default()
        };
        let chain = [
            atom("ALA", 1, "N"),
            atom("ALA", 1, "CA"),
            atom("GLY", 2, "N"),
            // Hydrogens at the end of their chain belong to the group before.
            atom("ALA", 1, "HA"),
            atom("GLY", 2, "HA"),
        ];
        let members = |atoms: &[Atom]| -> Vec<Vec<usize>> {
            residues(atoms).into_iter().map(|one| one.atoms).collect()
        };
        let merged = [&chain[..], &chain[..]].concat();
        assert_eq!(
            members(&merged),
            [vec![0, 1, 3], vec![2, 4], vec![5, 6, 8], vec![7, 9]]
        );
        // An atom given twice.
        let twice = [chain[0].clone(), chain[0].clone(), chain[1].clone()];
        assert_eq!(members(&twice), [vec![0, 1, 2]]);
    }
}
