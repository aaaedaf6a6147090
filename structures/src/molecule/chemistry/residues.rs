//! Residues whose chemistry is known by name: amino acids, nucleotides, water.
//!
//! Names are those of the wwPDB Chemical Component Dictionary, and the protonation variants of AMBER and CHARMM, which
//! are the same heavy atoms. The atoms of amino acids, with their radius classes and contact types, are in the table
//! beside this file, which the scripts that derive potentials read too.

use std::sync::LazyLock;

use crate::molecule::chemistry::plain_atom_name;

/// Lines of `#`, a header, then residue, atom, class, contact type and kind.
const TABLE: &str = include_str!("amino_acids.csv");

/// Names of the contact types; a type's number is its place here.
pub const CONTACT_TYPES: [&str; 18] = [
    "N", "CA", "C", "O", "GCA", "CB", "KNZ", "KCD", "DOD", "RNH", "NNN", "RNE", "SOG", "HNE",
    "YCZ", "FCZ", "LCD", "CSG",
];

/// A radius class of Tsai, Taylor, Chothia & Gerstein, J. Mol. Biol. 290 (1999) 253-266: element, number of bonds (4:
/// tetrahedral, 3: trigonal carbon), number of hydrogens.
#[derive(Debug, PartialEq)]
pub(crate) struct RadiusClass {
    name: &'static str,
    pub(crate) element: &'static str,
    /// United-atom radius, in Å.
    pub(crate) radius: f64,
}

const fn class(name: &'static str, element: &'static str, radius: f64) -> RadiusClass {
    RadiusClass {
        name,
        element,
        radius,
    }
}

/// Carbonyl, carboxyl and aromatic carbon without hydrogen.
pub(crate) static C3H0: RadiusClass = class("C3H0", "C", 1.61);
/// Aromatic carbon with hydrogen.
pub(crate) static C3H1: RadiusClass = class("C3H1", "C", 1.76);
/// Aliphatic carbon: CH, CH2 and CH3 have the same radius.
pub(crate) static C4: RadiusClass = class("C4", "C", 1.88);
/// Nitrogen of any kind: all have the same radius.
pub(crate) static N: RadiusClass = class("N", "N", 1.64);
/// Carbonyl and carboxyl oxygen.
pub(crate) static O1H0: RadiusClass = class("O1H0", "O", 1.42);
/// Hydroxyl oxygen; ether and ester oxygen of nucleotides and sugars too.
pub(crate) static O2H1: RadiusClass = class("O2H1", "O", 1.46);
/// Thiol and thioether sulphur.
pub(crate) static S: RadiusClass = class("S", "S", 1.77);
/// Selenium of selenocysteine and selenomethionine.
pub(crate) static SE: RadiusClass = class("Se", "Se", 1.90);
/// Phosphorus of phosphates.
pub(crate) static P: RadiusClass = class("P", "P", 1.80);

static CLASSES: [&RadiusClass; 8] = [&C3H0, &C3H1, &C4, &N, &O1H0, &O2H1, &S, &SE];

/// Number of backbone atoms, which come first in every residue of the table.
const BACKBONE: usize = 5;

#[derive(Debug)]
pub(crate) struct KnownAtom {
    pub(crate) name: &'static str,
    pub(crate) class: &'static RadiusClass,
    /// Place in [`CONTACT_TYPES`].
    pub(crate) contact: u8,
    /// Place in [`atom_kinds`].
    pub(crate) kind: u8,
}

struct AminoAcids {
    residues: Vec<(&'static str, Vec<KnownAtom>)>,
    kinds: Vec<&'static str>,
}

static AMINO_ACIDS: LazyLock<AminoAcids> = LazyLock::new(|| {
    let mut residues: Vec<(&'static str, Vec<KnownAtom>)> = Vec::new();
    let mut kinds = Vec::new();
    // The table is part of the program, and tests read it.
    let no_row = |line: &str| unreachable!("amino_acids.csv: not an atom: `{line}`");
    for line in TABLE.lines().filter(|line| !line.starts_with('#')).skip(1) {
        let &[residue, name, class, contact, kind] = &*line.split(',').collect::<Vec<_>>() else {
            no_row(line)
        };
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
        let class = CLASSES.iter().find(|known| known.name == class);
        let contact = CONTACT_TYPES.iter().position(|known| *known == contact);
        let kind = kinds.iter().position(|known| *known == kind);
        let place = |place: Option<usize>| u8::try_from(place?).ok();
        let (Some(&class), Some(contact), Some(kind)) = (class, place(contact), place(kind)) else {
            no_row(line)
        };
        let atom = KnownAtom {
            name,
            class,
            contact,
            kind,
        };
        match residues.last_mut() {
            Some((last, atoms)) if *last == residue => atoms.push(atom),
            _ => residues.push((residue, vec![atom])),
        }
    }
    AminoAcids { residues, kinds }
});

/// Names of the kinds of amino acid atoms, residue and atom as in `ARG_CZ`; a kind's number is its place here.
///
/// Atoms that a rotation or a proton's choice makes alike are of one kind. These are the oxygens of a carboxylate, both
/// sides of a ring, and the two methyls of valine and of leucine, whose names files exchange.
pub fn atom_kinds() -> &'static [&'static str] {
    &AMINO_ACIDS.kinds
}

/// The residue of the table that has the same heavy atoms.
pub(crate) fn parent(residue_name: &str) -> &str {
    match residue_name {
        "ASH" | "ASX" | "ASPP" => "ASP",
        "GLH" | "GLX" | "GLUP" => "GLU",
        "CYX" | "CYM" | "CYZ" | "CYN" => "CYS",
        "HID" | "HIE" | "HIP" | "HIM" | "HSD" | "HSE" | "HSP" | "HIS-" => "HIS",
        "LYN" | "LYP" | "LSN" => "LYS",
        "ARN" => "ARG",
        // AMBER's TYM; that name is another molecule's, which only atoms tell from it (`names`).
        "TYR-" => "TYR",
        other => other,
    }
}

pub(crate) fn side_chains() -> impl Iterator<Item = (&'static str, &'static [KnownAtom])> {
    let residues = AMINO_ACIDS.residues.iter();
    residues.map(|(name, atoms)| (*name, &atoms[BACKBONE..]))
}

/// The name that the tables have for an atom of an amino acid.
///
/// It is `CD1` for isoleucine's `CD` of CHARMM and GROMOS, and `OXT` for the terminal oxygens as CHARMM, GROMOS,
/// GROMACS and old entries name them.
pub(crate) fn standard_atom_name<'a>(residue_name: &str, atom_name: &'a str) -> &'a str {
    match (parent(residue_name), atom_name) {
        ("ILE", "CD") => "CD1",
        (_, "OT1" | "OT2" | "O1" | "O2" | "OT" | "OC1" | "OC2") => "OXT",
        (_, other) => other,
    }
}

/// All heavy atoms of a standard amino acid, backbone first.
fn atoms(residue_name: &str) -> Option<&'static [KnownAtom]> {
    let parent = parent(residue_name);
    let found = AMINO_ACIDS
        .residues
        .iter()
        .find(|(name, _)| *name == parent);
    found.map(|(_, atoms)| atoms.as_slice())
}

pub(crate) fn side_chain(residue_name: &str) -> Option<&'static [KnownAtom]> {
    atoms(residue_name).map(|atoms| &atoms[BACKBONE..])
}

pub(crate) fn known_atom(residue_name: &str, atom_name: &str) -> Option<&'static KnownAtom> {
    let name = standard_atom_name(residue_name, atom_name);
    atoms(residue_name)?.iter().find(|atom| atom.name == name)
}

pub(crate) fn amino_acid_type(residue_name: &str, atom_name: &str) -> Option<&'static RadiusClass> {
    known_atom(residue_name, atom_name).map(|atom| atom.class)
}

/// Radius class of a heavy atom of an amino acid's backbone, whatever the residue.
pub(crate) fn backbone_type(atom_name: &str) -> Option<&'static RadiusClass> {
    let name = standard_atom_name("", atom_name);
    let mut backbone = atoms("GLY")?.iter();
    backbone
        .find(|atom| atom.name == name)
        .map(|atom| atom.class)
}

/// Whether this is one of the standard amino acids (or a variant of one).
pub(crate) fn is_amino_acid(residue_name: &str) -> bool {
    side_chain(residue_name).is_some()
}

/// Bases of the nucleotides, as one letter, from the names in use: `DA`, `A`, `ADE`, `RA5`, `DADE`, ...
pub(crate) fn base(residue_name: &str) -> Option<&str> {
    let name = residue_name
        .strip_suffix(['3', '5', 'N'])
        .unwrap_or(residue_name);
    let letter = match name.strip_prefix(['D', 'R']).unwrap_or(name) {
        "ADE" => "A",
        "CYT" => "C",
        "GUA" => "G",
        "THY" => "T",
        "URA" | "URI" => "U",
        letter => letter,
    };
    matches!(letter, "A" | "C" | "G" | "T" | "U" | "I").then_some(letter)
}

/// One letter of a nucleotide by its residue name: A, C, G, T or U.
pub fn nucleotide_letter(residue_name: &str) -> Option<char> {
    let letter = base(residue_name)?.chars().next();
    letter.filter(|&letter| letter != 'I')
}

/// Whether this is the name of one of the standard nucleotides; other molecules have such names too.
pub(crate) fn is_nucleotide(residue_name: &str) -> bool {
    base(residue_name).is_some()
}

/// Whether this is water, heavy water included, under any of the names in use.
pub(crate) fn is_water(residue_name: &str) -> bool {
    const NAMES: [&str; 20] = [
        "HOH", "WAT", "H2O", "DOD", "D2O", "HHO", "OHH", "TIP", "TIP2", "TIP3", "TIP4", "TIP5",
        "TP3", "T3P", "T4P", "SOL", "SOLV", "SPC", "SPCE", "OH2",
    ];
    NAMES.contains(&residue_name)
}

/// Letters of the residues in the order of the table.
const LETTERS: &str = "ARNDCQEGHILKMFPSTWYVMC";

/// One letter of an amino acid by its residue name, X of one outside the twenty.
pub fn one_letter(residue_name: &str) -> char {
    let parent = parent(residue_name);
    let place = AMINO_ACIDS
        .residues
        .iter()
        .position(|(name, _)| *name == parent);
    place
        .and_then(|place| LETTERS.chars().nth(place))
        .unwrap_or('X')
}

/// Atom type of a heavy atom of a standard nucleotide, in the classes that carry over to RNA and DNA: Voss & Gerstein,
/// J. Mol. Biol. 346 (2005) 477-492 (NucProt).
pub(crate) fn nucleotide_type(residue_name: &str, atom_name: &str) -> Option<&'static RadiusClass> {
    let base = base(residue_name)?;
    let name = plain_atom_name(atom_name);
    if name.starts_with('P') {
        return Some(&P);
    }
    if matches!(name.as_ref(), "OP1" | "OP2") {
        return Some(&O1H0);
    }
    if name.ends_with('\'') || name == "OP3" {
        return Some(if name.starts_with('C') { &C4 } else { &O2H1 });
    }
    match (base, name.as_ref()) {
        (_, "C7" | "C5M") => Some(&C4),
        ("A" | "I", "C2") | ("A" | "G" | "I", "C8") => Some(&C3H1),
        ("C" | "U", "C5") | ("C" | "U" | "T", "C6") => Some(&C3H1),
        (_, name) if name.starts_with('C') => Some(&C3H0),
        (_, name) if name.starts_with('N') => Some(&N),
        (_, name) if name.starts_with('O') => Some(&O1H0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// GROMOS writes its water as SOLV, which was kept as a ligand (MDAnalysisTests' gromos11_traj_solv.pdb.gz).
    #[test]
    fn water_of_every_force_field_is_water() {
        for name in ["HOH", "TIP3", "SOL", "SOLV", "SPCE"] {
            assert!(is_water(name), "{name}");
        }
        assert!(!is_water("SOLA") && !is_water("O"));
    }

    #[test]
    fn heavy_atoms_of_the_twenty_amino_acids_are_all_there() {
        // Side-chain heavy atoms from the residues' formulas (backbone N, CA, C, O left out).
        let counts = [
            ("GLY", 0),
            ("ALA", 1),
            ("SER", 2),
            ("CYS", 2),
            ("PRO", 3),
            ("THR", 3),
            ("VAL", 3),
            ("ASN", 4),
            ("ASP", 4),
            ("ILE", 4),
            ("LEU", 4),
            ("MET", 4),
            ("GLN", 5),
            ("GLU", 5),
            ("LYS", 5),
            ("HIS", 6),
            ("ARG", 7),
            ("PHE", 7),
            ("TYR", 8),
            ("TRP", 10),
        ];
        for (name, count) in counts {
            assert_eq!(side_chain(name).unwrap().len(), count, "{name}");
        }
    }

    #[test]
    fn variants_share_their_parents_atoms() {
        assert_eq!(amino_acid_type("HSD", "CE1"), Some(&C3H1));
        assert_eq!(amino_acid_type("CYX", "SG"), Some(&S));
        assert_eq!(amino_acid_type("ILE", "CD"), Some(&C4));
        assert_eq!(amino_acid_type("LYS", "OT2"), Some(&O1H0));
        assert_eq!(amino_acid_type("LYS", "ZZ"), None);
        assert_eq!(amino_acid_type("HEM", "CA"), None);
    }

    #[test]
    fn nucleotides_under_old_and_new_names() {
        for name in [
            "A", "DA", "ADE", "RA5", "DG3", "U", "DT", "I", "DADE", "RURA",
        ] {
            assert!(is_nucleotide(name), "{name}");
        }
        // Alanine's one-letter neighbours and ligands that only look alike.
        for name in ["ALA", "D", "R", "N", "DAL", "GOL", "AA"] {
            assert!(!is_nucleotide(name), "{name}");
        }
        assert_eq!(nucleotide_type("DT", "C5M"), Some(&C4));
        assert_eq!(nucleotide_type("DT", "C5"), Some(&C3H0));
        assert_eq!(nucleotide_type("U", "C5"), Some(&C3H1));
        assert_eq!(nucleotide_type("A", "C5*"), Some(&C4));
        assert_eq!(nucleotide_type("A", "O2'"), Some(&O2H1));
    }

    #[test]
    fn every_atom_of_the_twenty_is_in_the_table() {
        for (name, side_chain) in side_chains() {
            for atom in ["N", "CA", "C", "O", "OXT"] {
                assert!(known_atom(name, atom).is_some(), "{name} {atom}");
            }
            assert_eq!(side_chain.is_empty(), name == "GLY");
        }
        let kind = |residue, atom| known_atom(residue, atom).unwrap().kind;
        assert_eq!(kind("HSD", "ND1"), kind("HIS", "ND1"));
        assert!(known_atom("HEM", "CA").is_none());
        // 167 atoms without OXT, of which nine are alike by symmetry.
        assert_eq!(atom_kinds().len(), 158);
        assert_eq!(kind("ARG", "NH1"), kind("ARG", "NH2"));
        assert_ne!(kind("ALA", "CB"), kind("SER", "CB"));
        assert_eq!(atom_kinds()[usize::from(kind("ALA", "OXT"))], "ALA_O");
        let letters: String = side_chains().map(|(name, _)| one_letter(name)).collect();
        assert_eq!(
            (letters.as_str(), one_letter("HIE"), one_letter("HEM")),
            (LETTERS, 'H', 'X')
        );
    }
}
