//! Cysteines and histidines that bind a metal, whose charge follows from it at any pH.
//!
//! A cysteine that binds zinc, iron, copper or their like is a thiolate: Dudev & Lim, J. Am. Chem. Soc. 124 (2002)
//! 6759-6766. A histidine binds by the nitrogen that has no proton, and so is neutral with its proton on the other;
//! between two metals it has none. Where a residue's name says its state (`CYM`, `HID`, `HIP`, ...), the name decides.

use crate::molecule::model::atom::squared_distance;
use crate::molecule::model::groups::{NON_METALS, Residue};
use crate::molecule::model::molecule::Molecule;

/// Longest distance in Å of a metal from the sulphur or nitrogen that binds it.
const BOUND: f64 = 2.8;

/// Metals that sulphur and nitrogen seldom bind: theirs are oxygens, and what lies nearer is as likely a water.
const HARD: [&str; 11] = [
    "Li", "Na", "K", "Rb", "Cs", "Be", "Mg", "Ca", "Sr", "Ba", "Al",
];

impl Molecule {
    /// Places of the metals that thiolates and imidazoles bind (Å), ions and those of cofactors.
    pub(crate) fn metals(&self, groups: &[Residue<'_>]) -> Vec<[f64; 3]> {
        let others = groups.iter().filter(|group| !group.is_peptide());
        let atoms = others.flat_map(|group| group.atoms.iter().filter_map(|&i| self.atoms.get(i)));
        atoms
            .filter(|atom| {
                let element = atom.element.as_str();
                !(element.is_empty() || NON_METALS.contains(&element) || HARD.contains(&element))
            })
            .map(|atom| atom.position)
            .collect()
    }

    /// The state of a residue that binds one of these metals, as the table of charges names it.
    pub(crate) fn metal_bound(
        &self,
        residue: &Residue<'_>,
        metals: &[[f64; 3]],
    ) -> Option<&'static str> {
        let binds = |name: &str| {
            self.atom(residue, name).is_some_and(|atom| {
                let near =
                    |metal: &[f64; 3]| squared_distance(*metal, atom.position) <= BOUND * BOUND;
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::chemistry::labels::LabelReport;
    use crate::molecule::model::atom::Atom;
    use crate::molecule::model::format::Format;

    fn atom(name: &str, residue: &str, number: i64, element: &str, position: [f64; 3]) -> Atom {
        Atom {
            name: name.to_owned(),
            residue_name: residue.to_owned(),
            chain: "A".to_owned(),
            residue_number: number,
            insertion_code: None,
            alternate_location: None,
            element: element.to_owned(),
            position,
            occupancy: 1.0,
            b_factor: 0.0,
            hetero: false,
            radius: 1.7,
            line: 1,
        }
    }

    /// Side chains of cysteine at so far from the origin along each axis, and a metal there.
    fn cysteines(name: &str, distance: f64, metal: &str) -> LabelReport {
        let mut atoms = vec![atom(metal, metal, 100, metal, [0.0; 3])];
        for axis in 0..3 {
            for (place, sign) in [(1, 1.0), (2, -1.0)] {
                let at = |distance: f64| {
                    let mut position = [0.0; 3];
                    position[axis] = sign * distance;
                    position
                };
                let number = 10 * (2 * axis as i64 + place);
                atoms.push(atom("SG", name, number, "S", at(distance)));
                atoms.push(atom("CB", name, number, "C", at(distance + 1.8)));
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
                atom("ND1", name, 1, "N", [0.0; 3]),
                atom("NE2", name, 1, "N", [2.2, 0.0, 0.0]),
            ];
            for (index, x) in metals.iter().enumerate() {
                let zinc = atom("ZN", "ZN", 100 + index as i64, "Zn", [*x, 0.0, 0.0]);
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
