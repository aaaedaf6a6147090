//! Residues whose chemistry is known by name: amino acids, nucleotides, water.
//!
//! Names are those of the wwPDB Chemical Component Dictionary, and the protonation variants of AMBER and CHARMM, which
//! stand for the same heavy atoms.

use crate::molecule::chemistry::atom_names::plain_atom_name;

/// Atom types of Tsai, Taylor, Chothia & Gerstein, J. Mol. Biol. 290 (1999) 253-266: element, number of bonds (4:
/// tetrahedral, 3: trigonal carbon), number of hydrogens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AtomType {
    /// Carbonyl, carboxyl and aromatic carbon without hydrogen.
    C3H0,
    /// Aromatic carbon with hydrogen.
    C3H1,
    /// Aliphatic carbon: CH, CH2 and CH3 have the same radius.
    C4,
    /// Nitrogen of any kind: all have the same radius.
    N,
    /// Carbonyl and carboxyl oxygen.
    O1H0,
    /// Hydroxyl oxygen; ether and ester oxygen of nucleotides and sugars too.
    O2H1,
    /// Thiol and thioether sulphur.
    S,
    /// Selenium of selenocysteine and selenomethionine.
    Se,
    /// Phosphorus of phosphates.
    P,
}

use AtomType::{C3H0, C3H1, C4, N, O1H0, O2H1, P, S, Se};

/// Heavy atoms of an amino acid's side chain.
type SideChain = &'static [(&'static str, AtomType)];

/// Backbone atoms of every amino acid. The second oxygen of the C terminus equals the first: the carboxylate is
/// charged.
const BACKBONE: [(&str, AtomType); 5] = [
    ("N", N),
    ("CA", C4),
    ("C", C3H0),
    ("O", O1H0),
    ("OXT", O1H0),
];

/// Side chains of the twenty amino acids, of selenocysteine and of selenomethionine.
///
/// Both oxygens of a carboxylate are O1H0, for the same reason as at the C terminus.
const SIDE_CHAINS: [(&str, SideChain); 22] = [
    ("ALA", &[("CB", C4)]),
    (
        "ARG",
        &[
            ("CB", C4),
            ("CG", C4),
            ("CD", C4),
            ("NE", N),
            ("CZ", C3H0),
            ("NH1", N),
            ("NH2", N),
        ],
    ),
    (
        "ASN",
        &[("CB", C4), ("CG", C3H0), ("OD1", O1H0), ("ND2", N)],
    ),
    (
        "ASP",
        &[("CB", C4), ("CG", C3H0), ("OD1", O1H0), ("OD2", O1H0)],
    ),
    ("CYS", &[("CB", C4), ("SG", S)]),
    (
        "GLN",
        &[
            ("CB", C4),
            ("CG", C4),
            ("CD", C3H0),
            ("OE1", O1H0),
            ("NE2", N),
        ],
    ),
    (
        "GLU",
        &[
            ("CB", C4),
            ("CG", C4),
            ("CD", C3H0),
            ("OE1", O1H0),
            ("OE2", O1H0),
        ],
    ),
    ("GLY", &[]),
    (
        "HIS",
        &[
            ("CB", C4),
            ("CG", C3H0),
            ("ND1", N),
            ("CD2", C3H1),
            ("CE1", C3H1),
            ("NE2", N),
        ],
    ),
    ("ILE", &[("CB", C4), ("CG1", C4), ("CG2", C4), ("CD1", C4)]),
    ("LEU", &[("CB", C4), ("CG", C4), ("CD1", C4), ("CD2", C4)]),
    (
        "LYS",
        &[("CB", C4), ("CG", C4), ("CD", C4), ("CE", C4), ("NZ", N)],
    ),
    ("MET", &[("CB", C4), ("CG", C4), ("SD", S), ("CE", C4)]),
    (
        "PHE",
        &[
            ("CB", C4),
            ("CG", C3H0),
            ("CD1", C3H1),
            ("CD2", C3H1),
            ("CE1", C3H1),
            ("CE2", C3H1),
            ("CZ", C3H1),
        ],
    ),
    ("PRO", &[("CB", C4), ("CG", C4), ("CD", C4)]),
    ("SER", &[("CB", C4), ("OG", O2H1)]),
    ("THR", &[("CB", C4), ("OG1", O2H1), ("CG2", C4)]),
    (
        "TRP",
        &[
            ("CB", C4),
            ("CG", C3H0),
            ("CD1", C3H1),
            ("CD2", C3H0),
            ("NE1", N),
            ("CE2", C3H0),
            ("CE3", C3H1),
            ("CZ2", C3H1),
            ("CZ3", C3H1),
            ("CH2", C3H1),
        ],
    ),
    (
        "TYR",
        &[
            ("CB", C4),
            ("CG", C3H0),
            ("CD1", C3H1),
            ("CD2", C3H1),
            ("CE1", C3H1),
            ("CE2", C3H1),
            ("CZ", C3H0),
            ("OH", O2H1),
        ],
    ),
    ("VAL", &[("CB", C4), ("CG1", C4), ("CG2", C4)]),
    ("SEC", &[("CB", C4), ("SE", Se)]),
    ("MSE", &[("CB", C4), ("CG", C4), ("SE", Se), ("CE", C4)]),
];

/// The residue of the table above that has the same heavy atoms.
pub(crate) fn parent(residue_name: &str) -> &str {
    match residue_name {
        "ASH" | "ASX" | "ASPP" => "ASP",
        "GLH" | "GLX" | "GLUP" => "GLU",
        "CYX" | "CYM" | "CYZ" | "CYN" => "CYS",
        "HID" | "HIE" | "HIP" | "HIM" | "HSD" | "HSE" | "HSP" | "HIS-" => "HIS",
        "LYN" | "LYP" | "LSN" => "LYS",
        "ARN" => "ARG",
        // AMBER's TYM; that name is another molecule's, which only atoms tell from it (`other_names`).
        "TYR-" => "TYR",
        other => other,
    }
}

/// The residues of the table above, with their side chains.
pub(crate) fn side_chains() -> impl Iterator<Item = (&'static str, SideChain)> {
    SIDE_CHAINS.into_iter()
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

/// Heavy side-chain atoms of a standard amino acid, by name.
pub(crate) fn side_chain(residue_name: &str) -> Option<SideChain> {
    let parent = parent(residue_name);
    SIDE_CHAINS
        .iter()
        .find(|(name, _)| *name == parent)
        .map(|(_, atoms)| *atoms)
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

/// Whether this is the name of one of the standard nucleotides; other molecules have such names too.
pub(crate) fn is_nucleotide(residue_name: &str) -> bool {
    base(residue_name).is_some()
}

/// Whether this is water, heavy water included, under any of the names in use.
pub(crate) fn is_water(residue_name: &str) -> bool {
    matches!(
        residue_name,
        "HOH"
            | "WAT"
            | "H2O"
            | "DOD"
            | "D2O"
            | "HHO"
            | "OHH"
            | "TIP"
            | "TIP2"
            | "TIP3"
            | "TIP4"
            | "TIP5"
            | "TP3"
            | "T3P"
            | "T4P"
            | "SOL"
            | "SOLV"
            | "SPC"
            | "SPCE"
            | "OH2"
    )
}

/// Atom type of a heavy atom of an amino acid's backbone, whatever the residue.
pub(crate) fn backbone_type(atom_name: &str) -> Option<AtomType> {
    let name = standard_atom_name("", atom_name);
    BACKBONE
        .iter()
        .find(|(backbone, _)| *backbone == name)
        .map(|(_, kind)| *kind)
}

/// Atom type of a heavy atom of a standard amino acid.
pub(crate) fn amino_acid_type(residue_name: &str, atom_name: &str) -> Option<AtomType> {
    let side_chain = side_chain(residue_name)?;
    let name = standard_atom_name(residue_name, atom_name);
    side_chain
        .iter()
        .find(|(atom, _)| *atom == name)
        .map(|(_, kind)| *kind)
        .or_else(|| backbone_type(atom_name))
}

/// Atom type of a heavy atom of a standard nucleotide, in the classes that carry over to RNA and DNA: Voss & Gerstein,
/// J. Mol. Biol. 346 (2005) 477-492 (NucProt).
pub(crate) fn nucleotide_type(residue_name: &str, atom_name: &str) -> Option<AtomType> {
    let base = base(residue_name)?;
    let name = plain_atom_name(atom_name);
    if name.starts_with('P') {
        return Some(P);
    }
    if matches!(name.as_ref(), "OP1" | "OP2") {
        return Some(O1H0);
    }
    if name.ends_with('\'') || name == "OP3" {
        return Some(if name.starts_with('C') { C4 } else { O2H1 });
    }
    match (base, name.as_ref()) {
        (_, "C7" | "C5M") => Some(C4),
        ("A" | "I", "C2") | ("A" | "G" | "I", "C8") => Some(C3H1),
        ("C" | "U", "C5") | ("C" | "U" | "T", "C6") => Some(C3H1),
        (_, name) if name.starts_with('C') => Some(C3H0),
        (_, name) if name.starts_with('N') => Some(N),
        (_, name) if name.starts_with('O') => Some(O1H0),
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
        assert_eq!(amino_acid_type("HSD", "CE1"), Some(C3H1));
        assert_eq!(amino_acid_type("CYX", "SG"), Some(S));
        assert_eq!(amino_acid_type("ILE", "CD"), Some(C4));
        assert_eq!(amino_acid_type("LYS", "OT2"), Some(O1H0));
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
        assert_eq!(nucleotide_type("DT", "C5M"), Some(C4));
        assert_eq!(nucleotide_type("DT", "C5"), Some(C3H0));
        assert_eq!(nucleotide_type("U", "C5"), Some(C3H1));
        assert_eq!(nucleotide_type("A", "C5*"), Some(C4));
        assert_eq!(nucleotide_type("A", "O2'"), Some(O2H1));
    }
}
