//! What is missing from a structure and would make its shape a lie: side chains, whole backbones; and what is there
//! twice.

use std::collections::{BTreeMap, HashSet};

use crate::molecule::chemistry::residues::side_chain;
use crate::molecule::model::atom::Atom;
use crate::molecule::model::groups::{GroupKind, Residue, ResidueKey, residue_key};
use crate::molecule::model::wording::show_chain;

/// Warnings about incomplete residues and duplicate atoms, with counts.
pub(crate) fn warnings(atoms: &[Atom], residues: &[Residue<'_>]) -> Vec<String> {
    let mut warnings = trace_only(atoms, residues);
    warnings.extend(missing_side_chains(atoms, residues));
    warnings.extend(duplicates(atoms));
    warnings.extend(in_one_place(atoms));
    warnings
}

fn names<'a>(atoms: &'a [Atom], residue: &Residue<'_>) -> HashSet<&'a str> {
    residue
        .atoms
        .iter()
        .filter_map(|&index| atoms.get(index))
        .map(|atom| atom.name.as_str())
        .collect()
}

/// Whether all that is left of a residue is the atom that a trace through the chain follows.
fn is_trace(names: &HashSet<&str>, kind: GroupKind) -> bool {
    let only = |name: &str| names.len() == 1 && names.contains(name);
    match kind {
        GroupKind::AminoAcid | GroupKind::ModifiedResidue => only("CA"),
        GroupKind::Nucleotide => only("P") || only("C4'"),
        _ => false,
    }
}

/// Chains of which more than half of the residues are a single CA or P atom.
fn trace_only(atoms: &[Atom], residues: &[Residue<'_>]) -> Vec<String> {
    let mut chains: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for residue in residues {
        let is_polymer = matches!(residue.kind, GroupKind::AminoAcid | GroupKind::Nucleotide)
            // A modified residue reduced to its CA is no longer known as one.
            || residue.atoms.len() == 1;
        if is_polymer {
            let (traced, all) = chains.entry(residue.key.0).or_default();
            *all += 1;
            let names = names(atoms, residue);
            *traced += usize::from(is_trace(&names, residue.kind));
        }
    }
    chains
        .into_iter()
        .filter(|(_, (traced, all))| *traced > 1 && 2 * traced > *all)
        .map(|(chain, (traced, _))| {
            format!(
                "chain {} is a trace: {traced} residues have only their CA or P atom, so that its shape cannot be scored",
                show_chain(chain)
            )
        })
        .collect()
}

/// Amino acids with a backbone but without all of their side chain.
fn missing_side_chains(atoms: &[Atom], residues: &[Residue<'_>]) -> Option<String> {
    let mut examples: Vec<String> = Vec::new();
    let mut incomplete = 0;
    let mut missing_atoms = 0;
    for residue in residues.iter().filter(|r| r.kind == GroupKind::AminoAcid) {
        let names = names(atoms, residue);
        if is_trace(&names, residue.kind) {
            continue;
        }
        let (chain, number, insertion, name) = residue.key;
        let expected = side_chain(residue.known_as).unwrap_or(&[]);
        let missing = expected
            .iter()
            // GROMACS and CHARMM write isoleucine's CD1 as CD.
            .filter(|(atom, _)| !(names.contains(atom) || *atom == "CD1" && names.contains("CD")))
            .count();
        if missing > 0 {
            incomplete += 1;
            missing_atoms += missing;
            if examples.len() < 3 {
                let insertion = insertion.map_or(String::new(), String::from);
                examples.push(format!("{name} {}{number}{insertion}", show_chain(chain)));
            }
        }
    }
    (incomplete > 0).then(|| {
        let more = if incomplete > examples.len() {
            ", ..."
        } else {
            ""
        };
        let residues = if incomplete == 1 {
            "residue lacks"
        } else {
            "residues lack"
        };
        format!(
            "{incomplete} {residues} side-chain atoms ({missing_atoms} in all: {}{more})",
            examples.join(", ")
        )
    })
}

/// Fewest atoms among which coincident positions are looked for.
const PLACED: usize = 10;

/// Atoms none of which has a place of its own, as in files that were written before there were coordinates.
fn in_one_place(atoms: &[Atom]) -> Option<String> {
    let (first, rest) = atoms.split_first()?;
    let same = |atom: &Atom| atom.position == first.position;
    (atoms.len() >= PLACED && rest.iter().all(same)).then(|| {
        let [x, y, z] = first.position;
        format!("all atoms are in one place ({x}, {y}, {z}), so that no score means anything: were coordinates ever written?")
    })
}

/// Atoms that are there twice: same residue, same name, no alternate location.
fn duplicates(atoms: &[Atom]) -> Option<String> {
    // By key: where chains were merged under one name, residues of one key are several.
    let distinct: HashSet<(ResidueKey<'_>, &str)> = atoms
        .iter()
        .map(|atom| (residue_key(atom), atom.name.as_str()))
        .collect();
    let repeated = atoms.len() - distinct.len();
    (repeated > 0).then(|| {
        let atoms = if repeated == 1 { "atom repeats" } else { "atoms repeat" };
        format!(
            "{repeated} {atoms} the residue and name of another, and all are kept: two chains of one name, or two models?"
        )
    })
}
