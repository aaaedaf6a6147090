//! Labels of a molecule's atoms: what effects beside shape act on. Charges in e, and contact types.
//!
//! The charge of a cysteine or histidine that binds a metal follows from it at any pH. A cysteine that binds zinc, iron,
//! copper or their like is a thiolate: Dudev & Lim, J. Am. Chem. Soc. 124 (2002) 6759-6766. A histidine binds by the
//! nitrogen that has no proton, and so is neutral with its proton on the other; between two metals it has none. If a
//! residue's name says its state (`CYM`, `HID`, `HIP`, ...), the name decides.

use crate::molecule::chemistry::{
    Charges, backbone, cofactor, ion, is_hard, is_metal, known_atom, nucleotide, side_chain_charges,
};
use crate::molecule::model::{Atom, GroupKind, Molecule, Residue, residues};
use crate::vector::squared_distance;
use serde::Serialize;
use std::collections::BTreeMap;

/// Longest distance in Å of a metal from the sulphur or nitrogen that binds it.
const METAL_BOND: f64 = 2.8;

/// Labels of a molecule.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    /// Charge of each atom, in e.
    pub charges: Vec<f64>,
    /// 1 for the atoms that share the charge of a positive group, -1 for those of a negative one, else 0. Groups are
    /// charged side chains, phosphates, ions, and cofactors whose charges are known; termini are none.
    pub group_signs: Vec<i8>,
    /// Contact type of each atom, `None` outside amino acids.
    pub contact_types: Vec<Option<u8>>,
    /// Kind of each atom ([`atom_kinds`](crate::molecule::atom_kinds)), `None` outside amino acids.
    pub atom_kinds: Vec<Option<u8>>,
    /// How they came about.
    pub report: LabelReport,
}

/// Report on labelling a molecule: totals and assumptions.
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
    /// Cysteines and histidines whose charge follows from a metal that they bind.
    pub metal_bound: usize,
    /// Breaks in a chain where residues are missing; their ends carry no charge.
    pub gaps: usize,
    /// Residues whose charges are not known and count as zero (of a modified residue: those of its side chain), by
    /// name.
    pub unknown_charges: BTreeMap<String, usize>,
    /// Residues without contact types, by name.
    pub unknown_types: BTreeMap<String, usize>,
}

impl Molecule {
    /// Charges at a pH, and contact types.
    pub fn labels(&self, ph: f64) -> Labels {
        let mut labels = Labels {
            charges: vec![0.0; self.atoms.len()],
            group_signs: vec![0; self.atoms.len()],
            contact_types: vec![None; self.atoms.len()],
            atom_kinds: vec![None; self.atoms.len()],
            report: LabelReport::default(),
        };
        let groups = residues(&self.atoms);
        let metals = self.metals(&groups);
        for residue in &groups {
            let bound = self.metal_bound(residue, &metals);
            labels.report.metal_bound += usize::from(bound.is_some());
            self.charge(residue, bound, ph, &mut labels);
            for &index in &residue.atoms {
                if let Some(atom) = known_atom(residue.known_as, &self.atoms[index].name) {
                    labels.contact_types[index] = Some(atom.contact);
                    labels.atom_kinds[index] = Some(atom.kind);
                }
            }
            let is_typed = |&index: &usize| labels.contact_types[index].is_some();
            if !residue.atoms.iter().any(is_typed) {
                let name = residue.key.name.to_owned();
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

    /// Places of the metals that thiolates and imidazoles bind (Å), ions and those of cofactors.
    pub(crate) fn metals(&self, groups: &[Residue<'_>]) -> Vec<[f64; 3]> {
        let others = groups.iter().filter(|group| !group.is_peptide());
        let atoms = others.flat_map(|group| group.members(&self.atoms));
        let binds = |element: &str| !element.is_empty() && is_metal(element) && !is_hard(element);
        let metals = atoms.filter(|atom| binds(&atom.element));
        metals.map(|atom| atom.position).collect()
    }

    /// The state of a residue that binds one of these metals, as the table of charges names it.
    pub(crate) fn metal_bound(
        &self,
        residue: &Residue<'_>,
        metals: &[[f64; 3]],
    ) -> Option<&'static str> {
        let binds = |name: &str| {
            self.atom(residue, name).is_some_and(|atom| {
                let near = |metal: &[f64; 3]| {
                    squared_distance(*metal, atom.position) <= METAL_BOND * METAL_BOND
                };
                metals.iter().any(near)
            })
        };
        match residue.known_as {
            "CYS" => binds("SG").then_some("CYM"),
            "HIS" => match (binds("ND1"), binds("NE2")) {
                (true, true) => Some("HIS-"),
                (true, false) => Some("HIE"),
                (false, true) => Some("HID"),
                (false, false) => None,
            },
            _ => None,
        }
    }

    /// Charges of one residue within a chain; `bound` is its state where a metal decides that.
    fn charge(&self, residue: &Residue<'_>, bound: Option<&str>, ph: f64, labels: &mut Labels) {
        let name = residue.known_as;
        match residue.kind {
            GroupKind::AminoAcid | GroupKind::ModifiedResidue => {
                self.set(residue, backbone(name), labels);
                if let Some(charges) = side_chain_charges(bound.unwrap_or(name), ph) {
                    return self.set_group(residue, charges, labels);
                }
            }
            GroupKind::Nucleotide => return self.set_group(residue, nucleotide(), labels),
            // Uncharged but for the acids among them, which are rare.
            GroupKind::Glycan => return,
            GroupKind::Metal | GroupKind::Cofactor => {
                if let &[index] = residue.atoms.as_slice()
                    && let Some(charge) = ion(name, &self.atoms[index].element)
                {
                    labels.charges[index] = charge;
                    labels.group_signs[index] = charge.signum() as i8;
                    return;
                }
                if let Some(charges) = cofactor(name) {
                    return self.set_group(residue, charges, labels);
                }
            }
        }
        let unknown = labels.report.unknown_charges.entry(name.to_owned());
        *unknown.or_default() += 1;
    }

    /// Sets the charges of a group, which its atoms share if they sum to more than half of a unit.
    fn set_group(&self, residue: &Residue<'_>, charges: Charges, labels: &mut Labels) {
        self.set(residue, charges, labels);
        let sum: f64 = charges.iter().map(|(_, charge)| charge).sum();
        if sum.abs() < 0.5 {
            return;
        }
        for &index in &residue.atoms {
            let name = &self.atoms[index].name;
            if charges.iter().any(|(known, _)| known == name) {
                labels.group_signs[index] = sum.signum() as i8;
            }
        }
    }

    pub(crate) fn set(&self, residue: &Residue<'_>, charges: Charges, labels: &mut Labels) {
        for &index in &residue.atoms {
            let name = &self.atoms[index].name;
            if let Some((_, charge)) = charges.iter().find(|(known, _)| known == name) {
                labels.charges[index] = *charge;
            }
        }
    }

    pub(crate) fn atom<'a>(&'a self, residue: &Residue<'_>, name: &str) -> Option<&'a Atom> {
        let index = residue
            .atoms
            .iter()
            .find(|&&index| self.atoms[index].name == name)?;
        Some(&self.atoms[*index])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::model::Format;

    fn atom(name: &str, residue: &str, number: i64, position: [f64; 3]) -> Atom {
        Atom {
            name: name.to_owned(),
            residue_name: residue.to_owned(),
            chain: "A".to_owned(),
            residue_number: number,
            element: name[..1].to_owned(),
            position,
            ..Atom::default()
        }
    }

    /// A backbone along x, 3.8 Å per residue: C and the next N are at a distance of 1.3 Å.
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

    /// Found by a review: merged chains whose numbers begin again had their residues fused, and with them the ends.
    #[test]
    fn merged_chains_that_begin_again_at_one_keep_their_ends() {
        let mut atoms = chain(&[("ALA", 1), ("ALA", 2)]);
        let second = atoms.clone().into_iter().map(|mut atom| {
            atom.position[1] += 10.0;
            atom
        });
        atoms.extend(second);
        let labels = labels(atoms);
        assert_eq!((labels.report.termini, labels.report.gaps), ([2, 2], 0));
        assert_eq!(labels.charges[..8], labels.charges[8..]);
    }

    /// Found by a user: HADDOCK's merged antibodies, whose second chain is numbered from 500 on, lost the charge of its
    /// amino end beside the CDRs. A gap in the numbers was taken for unresolved residues though the chain before had
    /// its last oxygen.
    #[test]
    fn a_last_oxygen_ends_a_chain_whatever_the_numbers_say() {
        let merged = |oxygen: Option<&str>| {
            let mut atoms = chain(&[("ALA", 1), ("ALA", 2)]);
            atoms.extend(oxygen.map(|name| atom(name, "ALA", 2, [7.0, 1.0, 0.0])));
            for mut moved in chain(&[("ALA", 501), ("ALA", 502)]) {
                moved.position[1] += 10.0;
                atoms.push(moved);
            }
            labels(atoms).report
        };
        for name in ["OXT", "OT2"] {
            let report = merged(Some(name));
            assert_eq!((report.termini, report.gaps), ([2, 2], 0), "{name}");
        }
        let report = merged(None);
        assert_eq!((report.termini, report.gaps), ([1, 1], 1));
        // X-PLOR writes the oxygen before a gap, too (1TFH, the ligand of 1AHW in Docking Benchmark 5): seven residues
        // fit into 10 Å.
        let mut atoms = chain(&[("ALA", 1), ("ALA", 2)]);
        atoms.push(atom("OXT", "ALA", 2, [7.0, 1.0, 0.0]));
        for mut moved in chain(&[("ALA", 10), ("ALA", 11)]) {
            moved.position[1] += 10.0;
            atoms.push(moved);
        }
        let report = labels(atoms).report;
        assert_eq!((report.termini[0], report.gaps), (1, 1));
    }

    /// Ligands, metals and waters behind a chain's last oxygen have no amino end, though some have an amino acid's
    /// atoms.
    #[test]
    fn what_follows_a_last_oxygen_without_being_a_chain_has_no_end() {
        let mut atoms = chain(&[("ALA", 1), ("ALA", 2)]);
        atoms.push(atom("OXT", "ALA", 2, [7.0, 1.0, 0.0]));
        let alone = labels(atoms.clone()).report.termini;
        let ligand = |name: &str, residue: &str, x: f64| Atom {
            hetero: true,
            ..atom(name, residue, 300, [x, 30.0, 0.0])
        };
        // S-adenosylmethionine has N, CA and C.
        for (name, x) in [("N", 0.0), ("CA", 1.5), ("C", 2.5), ("O", 3.0)] {
            atoms.push(ligand(name, "SAM", x));
        }
        atoms.push(ligand("O", "HOH", 20.0));
        atoms.push(ligand("ZN", "ZN", 30.0));
        let report = labels(atoms).report;
        // The ligand, last of all, is taken for the end of its chain, as ever.
        assert_eq!((alone[0], report.termini[0]), (1, 1));
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

    fn metal(element: &str, number: i64, position: [f64; 3]) -> Atom {
        let name = element.to_ascii_uppercase();
        Atom {
            element: element.to_owned(),
            ..atom(&name, &name, number, position)
        }
    }

    /// Side chains of cysteine at so far from the origin along each axis, and a metal there.
    fn cysteines(name: &str, distance: f64, metal: &str) -> LabelReport {
        let mut atoms = vec![self::metal(metal, 100, [0.0; 3])];
        for axis in 0..3 {
            for (place, sign) in [(1, 1.0), (2, -1.0)] {
                let at = |distance: f64| {
                    let mut position = [0.0; 3];
                    position[axis] = sign * distance;
                    position
                };
                let number = 10 * (2 * axis as i64 + place);
                atoms.push(atom("SG", name, number, at(distance)));
                atoms.push(atom("CB", name, number, at(distance + 1.8)));
            }
        }
        Molecule::new(atoms, Format::Pdb).labels(7.0).report
    }

    /// Found by a user: zinc fingers were as positive as their zinc, and a RING domain of eight cysteines was charged
    /// by 8 e too high.
    #[test]
    fn cysteines_that_bind_a_metal_are_thiolates() {
        for (name, distance, metal, charge, bound) in [
            ("CYS", 2.35, "Zn", -4.0, 6),
            ("CYS", 2.8, "Fe", -3.0, 6),
            ("CYM", 2.35, "Zn", -4.0, 0),
            // Too far, a disulphide's half by its name, and a metal that binds oxygens.
            ("CYS", 2.81, "Zn", 2.0, 0),
            ("CYX", 2.35, "Zn", 2.0, 0),
            ("CYS", 2.35, "Mg", 2.0, 0),
        ] {
            let report = cysteines(name, distance, metal);
            assert_eq!((report.net_charge, report.metal_bound), (charge, bound));
        }
    }

    /// The nitrogen that binds has no proton.
    #[test]
    fn histidines_bind_by_the_nitrogen_without_a_proton() {
        let of = |name: &str, metals: &[f64], ph: f64| {
            let mut atoms = vec![
                atom("ND1", name, 1, [0.0; 3]),
                atom("NE2", name, 1, [2.2, 0.0, 0.0]),
            ];
            for (index, x) in metals.iter().enumerate() {
                let zinc = metal("Zn", 100 + index as i64, [*x, 0.0, 0.0]);
                atoms.push(zinc);
            }
            let labels = Molecule::new(atoms, Format::Pdb).labels(ph);
            [labels.charges[0], labels.charges[1]]
        };
        for ph in [2.0, 7.0] {
            assert_eq!(of("HIS", &[-2.1], ph), [-0.40, -0.10]);
            assert_eq!(of("HIS", &[4.3], ph), [-0.10, -0.40]);
            // The imidazolate of superoxide dismutase, between copper and zinc.
            assert_eq!(of("HIS", &[-2.1, 4.3], ph), [-0.5, -0.5]);
        }
        assert_eq!(of("HIS", &[], 2.0), [0.05, 0.05]);
        assert_eq!(of("HID", &[-2.1], 7.0), [-0.10, -0.40]);
    }
}
