//! Names of atoms and residues: those of force fields and old files as the wwPDB has them today.
//!
//! Amino acids come under other names than the tables have: D-amino acids, names of force fields, names for the
//! termini. The atoms of a residue decide its kind:
//!
//! - A name of the tables (`ALA`, `HIE`, `CYX`, ...) keeps its meaning, and so does that of a modified residue whose
//!   charges are known.
//! - A name that states its amino acid (D-amino acids of the wwPDB; GROMOS's and AMBER's names, those of the termini
//!   included) is read so if no atom contradicts. Its charge state is taken too: `ASPH` is neutral.
//! - Under any other name a residue with exactly a standard residue's heavy atoms is that residue. The wwPDB gives
//!   separate names to other molecules with the same atom names (norvaline has proline's); the table has those, and
//!   they stay as they are.
//!
//! Hydrogens and sites without mass do not count. D- and L-amino acids have the same radii, charges and contact types
//! here.

use std::borrow::Cow;

use crate::molecule::chemistry::{
    amino_acid_type, base, column_symbol, is_amino_acid, is_modified, is_water, parent,
    side_chains, standard_atom_name,
};
use crate::molecule::model::Atom;

/// The plain name of an atom: `'` where files from before the remediation of 2007 have `*` in a sugar, and `OP1` for
/// their `O1P`.
pub fn plain_atom_name(atom_name: &str) -> Cow<'_, str> {
    match atom_name {
        "O1P" => Cow::Borrowed("OP1"),
        "O2P" => Cow::Borrowed("OP2"),
        "O3P" => Cow::Borrowed("OP3"),
        starred if starred.contains('*') => Cow::Owned(starred.replace('*', "'")),
        plain => Cow::Borrowed(plain),
    }
}

/// Whether an atom of this name shows that a residue of a nucleotide's name is one: it links a sugar to its neighbour.
/// Ruthenium (`RU`), indium iodide (`IN`) and a thyroid hormone (`T3`) are named like nucleotides.
pub(crate) fn links_nucleotides(atom_name: &str) -> bool {
    matches!(plain_atom_name(atom_name).as_ref(), "P" | "O3'" | "O5'")
}
/// The atom after which GROMACS names the two masses that stand for a group: `MCB1` and `MCB2` for the methyl of `CB`.
pub(crate) fn mass_center(name: &str) -> Option<&str> {
    name.strip_prefix('M')?.strip_suffix(['1', '2'])
}

/// Whether sites without mass have such a name, and no atom of an amino acid does.
///
/// These are lone pairs and extra points (`LPOA`, `EP1`), mass centres (`MN1`, `MW1` of tryptophan), virtual and
/// centroid atoms and orbitals of Rosetta (`NV`, `V1`, `CEN`, `ORB1`), and pseudo-atoms of NMR (`QB`).
pub(crate) fn is_site_name(name: &str, column: &str) -> bool {
    if matches!(name, "CEN" | "NV") {
        return true;
    }
    let is_centre = || mass_center(name).is_some_and(|heavy| heavy.starts_with(['C', 'N', 'W']));
    column_symbol(column).is_none()
        && (["LP", "EP", "ORB", "V", "Q"]
            .iter()
            .any(|start| name.starts_with(start))
            || is_centre())
}

/// The plain name of a residue: of a protonation state or a disulphide's half the amino acid (`CYX` is `CYS`), of a
/// nucleotide its base as one letter (`DA`, `ADE` and `RA3` are `A`). For all others the name itself.
pub fn plain_residue_name(residue_name: &str) -> &str {
    base(residue_name).unwrap_or_else(|| parent(residue_name))
}

/// The name under which the tables have a residue: that of a standard amino acid or of a state of one, else its own.
///
/// A standard amino acid under another name is recognised by its atoms or its name (`DAL` is `ALA`, `NHIE` is `HIE`).
pub fn standard_residue_name<'a>(
    residue_name: &'a str,
    atoms: impl IntoIterator<Item = &'a Atom>,
) -> &'a str {
    let atoms = atoms.into_iter();
    known_as(
        residue_name,
        atoms.map(|atom| (atom.name.as_str(), atom.element.as_str())),
    )
}

/// Amino acids and their states by other names.
///
/// D-amino acids: wwPDB Chemical Component Dictionary. GROMOS and its OPLS names in GROMACS: `LYSH` is the charged
/// lysine, `HISA` and `HISB` carry their proton on ND1 and NE2, `CYS2` is half a disulphide. Others: CHARMM (`HSC`),
/// Maestro (`CYT`, `TYO`), TINKER (`TYD`, `LYD`), Rosetta (`CYD`, half a disulphide), CYANA (`LYS+`, `ASP-`), and
/// AMBER at constant pH (`AS4`, `GL4`). Each standard name is followed by the others.
const OTHER_NAMES: [(&str, &str); 29] = [
    ("ALA", "DAL"),
    ("ARG", "DAR ARGH ARG+"),
    ("ASN", "DSG"),
    ("ASP", "DAS DSP AS4 ASP-"),
    ("CYS", "DCY CYS1 CYSH"),
    ("GLN", "DGN"),
    ("GLU", "DGL GL4 GLU-"),
    ("HIS", "DHI"),
    ("ILE", "DIL"),
    ("LEU", "DLE"),
    ("LYS", "DLY LYSH LYS+"),
    ("MET", "MED"),
    ("PHE", "DPN"),
    ("PRO", "DPR"),
    ("SER", "DSN"),
    ("THR", "DTH"),
    ("TRP", "DTR"),
    ("TYR", "DTY"),
    ("VAL", "DVA"),
    ("ARN", "ARGN"),
    ("ASH", "ASPH"),
    ("CYX", "CYS2 CYSS CYD"),
    ("CYM", "CYS- CYT"),
    ("GLH", "GLUH"),
    ("HID", "HIS1 HISA HISD"),
    ("HIE", "HISB HISE"),
    ("HIP", "HISH HIS+ HIH HSC"),
    ("LYN", "LYD LYSN"),
    ("TYR-", "TYD TYM TYO TYRU"),
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
        let is_other = |others: &str| others.split(' ').any(|other| other == name);
        let known = OTHER_NAMES.iter().find(|(_, others)| is_other(others));
        known.map_or(is_amino_acid(name).then_some(name), |&(standard, _)| {
            Some(standard)
        })
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
        side_chain.iter().all(|atom| is_there(atom.name))
            && heavy
                .iter()
                .all(|name| amino_acid_type(residue, name).is_some())
    });
    found.map(|(residue, _)| residue)
}

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
        let names = backbone.chain(side_chain.iter().map(|atom| atom.name));
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
        for other in OTHER_NAMES.iter().flat_map(|(_, others)| others.split(' ')) {
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

    #[test]
    fn names_of_force_fields_and_old_files_become_plain() {
        for (name, plain) in [
            ("LSN", "LYS"),
            ("ARN", "ARG"),
            ("ASPP", "ASP"),
            ("HIM", "HIS"),
            ("CYZ", "CYS"),
            ("DA5", "A"),
            ("RA3", "A"),
            ("RU", "U"),
            ("URI", "U"),
            ("THY", "T"),
            ("ALA", "ALA"),
            ("HEM", "HEM"),
        ] {
            assert_eq!(plain_residue_name(name), plain);
        }
        for (name, plain) in [("O1P", "OP1"), ("C5*", "C5'"), ("O5'", "O5'"), ("CA", "CA")] {
            assert_eq!(plain_atom_name(name), plain);
        }
    }
}
