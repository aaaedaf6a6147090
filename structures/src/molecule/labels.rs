//! Labels of a molecule's atoms: what effects beside shape act on. Charges in e, and contact types.
//!
//! A chain's ends are charged, a gap in it is not: two peptide residues in a row whose C and N lie more than 2.5 Å apart end one chain
//! and begin another if the chain's name changes or the numbering has no gap; where numbers are missing, so are residues, and the
//! loose ends stand for neutral bonds. Chain names alone do not tell, since many files have chains merged.

use super::charge_table::{
    AMINO_TERMINUS, BACKBONE, CARBOXYL_CARBON, CARBOXYL_OXYGENS, Charges, NUCLEOTIDE, PROLINE,
    PROLINE_TERMINUS, TERMINI_PKA, cofactor, ion, side_chain,
};
use super::contact_types::atom_types;
use super::groups::{GroupKind, Residue, residues};
use super::{Atom, Molecule, squared_distance};
use serde::Serialize;
use std::collections::BTreeMap;

/// Longest C-N distance in Å of a peptide bond, with room for poor structures.
const BOND: f64 = 2.5;

/// What the labels of a molecule are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    /// Charge of each atom, in e.
    pub charges: Vec<f64>,
    /// Contact type of each atom, `None` outside amino acids.
    pub contact_types: Vec<Option<u8>>,
    /// Kind of each atom ([`super::atom_kinds`]), `None` outside amino acids.
    pub atom_kinds: Vec<Option<u8>>,
    /// How they came about.
    pub report: LabelReport,
}

/// What was assumed in labelling a molecule.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LabelReport {
    /// Sum of all charges, in e.
    pub net_charge: f64,
    /// Atoms with a charge.
    pub charged_atoms: usize,
    /// Atoms with a contact type.
    pub typed_atoms: usize,
    /// Charged amino and carboxyl termini.
    pub termini: [usize; 2],
    /// Breaks in a chain where residues are missing; their ends carry no charge.
    pub gaps: usize,
    /// Residues whose charges are not known and count as zero (of a modified residue: those of its side chain), by name.
    pub unknown_charges: BTreeMap<String, usize>,
    /// Residues without contact types, by name.
    pub unknown_types: BTreeMap<String, usize>,
}

impl Molecule {
    /// Charges at a pH, and contact types.
    pub fn labels(&self, ph: f64) -> Labels {
        let types = self
            .atoms
            .iter()
            .map(|atom| atom_types(&atom.residue_name, &atom.name));
        let (contact_types, atom_kinds) = types
            .map(|types| {
                (
                    types.map(|types| types.contact),
                    types.map(|types| types.kind),
                )
            })
            .unzip();
        let mut labels = Labels {
            charges: vec![0.0; self.atoms.len()],
            contact_types,
            atom_kinds,
            report: LabelReport::default(),
        };
        let groups = residues(&self.atoms);
        for residue in &groups {
            self.charge(residue, ph, &mut labels);
            if !residue
                .atoms
                .iter()
                .any(|&index| labels.contact_types[index].is_some())
            {
                let name = residue.key.3.to_owned();
                *labels.report.unknown_types.entry(name).or_default() += 1;
            }
        }
        self.charge_termini(&groups, ph, &mut labels);
        let report = &mut labels.report;
        // + 0.0 makes a negative zero a plain one.
        report.net_charge = (labels.charges.iter().sum::<f64>() * 1e6).round() / 1e6 + 0.0;
        report.charged_atoms = labels.charges.iter().filter(|q| **q != 0.0).count();
        report.typed_atoms = labels.contact_types.iter().flatten().count();
        labels
    }

    /// Charges of one residue within a chain.
    fn charge(&self, residue: &Residue<'_>, ph: f64, labels: &mut Labels) {
        let name = residue.key.3;
        let mut known = true;
        match residue.kind {
            GroupKind::AminoAcid | GroupKind::ModifiedResidue => {
                let backbone = if is_proline(name) { PROLINE } else { BACKBONE };
                self.set(residue, backbone, labels);
                match side_chain(name, ph) {
                    Some(charges) => self.set(residue, charges, labels),
                    None => known = false,
                }
            }
            GroupKind::Nucleotide => self.set(residue, NUCLEOTIDE, labels),
            // Uncharged but for the acids among them, which are rare.
            GroupKind::Glycan => {}
            GroupKind::Metal | GroupKind::Cofactor => {
                let single = match residue.atoms.as_slice() {
                    &[index] => self.atoms.get(index).map(|atom| (index, atom)),
                    _ => None,
                };
                let charge =
                    single.and_then(|(index, atom)| Some((index, ion(name, &atom.element)?)));
                match (charge, cofactor(name)) {
                    (Some((index, charge)), _) => labels.charges[index] = charge,
                    (None, Some(charges)) => self.set(residue, charges, labels),
                    (None, None) => known = false,
                }
            }
        }
        if !known {
            *labels
                .report
                .unknown_charges
                .entry(name.to_owned())
                .or_default() += 1;
        }
    }

    fn set(&self, residue: &Residue<'_>, charges: Charges, labels: &mut Labels) {
        for &index in &residue.atoms {
            let name = self.atoms.get(index).map_or("", |atom| atom.name.as_str());
            if let Some((_, charge)) = charges.iter().find(|(known, _)| *known == name) {
                labels.charges[index] = *charge;
            }
        }
    }

    fn atom<'a>(&'a self, residue: &Residue<'_>, name: &str) -> Option<&'a Atom> {
        let atoms = residue
            .atoms
            .iter()
            .filter_map(|&index| self.atoms.get(index));
        atoms.into_iter().find(|atom| atom.name == name)
    }

    fn charge_termini(&self, groups: &[Residue<'_>], ph: f64, labels: &mut Labels) {
        let peptide: Vec<&Residue<'_>> = groups
            .iter()
            .filter(|residue| {
                matches!(
                    residue.kind,
                    GroupKind::AminoAcid | GroupKind::ModifiedResidue
                )
            })
            .collect();
        for (place, residue) in peptide.iter().enumerate() {
            let before = place.checked_sub(1).and_then(|place| peptide.get(place));
            let after = peptide.get(place + 1);
            let begins = before.is_none_or(|before| self.separate(before, residue));
            let ends = after.is_none_or(|after| self.separate(residue, after));
            if begins && !self.capped(groups, residue, "N") && ph < TERMINI_PKA[0] {
                self.charge_amino(residue, labels);
            }
            let last_oxygen = ["OXT", "OT2", "O2"]
                .iter()
                .any(|name| self.atom(residue, name).is_some());
            if (ends || last_oxygen) && !self.capped(groups, residue, "C") && ph >= TERMINI_PKA[1] {
                self.charge_carboxyl(residue, labels);
            }
            let broken = before.is_some_and(|before| {
                !begins
                    && self.distance(before, residue).is_some_and(|d| d > BOND)
                    && !self.capped(groups, residue, "N")
            });
            labels.report.gaps += usize::from(broken);
        }
    }

    /// Distance in Å of the C of one residue from the N of the next.
    fn distance(&self, before: &Residue<'_>, after: &Residue<'_>) -> Option<f64> {
        let (c, n) = (self.atom(before, "C")?, self.atom(after, "N")?);
        Some(squared_distance(c.position, n.position).sqrt())
    }

    /// Whether one chain ends and another begins between two peptide residues in a row.
    fn separate(&self, before: &Residue<'_>, after: &Residue<'_>) -> bool {
        let apart = self.distance(before, after).is_some_and(|d| d > BOND);
        let (chain, number, ..) = before.key;
        let (next_chain, next_number, ..) = after.key;
        apart && (chain != next_chain || next_number <= number + 1)
    }

    /// Whether an atom of another group is bonded to a terminal atom, N or C: an acetyl, an amide, a sugar; or the other end of a residue that
    /// stands elsewhere in the file, as in a cyclic peptide or where residues are not in the order of the chain.
    fn capped(&self, groups: &[Residue<'_>], residue: &Residue<'_>, name: &str) -> bool {
        let Some(end) = self.atom(residue, name) else {
            return true;
        };
        let is_bonded = |atom: &Atom| squared_distance(atom.position, end.position) < 1.7 * 1.7;
        let other_end = if name == "N" { "C" } else { "N" };
        groups.iter().any(|group| match group.kind {
            GroupKind::Cofactor | GroupKind::Glycan => {
                let atoms = group
                    .atoms
                    .iter()
                    .filter_map(|&index| self.atoms.get(index));
                atoms.into_iter().any(is_bonded)
            }
            GroupKind::AminoAcid | GroupKind::ModifiedResidue => {
                group.key != residue.key && self.atom(group, other_end).is_some_and(is_bonded)
            }
            _ => false,
        })
    }

    fn charge_amino(&self, residue: &Residue<'_>, labels: &mut Labels) {
        // Pyroglutamate's amide carries no proton to share.
        if residue.key.3 == "PCA" {
            return;
        }
        let charges = if is_proline(residue.key.3) {
            PROLINE_TERMINUS
        } else {
            AMINO_TERMINUS
        };
        self.set(residue, charges, labels);
        labels.report.termini[0] += 1;
    }

    fn charge_carboxyl(&self, residue: &Residue<'_>, labels: &mut Labels) {
        let oxygens: Vec<usize> = residue
            .atoms
            .iter()
            .copied()
            .filter(|&index| {
                let name = self.atoms.get(index).map_or("", |atom| atom.name.as_str());
                matches!(name, "O" | "OXT" | "OT1" | "OT2" | "O1" | "O2")
            })
            .collect();
        if oxygens.is_empty() {
            return;
        }
        // Where the second oxygen was not seen, the first stands for both.
        for &index in &oxygens {
            labels.charges[index] = CARBOXYL_OXYGENS / oxygens.len() as f64;
        }
        self.set(residue, &[("C", CARBOXYL_CARBON)], labels);
        labels.report.termini[1] += 1;
    }
}

fn is_proline(residue_name: &str) -> bool {
    matches!(residue_name, "PRO" | "HYP")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::Format;

    fn atom(name: &str, residue: &str, number: i64, position: [f64; 3]) -> Atom {
        Atom {
            name: name.to_owned(),
            residue_name: residue.to_owned(),
            chain: "A".to_owned(),
            residue_number: number,
            insertion_code: None,
            alternate_location: None,
            element: name[..1].to_owned(),
            position,
            occupancy: 1.0,
            b_factor: 0.0,
            hetero: false,
            radius: 1.7,
            line: 1,
        }
    }

    /// A backbone along x, 3.8 Å a residue: C and the next N are 1.3 Å apart.
    fn chain(residues: &[(&str, i64)]) -> Vec<Atom> {
        let place = |k: usize, x: f64| [3.8 * k as f64 + x, 0.0, 0.0];
        residues
            .iter()
            .enumerate()
            .flat_map(|(k, &(name, number))| {
                [("N", 0.0), ("CA", 1.4), ("C", 2.5), ("O", 3.0)]
                    .map(|(atom_name, x)| atom(atom_name, name, number, place(k, x)))
            })
            .collect()
    }

    fn labels(atoms: Vec<Atom>) -> Labels {
        Molecule::new(atoms, Format::Pdb).labels(7.0)
    }

    #[test]
    fn a_chain_has_two_charged_ends_and_sums_to_zero() {
        let labels = labels(chain(&[("ALA", 1), ("GLY", 2), ("PRO", 3)]));
        assert_eq!(labels.report.termini, [1, 1]);
        assert_eq!(labels.charges[0], 0.75);
        // The only oxygen of the last residue stands for both; proline's CD was not seen.
        assert_eq!(labels.charges[11], -1.14);
        assert!((labels.report.net_charge + 0.10).abs() < 1e-12);
    }

    /// Merged chains: a break without a gap in the numbers makes termini, with one it does not.
    #[test]
    fn breaks_make_termini_only_where_no_residue_is_missing() {
        let with = |second: i64| {
            let mut atoms = chain(&[("ALA", 1), ("ALA", 2)]);
            for atom in chain(&[("ALA", second), ("ALA", second + 1)]) {
                let mut moved = atom.clone();
                moved.position[1] += 10.0;
                atoms.push(moved);
            }
            labels(atoms)
        };
        let (merged, gap) = (with(3), with(9));
        assert_eq!((merged.report.termini, merged.report.gaps), ([2, 2], 0));
        assert_eq!((gap.report.termini, gap.report.gaps), ([1, 1], 1));
        assert_eq!(merged.report.net_charge, 0.0);
        assert_eq!(gap.report.net_charge, 0.0);
    }

    #[test]
    fn an_acetyl_cap_leaves_the_amide_neutral() {
        let mut atoms = chain(&[("ALA", 1)]);
        atoms.insert(0, atom("C", "ACE", 0, [-1.3, 0.0, 0.0]));
        let labels = labels(atoms);
        assert_eq!(labels.report.termini, [0, 1]);
        assert_eq!(labels.charges[1], -0.10);
    }

    /// Found by an audit: residues in another order than the chain's made ends of each, though all bonds were there.
    #[test]
    fn a_ring_has_no_ends_and_the_order_of_residues_makes_none() {
        let straight = chain(&[("ALA", 1), ("GLY", 2), ("SER", 3)]);
        let mut turned = straight.clone();
        turned.rotate_left(4);
        let reversed = straight.chunks(4).rev().flatten().cloned().collect();
        let swapped = [&straight[..4], &straight[8..], &straight[4..8]].concat();
        for atoms in [straight.clone(), turned, reversed, swapped] {
            let report = labels(atoms).report;
            assert_eq!((report.termini, report.gaps), ([1, 1], 0));
        }
        // The last C bends back to the first N.
        let mut ring = straight;
        ring[10].position = [0.0, 1.3, 0.0];
        assert_eq!(labels(ring).report.termini, [0, 0]);
    }

    #[test]
    fn what_is_not_known_is_named() {
        let mut atoms = chain(&[("XAA", 1)]);
        atoms.push(atom("C1", "LIG", 5, [20.0, 0.0, 0.0]));
        atoms.push(atom("ZN", "ZN", 6, [30.0, 0.0, 0.0]));
        atoms[5].element = "Zn".to_owned();
        let labels = labels(atoms);
        let names: Vec<&String> = labels.report.unknown_charges.keys().collect();
        assert_eq!(names, ["LIG", "XAA"]);
        assert_eq!(labels.charges[5], 2.0);
        assert_eq!(labels.contact_types, vec![None; 6]);
    }
}
