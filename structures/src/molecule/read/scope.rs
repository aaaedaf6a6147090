//! What a file holds that lies outside of what the score was tuned on: proteins, atom by atom.

use std::collections::BTreeSet;

use crate::molecule::model::atom::Atom;
use crate::molecule::model::groups::{GroupKind, Residue};
use crate::molecule::model::wording::count;

/// Names of beads that are shown.
const SHOWN: usize = 4;

/// Warnings about coarse-grained models and about scenes without protein.
pub(crate) fn warnings(atoms: &[Atom], residues: &[Residue<'_>]) -> Vec<String> {
    coarse_grained(atoms, residues)
        .into_iter()
        .chain(without_protein(residues))
        .collect()
}

/// Amino acids made of beads: more than half of them have several atoms, or one that is no CA, but neither N nor C.
fn coarse_grained(atoms: &[Atom], residues: &[Residue<'_>]) -> Option<String> {
    let amino_acids = || {
        residues
            .iter()
            .filter(|residue| residue.kind == GroupKind::AminoAcid)
    };
    let names = |residue: &Residue<'_>| -> BTreeSet<&str> {
        let members = residue.atoms.iter().filter_map(|&index| atoms.get(index));
        members.map(|atom| atom.name.as_str()).collect()
    };
    let mut beads: BTreeSet<&str> = BTreeSet::new();
    let mut coarse = 0;
    for residue in amino_acids() {
        let names = names(residue);
        let is_trace = names.len() == 1 && names.contains("CA");
        if !is_trace && !names.contains("N") && !names.contains("C") {
            coarse += 1;
            beads.extend(names);
        }
    }
    let all = amino_acids().count();
    (coarse > 1 && 2 * coarse > all).then(|| {
        let shown: Vec<&str> = beads.iter().copied().take(SHOWN).collect();
        let more = if beads.len() > SHOWN { ", ..." } else { "" };
        format!(
            "{coarse} of {} are coarse-grained (beads {}{more}): radii, charges and potentials are those of \
             atoms, and nothing was tuned on beads",
            count(all, "amino acid"),
            shown.join(", ")
        )
    })
}

/// Molecules that are no proteins.
fn without_protein(residues: &[Residue<'_>]) -> Option<String> {
    let of_kind = |kinds: &[GroupKind]| {
        let found = residues
            .iter()
            .filter(|residue| kinds.contains(&residue.kind));
        found.count()
    };
    let protein = of_kind(&[GroupKind::AminoAcid, GroupKind::ModifiedResidue]);
    let nucleotides = of_kind(&[GroupKind::Nucleotide]);
    let tuned = "the score was tuned on proteins alone, so that nothing is known of how well such poses are ranked";
    if residues.is_empty() || protein > nucleotides {
        None
    } else if nucleotides > 0 {
        Some(format!(
            "mostly nucleic acid ({}, {}): {tuned}",
            count(nucleotides, "nucleotide"),
            count(protein, "amino acid")
        ))
    } else {
        Some(format!("neither protein nor nucleic acid: {tuned}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::model::groups::residues;

    fn residue(name: &str, number: i64, atoms: &[&str]) -> Vec<Atom> {
        let atom = |atom: &&str| Atom {
            name: (*atom).to_owned(),
            residue_name: name.to_owned(),
            chain: "A".to_owned(),
            residue_number: number,
            insertion_code: None,
            alternate_location: None,
            element: "C".to_owned(),
            position: [number as f64; 3],
            occupancy: 1.0,
            b_factor: 0.0,
            hetero: false,
            radius: 1.7,
            line: 1,
        };
        atoms.iter().map(atom).collect()
    }

    fn of(molecule: &[Vec<Atom>]) -> Vec<String> {
        let atoms = molecule.concat();
        warnings(&atoms, &residues(&atoms))
    }

    #[test]
    fn beads_nucleic_acids_and_small_molecules_are_named() {
        let backbone = ["N", "CA", "C", "O"];
        let protein = [residue("ALA", 1, &backbone), residue("GLY", 2, &backbone)];
        assert!(of(&protein).is_empty());
        // Martini: a bead for the backbone, up to four for the side chain.
        let martini = of(&[
            residue("ALA", 1, &["BB"]),
            residue("LEU", 2, &["BB", "SC1"]),
        ]);
        assert_eq!(martini.len(), 1);
        assert!(
            martini[0].starts_with("2 of 2 amino acids are coarse-grained (beads BB, SC1)"),
            "{martini:?}"
        );
        // A trace has a warning of its own.
        let trace = [residue("ALA", 1, &["CA"]), residue("LEU", 2, &["CA"])];
        assert!(of(&trace).is_empty());
        let nucleic = of(&[
            residue("DA", 1, &["P", "O5'"]),
            residue("DT", 2, &["P", "O5'"]),
        ]);
        assert!(nucleic[0].starts_with("mostly nucleic acid (2 nucleotides, 0 amino acids)"));
        let ligand = of(&[residue("LIG", 1, &["C1", "C2"])]);
        assert!(ligand[0].starts_with("neither protein nor nucleic acid"));
        assert!(of(&[]).is_empty());
    }
}
