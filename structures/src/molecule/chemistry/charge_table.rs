//! Charges of united atoms: each heavy atom carries those of its hydrogens.
//!
//! - Amino acids: the polar-hydrogen parameters of CHARMM (PARAM19), Brooks, Bruccoleri, Olafson, States, Swaminathan &
//!   Karplus, J. Comput. Chem. 4 (1983) 187-217, as completed in Neria, Fischer & Karplus, J. Chem. Phys. 105 (1996)
//!   1902-1921, with hydrogens added to their heavy atoms. Every residue sums to an integer.
//! - States that PARAM19 lacks (neutral Asp, Glu, Lys and Arg, Cys and Tyr without their proton), nucleotides,
//!   phosphorylated and other modified residues, heme and ions have the formal charge. It is spread evenly over the
//!   atoms that share it.
//!
//! The state of an acid or base follows from its residue name where that says so (ASH, GLH, HIP, LYN, CYM, ...), else
//! from the pH and a pKa. The pKa are those of alanine pentapeptides, Thurlkill, Grimsley, Scholtz & Pace, Protein Sci.
//! 15 (2006) 1214-1218. Arginine has 13.8: Fitch, Platzer, Okon, Garcia-Moreno & McIntosh, Protein Sci. 24 (2015)
//! 752-761.

use crate::molecule::chemistry::residues::is_amino_acid;

/// Charges in e by atom name.
pub(crate) type Charges = &'static [(&'static str, f64)];

/// Backbone within a chain.
pub(crate) const BACKBONE: Charges = &[("N", -0.10), ("CA", 0.10), ("C", 0.55), ("O", -0.55)];
/// Backbone of proline, whose CD stands for the amide hydrogen.
pub(crate) const PROLINE: Charges = &[
    ("N", -0.20),
    ("CA", 0.10),
    ("CD", 0.10),
    ("C", 0.55),
    ("O", -0.55),
];
/// What replaces the backbone's at a charged amino terminus.
pub(crate) const AMINO_TERMINUS: Charges = &[("N", 0.75), ("CA", 0.25)];
/// The same for proline.
pub(crate) const PROLINE_TERMINUS: Charges = &[("N", 0.50), ("CA", 0.25), ("CD", 0.25)];
/// What replaces the backbone's at a charged carboxyl terminus; the oxygens share -1.14.
pub(crate) const CARBOXYL_CARBON: f64 = 0.14;
/// The two oxygens together.
pub(crate) const CARBOXYL_OXYGENS: f64 = -1.14;

/// pKa of the termini: amino, carboxyl.
pub(crate) const TERMINI_PKA: [f64; 2] = [8.00, 3.67];

/// Residues whose state depends on the pH: name, pKa, name of the protonated state, of the other.
const TITRATABLE: [(&str, f64, &str, &str); 7] = [
    ("ASP", 3.67, "ASH", "ASP"),
    ("GLU", 4.25, "GLH", "GLU"),
    ("HIS", 6.54, "HIP", "HIS"),
    ("CYS", 8.55, "CYS", "CYM"),
    ("TYR", 9.84, "TYR", "TYR-"),
    ("LYS", 10.40, "LYS", "LYN"),
    ("ARG", 13.8, "ARG", "ARN"),
];

/// Side chains, by state.
const SIDE_CHAINS: [(&str, Charges); 43] = [
    ("ALA", &[]),
    (
        "ARG",
        &[
            ("CD", 0.10),
            ("NE", -0.10),
            ("CZ", 0.50),
            ("NH1", 0.25),
            ("NH2", 0.25),
        ],
    ),
    ("ARN", &[]),
    ("ASN", &[("CG", 0.55), ("OD1", -0.55)]),
    (
        "ASP",
        &[("CB", -0.16), ("CG", 0.36), ("OD1", -0.60), ("OD2", -0.60)],
    ),
    ("ASH", &[("CG", 0.55), ("OD1", -0.55)]),
    ("CYS", &[("CB", 0.19), ("SG", -0.19)]),
    ("CYM", &[("SG", -1.0)]),
    ("GLN", &[("CD", 0.55), ("OE1", -0.55)]),
    (
        "GLU",
        &[("CG", -0.16), ("CD", 0.36), ("OE1", -0.60), ("OE2", -0.60)],
    ),
    ("GLH", &[("CD", 0.55), ("OE1", -0.55)]),
    ("GLY", &[]),
    (
        "HIS",
        &[
            ("CG", 0.10),
            ("ND1", -0.10),
            ("CD2", 0.10),
            ("NE2", -0.40),
            ("CE1", 0.30),
        ],
    ),
    // The proton on the other nitrogen.
    (
        "HIE",
        &[
            ("CG", 0.10),
            ("ND1", -0.40),
            ("CD2", 0.10),
            ("NE2", -0.10),
            ("CE1", 0.30),
        ],
    ),
    (
        "HIP",
        &[
            ("CB", 0.10),
            ("CG", 0.15),
            ("CD2", 0.20),
            ("ND1", 0.05),
            ("NE2", 0.05),
            ("CE1", 0.45),
        ],
    ),
    // Without a proton, between two metals.
    ("HIS-", &[("ND1", -0.5), ("NE2", -0.5)]),
    ("ILE", &[]),
    ("LEU", &[]),
    ("LYS", &[("CE", 0.25), ("NZ", 0.75)]),
    ("LYN", &[]),
    ("MET", &[("CG", 0.06), ("SD", -0.12), ("CE", 0.06)]),
    ("MSE", &[("CG", 0.06), ("SE", -0.12), ("CE", 0.06)]),
    ("PHE", &[]),
    ("PRO", &[]),
    ("HYP", &[]),
    ("SEC", &[("CB", 0.19), ("SE", -0.19)]),
    ("SER", &[("CB", 0.25), ("OG", -0.25)]),
    ("THR", &[("CB", 0.25), ("OG1", -0.25)]),
    (
        "TRP",
        &[
            ("CG", -0.03),
            ("CD2", 0.10),
            ("CE2", -0.04),
            ("CE3", -0.03),
            ("CD1", 0.06),
            ("NE1", -0.06),
        ],
    ),
    ("TYR", &[("CZ", 0.25), ("OH", -0.25)]),
    ("TYR-", &[("CZ", 0.25), ("OH", -1.25)]),
    ("VAL", &[]),
    // Phosphates of two charges, a sulphate of one.
    ("SEP", &PHOSPHATE),
    ("TPO", &PHOSPHATE),
    ("PTR", &PHOSPHATE),
    (
        "TYS",
        &[("O1", -1.0 / 3.0), ("O2", -1.0 / 3.0), ("O3", -1.0 / 3.0)],
    ),
    // Methylated and carboxylated lysine, carboxylated glutamate.
    ("MLZ", &[("NZ", 1.0)]),
    ("MLY", &[("NZ", 1.0)]),
    ("M3L", &[("NZ", 1.0)]),
    ("KCX", &[("OQ1", -0.5), ("OQ2", -0.5)]),
    (
        "CGU",
        &[
            ("OE11", -0.5),
            ("OE12", -0.5),
            ("OE21", -0.5),
            ("OE22", -0.5),
        ],
    ),
    // Oxidised cysteines that stay neutral.
    ("CSO", &[]),
    ("CME", &[]),
];

const PHOSPHATE: [(&str, f64); 3] = [
    ("O1P", -2.0 / 3.0),
    ("O2P", -2.0 / 3.0),
    ("O3P", -2.0 / 3.0),
];

/// Nucleotides: -1 for each phosphate within the chain.
pub(crate) const NUCLEOTIDE: Charges = &[
    ("OP1", -0.5),
    ("OP2", -0.5),
    ("O1P", -0.5),
    ("O2P", -0.5),
    // The free end of a terminal phosphate.
    ("OP3", -1.0),
    ("O3P", -1.0),
];

/// Cofactors whose charge is known.
///
/// Heme has its two propionates and Fe(II) in a porphyrin of -2. Clusters of iron and sulphide count as they are
/// oxidised, [2Fe-2S] and [4Fe-4S] of +2 and [3Fe-4S] of +1, without the thiolates that hold them.
const COFACTORS: [(&str, Charges); 6] = [
    ("HEM", HEME),
    ("HEC", HEME),
    ("HEA", HEME),
    ("FES", &[("FE1", 1.0), ("FE2", 1.0)]),
    (
        "F3S",
        &[("FE1", 1.0 / 3.0), ("FE3", 1.0 / 3.0), ("FE4", 1.0 / 3.0)],
    ),
    (
        "SF4",
        &[("FE1", 0.5), ("FE2", 0.5), ("FE3", 0.5), ("FE4", 0.5)],
    ),
];

const HEME: Charges = &[
    ("FE", 2.0),
    ("NA", -0.5),
    ("NB", -0.5),
    ("NC", -0.5),
    ("ND", -0.5),
    ("O1A", -0.5),
    ("O2A", -0.5),
    ("O1D", -0.5),
    ("O2D", -0.5),
];

/// Ions by residue name where the name determines the charge, else by element.
const IONS: [(&str, f64); 34] = [
    ("FE2", 2.0),
    ("CU1", 1.0),
    ("MN3", 3.0),
    ("3CO", 3.0),
    ("Li", 1.0),
    ("Na", 1.0),
    ("K", 1.0),
    ("Rb", 1.0),
    ("Cs", 1.0),
    ("Tl", 1.0),
    ("Ag", 1.0),
    ("Au", 1.0),
    ("Mg", 2.0),
    ("Ca", 2.0),
    ("Sr", 2.0),
    ("Ba", 2.0),
    ("Mn", 2.0),
    ("Co", 2.0),
    ("Ni", 2.0),
    ("Cu", 2.0),
    ("Zn", 2.0),
    ("Cd", 2.0),
    ("Hg", 2.0),
    ("Pb", 2.0),
    ("Fe", 3.0),
    ("Al", 3.0),
    ("Y", 3.0),
    ("La", 3.0),
    ("Gd", 3.0),
    ("Yb", 3.0),
    ("F", -1.0),
    ("Cl", -1.0),
    ("Br", -1.0),
    ("I", -1.0),
];

fn find<T: Copy>(table: &[(&str, T)], name: &str) -> Option<T> {
    table
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, value)| *value)
}

/// Charges of a side chain in the state that its name and the pH call for; `None` for a residue that is not known.
pub(crate) fn side_chain(residue_name: &str, ph: f64) -> Option<Charges> {
    let state = match residue_name {
        "ASPP" => "ASH",
        "GLUP" => "GLH",
        "HSP" => "HIP",
        "HID" | "HSD" => return find(&SIDE_CHAINS, "HIS"),
        "HSE" => "HIE",
        "CYX" | "CYZ" | "CYN" => return find(&SIDE_CHAINS, "CYS"),
        "LSN" => "LYN",
        "LYP" => return find(&SIDE_CHAINS, "LYS"),
        // Which of the two was not distinguished: half of them carry a charge, none is counted.
        "ASX" => "ASN",
        "GLX" => "GLN",
        other => other,
    };
    let state = TITRATABLE.iter().find(|(name, ..)| *name == state).map_or(
        state,
        |&(_, pka, protonated, not)| {
            if ph < pka { protonated } else { not }
        },
    );
    find(&SIDE_CHAINS, state)
}

/// Whether the charges of a modified amino acid of this name are known: it is not a standard one, nor a state of one.
pub(crate) fn is_modified(residue_name: &str) -> bool {
    find(&SIDE_CHAINS, residue_name).is_some() && !is_amino_acid(residue_name)
}

/// Charges of a cofactor that is known.
pub(crate) fn cofactor(residue_name: &str) -> Option<Charges> {
    find(&COFACTORS, residue_name)
}

/// Charge of an ion, by residue name or element.
pub(crate) fn ion(residue_name: &str, element: &str) -> Option<f64> {
    find(&IONS, residue_name).or_else(|| find(&IONS, element))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(charges: Charges) -> f64 {
        charges.iter().map(|(_, charge)| charge).sum()
    }

    #[test]
    fn every_residue_sums_to_an_integer() {
        for (name, charges) in SIDE_CHAINS {
            let total = sum(charges);
            assert!((total - total.round()).abs() < 1e-12, "{name}: {total}");
        }
        assert!(sum(BACKBONE).abs() < 1e-12 && sum(PROLINE).abs() < 1e-12);
        // C and O stay at an amino terminus, N and CA at a carboxyl terminus.
        assert!((sum(AMINO_TERMINUS) - 1.0).abs() < 1e-12);
        assert!((sum(PROLINE_TERMINUS) - 1.0).abs() < 1e-12);
        assert!((CARBOXYL_CARBON + CARBOXYL_OXYGENS + 1.0).abs() < 1e-12);
        for (name, charges) in COFACTORS {
            let expected = match name {
                "FES" | "SF4" => 2.0,
                "F3S" => 1.0,
                _ => -2.0,
            };
            assert!((sum(charges) - expected).abs() < 1e-12, "{name}");
        }
    }

    #[test]
    fn states_follow_the_ph_and_the_name() {
        let total = |name: &str, ph: f64| sum(side_chain(name, ph).unwrap()).round();
        for (name, at_2, at_7, at_14) in [
            ("ASP", 0.0, -1.0, -1.0),
            ("GLU", 0.0, -1.0, -1.0),
            ("HIS", 1.0, 0.0, 0.0),
            ("CYS", 0.0, 0.0, -1.0),
            ("TYR", 0.0, 0.0, -1.0),
            ("LYS", 1.0, 1.0, 0.0),
            ("ARG", 1.0, 1.0, 0.0),
            ("HIP", 1.0, 1.0, 1.0),
            ("LYN", 0.0, 0.0, 0.0),
            ("SEP", -2.0, -2.0, -2.0),
            ("TYR-", -1.0, -1.0, -1.0),
            ("HIS-", -1.0, -1.0, -1.0),
        ] {
            let found = [2.0, 7.0, 14.0].map(|ph| total(name, ph));
            assert_eq!(found, [at_2, at_7, at_14], "{name}");
        }
        assert!(side_chain("XYZ", 7.0).is_none());
    }

    #[test]
    fn ions_by_name_before_element() {
        assert_eq!(ion("FE2", "Fe"), Some(2.0));
        assert_eq!(ion("FE", "Fe"), Some(3.0));
        assert_eq!(ion("CL", "Cl"), Some(-1.0));
        assert_eq!(ion("XE", "Xe"), None);
    }
}
