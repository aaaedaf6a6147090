//! Charges of united atoms: each heavy atom carries those of its hydrogens. They are in the table beside this file, with
//! their sources.
//!
//! The state of an acid or base follows from its residue name if that says so (ASH, GLH, HIP, LYN, CYM, ...), else from
//! the pH and a pKa. The pKa are those of alanine pentapeptides, Thurlkill, Grimsley, Scholtz & Pace, Protein Sci. 15
//! (2006) 1214-1218. Arginine has 13.8: Fitch, Platzer, Okon, Garcia-Moreno & McIntosh, Protein Sci. 24 (2015) 752-761.

use std::collections::HashMap;
use std::sync::LazyLock;

use crate::molecule::chemistry::{element, is_amino_acid};

/// Lines of `#`, and lines of a section, a name, and atoms with their charges.
const TABLE: &str = include_str!("charges.txt");

/// Charges in e by atom name.
pub(crate) type Charges = &'static [(&'static str, f64)];

type Sections = HashMap<&'static str, HashMap<&'static str, Vec<(&'static str, f64)>>>;

static CHARGES: LazyLock<Sections> = LazyLock::new(|| {
    let charge = |text: &str| match text.split_once('/') {
        Some((a, b)) => Some(a.parse::<f64>().ok()? / b.parse::<f64>().ok()?),
        None => text.parse().ok(),
    };
    let mut sections = Sections::new();
    for line in TABLE
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
    {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let [section, name, atoms @ ..] = words.as_slice() else {
            // The table is part of the program, and tests read it.
            unreachable!("charges.txt: not a row: `{line}`")
        };
        let atoms = atoms
            .chunks(2)
            .map(|pair| Some((pair[0], charge(pair.get(1)?)?)));
        let atoms: Option<Vec<_>> = atoms.collect();
        let atoms = atoms.unwrap_or_else(|| unreachable!("charges.txt: no number in `{line}`"));
        sections.entry(section).or_default().insert(name, atoms);
    }
    sections
});

fn find(section: &str, name: &str) -> Option<Charges> {
    CHARGES.get(section)?.get(name).map(Vec::as_slice)
}

/// Charges for this residue, or for any, in a section that has an entry for any.
fn find_or_any(section: &str, residue_name: &str) -> Charges {
    let found = find(section, residue_name);
    found.or_else(|| find(section, "any")).unwrap_or(&[])
}

/// Backbone within a chain.
pub(crate) fn backbone(residue_name: &str) -> Charges {
    find_or_any("backbone", parent_of_proline(residue_name))
}

/// What replaces the backbone's at a charged amino terminus.
pub(crate) fn amino_terminus(residue_name: &str) -> Charges {
    find_or_any("terminus", parent_of_proline(residue_name))
}

/// Hydroxyproline has proline's backbone.
fn parent_of_proline(residue_name: &str) -> &str {
    if residue_name == "HYP" {
        "PRO"
    } else {
        residue_name
    }
}

/// What replaces the backbone's at a charged carboxyl terminus: the carbon's charge, and that of the oxygens together.
pub(crate) const CARBOXYL: [f64; 2] = [0.14, -1.14];

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

pub(crate) fn nucleotide() -> Charges {
    find_or_any("nucleotide", "any")
}

/// Charges of a side chain in the state that its name and the pH call for; `None` for a residue that is not known.
pub(crate) fn side_chain_charges(residue_name: &str, ph: f64) -> Option<Charges> {
    let state = match residue_name {
        "ASPP" => "ASH",
        "GLUP" => "GLH",
        "HSP" => "HIP",
        "HID" | "HSD" => return find("side", "HIS"),
        "HSE" => "HIE",
        "CYX" | "CYZ" | "CYN" => return find("side", "CYS"),
        "LSN" => "LYN",
        "LYP" => return find("side", "LYS"),
        // Which of the two was not distinguished: half of them carry a charge, none is counted.
        "ASX" => "ASN",
        "GLX" => "GLN",
        other => other,
    };
    let titratable = TITRATABLE.iter().find(|(name, ..)| *name == state);
    let at_ph = |&(_, pka, protonated, not)| if ph < pka { protonated } else { not };
    find("side", titratable.map_or(state, at_ph))
}

/// Whether the charges of a modified amino acid of this name are known: it is not a standard one, nor a state of one.
pub(crate) fn is_modified(residue_name: &str) -> bool {
    find("side", residue_name).is_some() && !is_amino_acid(residue_name)
}

pub(crate) fn cofactor(residue_name: &str) -> Option<Charges> {
    find("cofactor", residue_name)
}

/// Charge of an ion, by residue name or element.
pub(crate) fn ion(residue_name: &str, symbol: &str) -> Option<f64> {
    let of = |name| {
        let named = find("ion", name).and_then(|atoms| atoms.first());
        named
            .map(|(_, charge)| *charge)
            .or_else(|| element(name)?.charge)
    };
    of(residue_name).or_else(|| of(symbol))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(charges: &[(&str, f64)]) -> f64 {
        charges.iter().map(|(_, charge)| charge).sum()
    }

    #[test]
    fn every_residue_sums_to_an_integer() {
        let all = CHARGES.iter();
        let rows = all.flat_map(|(section, rows)| rows.iter().map(move |row| (*section, row)));
        for (section, (name, charges)) in rows {
            let total = sum(charges);
            let expected = match (section, *name) {
                ("backbone", _) => 0.0,
                // C and O stay at an amino terminus, N and CA at a carboxyl terminus.
                ("terminus", _) | ("cofactor", "F3S") => 1.0,
                ("cofactor", "FES" | "SF4") => 2.0,
                ("cofactor", _) => -2.0,
                ("nucleotide", _) => -4.0,
                _ => total.round(),
            };
            assert!(
                (total - expected).abs() < 1e-12,
                "{section} {name}: {total}"
            );
        }
        assert!((CARBOXYL.iter().sum::<f64>() + 1.0).abs() < 1e-12);
        assert!(!backbone("ALA").is_empty() && backbone("PRO").len() == 5);
        assert!(!amino_terminus("ALA").is_empty() && amino_terminus("HYP").len() == 3);
        assert_eq!(nucleotide().len(), 6);
    }

    #[test]
    fn states_follow_the_ph_and_the_name() {
        let total = |name: &str, ph: f64| sum(side_chain_charges(name, ph).unwrap()).round();
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
        assert!(side_chain_charges("XYZ", 7.0).is_none());
    }

    #[test]
    fn ions_by_name_before_element() {
        assert_eq!(ion("FE2", "Fe"), Some(2.0));
        assert_eq!(ion("FE", "Fe"), Some(3.0));
        assert_eq!(ion("CL", "Cl"), Some(-1.0));
        assert_eq!(ion("XE", "Xe"), None);
    }
}
