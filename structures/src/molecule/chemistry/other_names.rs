//! Amino acids under other names than the tables have: D-amino acids, names of force fields, names for the termini.
//!
//! A residue is what its atoms make it:
//!
//! - A name of the tables (`ALA`, `HIE`, `CYX`, ...) keeps its meaning, and so does that of a modified residue whose
//!   charges are known.
//! - A name that says which amino acid it stands for (D-amino acids of the wwPDB; GROMOS's and AMBER's names, those of
//!   the termini included) is read so where no atom contradicts. Where it says the charge state, too, the state is
//!   read: `ASPH` is neutral.
//! - Under any other name a residue with exactly a standard residue's heavy atoms is that residue. The wwPDB gives
//!   names of their own to molecules with the same atom names that are something else (norvaline has proline's); the
//!   table has those, and they stay as they are.
//!
//! Hydrogens and sites without mass do not count. D- and L-amino acids have the same radii, charges and contact types
//! here.

use crate::molecule::chemistry::atom_names::links_nucleotides;
use crate::molecule::chemistry::charge_table::is_modified;
use crate::molecule::chemistry::residues::{
    amino_acid_type, is_amino_acid, is_water, side_chains, standard_atom_name,
};
use crate::molecule::chemistry::site_names::is_site_name;

/// Amino acids and their states by other names.
///
/// D-amino acids: wwPDB Chemical Component Dictionary. GROMOS and its OPLS names in GROMACS: `LYSH` is the charged
/// lysine, `HISA` and `HISB` carry their proton on ND1 and NE2, `CYS2` is half a disulphide. Others: CHARMM (`HSC`),
/// Maestro (`CYT`, `TYO`), TINKER (`TYD`, `LYD`), Rosetta (`CYD`, half a disulphide), CYANA (`LYS+`, `ASP-`), and
/// AMBER at constant pH (`AS4`, `GL4`).
const OTHER_NAMES: [(&str, &str); 53] = [
    ("DAL", "ALA"),
    ("DAR", "ARG"),
    ("DSG", "ASN"),
    ("DAS", "ASP"),
    ("DSP", "ASP"),
    ("DCY", "CYS"),
    ("DGN", "GLN"),
    ("DGL", "GLU"),
    ("DHI", "HIS"),
    ("DIL", "ILE"),
    ("DLE", "LEU"),
    ("DLY", "LYS"),
    ("MED", "MET"),
    ("DPN", "PHE"),
    ("DPR", "PRO"),
    ("DSN", "SER"),
    ("DTH", "THR"),
    ("DTR", "TRP"),
    ("DTY", "TYR"),
    ("DVA", "VAL"),
    ("ARGH", "ARG"),
    ("ARG+", "ARG"),
    ("ARGN", "ARN"),
    ("ASPH", "ASH"),
    ("AS4", "ASP"),
    ("ASP-", "ASP"),
    ("CYS1", "CYS"),
    ("CYSH", "CYS"),
    ("CYS2", "CYX"),
    ("CYSS", "CYX"),
    ("CYD", "CYX"),
    ("CYS-", "CYM"),
    ("CYT", "CYM"),
    ("GLUH", "GLH"),
    ("GL4", "GLU"),
    ("GLU-", "GLU"),
    ("HIS1", "HID"),
    ("HISA", "HID"),
    ("HISD", "HID"),
    ("HISB", "HIE"),
    ("HISE", "HIE"),
    ("HISH", "HIP"),
    ("HIS+", "HIP"),
    ("HIH", "HIP"),
    ("HSC", "HIP"),
    ("LYSH", "LYS"),
    ("LYS+", "LYS"),
    ("LYD", "LYN"),
    ("LYSN", "LYN"),
    ("TYD", "TYR-"),
    ("TYM", "TYR-"),
    ("TYO", "TYR-"),
    ("TYRU", "TYR-"),
];

/// Names that the wwPDB gives to other molecules whose heavy atoms are named like those of a standard amino acid.
///
/// They are beta- and didehydro-amino acids, aldehydes, alcohols and isomers of the side chain (Chemical Component
/// Dictionary, searched in November 2026).
const OTHER_MOLECULES: &str = "0XC 0XD 1VR 23F 2KZ 2PI 41Q 4VI 5XU 7F4 8F4 8GZ 8LJ A1CAB A1H2D AKZ ALC ALV AR7 ASA ASJ B2N B3D B3X BAL \
    BB9 BTA DCL DHA DYA DYL ECC EHP ETA F9D FGA GAU GGL GLJ GLK GLQ GLZ HHI HPH HSO HSV I4G IAR IAS IB9 IL0 ITR KBE KFB LCZ LOL LPH LYH \
    LYJ LYK MEU MH6 MTY NLY NVA OAR PDH PHA PHL PQ4 QCI RGL RON RX9 RXL SFE SGI SOW SRI THO TYB TYE TYW UN2 VAI VOL";

/// The name under which the tables have a residue: of an amino acid under another name that of the amino acid, in the
/// state that the other name says; of all else the name itself. `atoms` are names and elements; an element may be blank
/// or nonsense, as in a file's column.
pub(crate) fn known_as<'a, 'b>(
    residue_name: &'a str,
    atoms: impl Iterator<Item = (&'b str, &'b str)>,
) -> &'a str {
    if is_amino_acid(residue_name) || is_water(residue_name) || is_modified(residue_name) {
        return residue_name;
    }
    let heavy: Vec<&str> = atoms
        .filter(|(name, element)| !is_light(name, element))
        .map(|(name, _)| name)
        .collect();
    if !heavy.contains(&"CA") || heavy.iter().any(|name| links_nucleotides(name)) {
        return residue_name;
    }
    if let Some(named) = by_name(residue_name)
        && heavy
            .iter()
            .all(|atom| amino_acid_type(named, atom).is_some())
    {
        return named;
    }
    if OTHER_MOLECULES
        .split_ascii_whitespace()
        .any(|other| other == residue_name)
    {
        return residue_name;
    }
    match by_atoms(&heavy) {
        // Unknown by name: what is seen of it is what every residue has.
        Some("GLY" | "ALA") if matches!(residue_name, "UNK" | "XAA") => residue_name,
        Some(standard) => standard,
        None => residue_name,
    }
}

/// What a name says of itself; N, C and D before a name of four letters or more are those of an end or of a D-amino
/// acid.
fn by_name(name: &str) -> Option<&str> {
    let own = |name| {
        let known = OTHER_NAMES.iter().find(|(other, _)| *other == name);
        match known {
            Some(&(_, standard)) => Some(standard),
            None => is_amino_acid(name).then_some(name),
        }
    };
    own(name).or_else(|| {
        let rest = name.strip_prefix(['N', 'C', 'D'])?;
        if rest.len() >= 3 { own(rest) } else { None }
    })
}

/// The standard residue that has exactly these heavy atoms, oxygens of a chain's end aside.
fn by_atoms(heavy: &[&str]) -> Option<&'static str> {
    let has = |wanted: &str| heavy.contains(&wanted);
    let oxygen = heavy
        .iter()
        .any(|name| *name == "O" || standard_atom_name("", name) == "OXT");
    if !(has("N") && has("CA") && has("C") && oxygen) {
        return None;
    }
    let found = side_chains().find(|(residue, side_chain)| {
        let is_there = |atom: &str| {
            heavy
                .iter()
                .any(|name| standard_atom_name(residue, name) == atom)
        };
        side_chain.iter().all(|(atom, _)| is_there(atom))
            && heavy
                .iter()
                .all(|name| amino_acid_type(residue, name).is_some())
    });
    found.map(|(residue, _)| residue)
}

/// Whether an atom is hydrogen, or a site without mass.
fn is_light(name: &str, element: &str) -> bool {
    if matches!(element, "H" | "D" | "T") {
        return true;
    }
    let is_blank = element.is_empty();
    let letters = name.trim_start_matches(|c: char| !c.is_ascii_alphabetic());
    (is_blank && letters.starts_with(['H', 'D'])) || is_site_name(name, element)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The heavy atoms of a standard residue, as a file without an element column has them.
    fn atoms(standard: &str) -> Vec<(&'static str, &'static str)> {
        let (_, side_chain) = side_chains().find(|(name, _)| *name == standard).unwrap();
        let backbone = ["N", "CA", "C", "O"].into_iter();
        let names = backbone.chain(side_chain.iter().map(|(name, _)| *name));
        names.map(|name| (name, "")).collect()
    }

    fn of<'a>(name: &'a str, atoms: &[(&'static str, &'static str)]) -> &'a str {
        known_as(name, atoms.iter().copied())
    }

    /// Found by users: D-amino acids and four-letter names of force fields lost charges, contact types and rescoring.
    #[test]
    fn every_standard_residue_is_found_by_its_atoms() {
        for (name, _) in side_chains() {
            assert_eq!(of("XYZ1", &atoms(name)), name);
            let mut whole = atoms(name);
            whole.extend([("OXT", "O"), ("HA", ""), ("1HB", "H"), ("LPOA", "")]);
            assert_eq!(of("Q1", &whole), name);
        }
        for (other, _) in OTHER_NAMES {
            assert!(!is_amino_acid(other) && !is_modified(other), "{other}");
        }
    }

    #[test]
    fn names_that_say_the_state_keep_it() {
        for (name, standard, expected) in [
            ("ASPH", "ASP", "ASH"),
            ("LYSH", "LYS", "LYS"),
            ("HISB", "HIS", "HIE"),
            ("NHIP", "HIS", "HIP"),
            ("CCYX", "CYS", "CYX"),
            ("NARG", "ARG", "ARG"),
            ("DHSE", "HIS", "HSE"),
            ("CYD", "CYS", "CYX"),
            ("TYM", "TYR", "TYR-"),
            ("CYT", "CYS", "CYM"),
            ("DGN", "GLN", "GLN"),
        ] {
            assert_eq!(of(name, &atoms(standard)), expected, "{name}");
        }
        // Of an incomplete side chain the name says what the atoms cannot.
        let all = atoms("LYS");
        assert_eq!(of("CLYS", &all[..6]), "LYS");
        assert_eq!(of("XLY", &all[..6]), "XLY");
        // Isoleucine's CD1 as GROMOS has it, and both oxygens of an end as GROMACS has them.
        let mut end = atoms("ILE");
        end.retain(|(name, _)| !["O", "CD1"].contains(name));
        end.extend([("CD", "C"), ("OC1", "O"), ("OC2", "O")]);
        assert_eq!(of("X", &end), "ILE");
    }

    #[test]
    fn what_is_no_standard_residue_stays() {
        // An atom more or less, another molecule of the same atom names, a modified residue, an unknown one.
        let mut more = atoms("SER");
        more.push(("P", "P"));
        assert_eq!(of("XSP", &more), "XSP");
        assert_eq!(of("SEP", &atoms("SER")), "SEP");
        assert_eq!(of("NVA", &atoms("PRO")), "NVA");
        assert_eq!(of("UNK", &atoms("ALA")), "UNK");
        assert_eq!(of("UNK", &atoms("VAL")), "VAL");
        // Names of other molecules that begin or read like those of the table.
        assert_eq!(of("CYT", &[("N1", "N"), ("C2", "C")]), "CYT");
        assert_eq!(of("TYM", &[("CA", "C"), ("P", "P")]), "TYM");
        assert_eq!(of("HIP", &atoms("HIS")), "HIP");
    }
}
