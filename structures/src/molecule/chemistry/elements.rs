//! The element of an atom: from its column where that can be true, otherwise from its residue and name.

use crate::molecule::chemistry::residues::{
    amino_acid_type, is_amino_acid, is_nucleotide, is_water,
};

/// Where an atom's name stands in its PDB columns 13 to 16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NameColumn {
    /// Column 13 is blank: a one-letter element, where the file keeps to the wwPDB's alignment.
    Blank,
    /// Column 13 holds a character.
    Filled,
    /// The format has no columns.
    Unknown,
}

/// An element and how it was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Resolved {
    /// Symbol as in the periodic table; `D` for deuterium.
    pub(crate) symbol: &'static str,
    pub(crate) origin: Origin,
}

/// Source of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The element column.
    Column,
    /// Residue and atom name, the column being blank.
    Derived,
    /// Residue and atom name, the column being impossible.
    Corrected,
}

/// Two-letter elements that occur in ligands whose file does not align atom names: those that no carbon, nitrogen or
/// oxygen name begins with.
const UNMISTAKABLE: [&str; 12] = [
    "BR", "CL", "FE", "ZN", "MG", "MN", "SE", "LI", "RU", "RB", "AL", "SI",
];

/// The element of an atom, or nothing when neither column nor names tell.
///
/// `aligned` says whether the file keeps to the wwPDB's alignment of atom names, by which a blank column 13 means a
/// one-letter element (` CA ` carbon, `CA  ` calcium).
pub(crate) fn resolve(
    residue_name: &str,
    atom_name: &str,
    column: &str,
    name_column: NameColumn,
    aligned: bool,
) -> Option<Resolved> {
    let given = column_symbol(column);
    let by_names = if is_standard(residue_name) {
        of_standard_residue(residue_name, atom_name)
    } else {
        of_ion(residue_name, atom_name)
    };
    match (given, by_names) {
        // Old files and other programs' columns hold chain letters and numbers there, and calcium for CA.
        (Some(given), Some(named)) if named == given || (named == "H" && given == "D") => {
            Some(Resolved {
                symbol: given,
                origin: Origin::Column,
            })
        }
        (Some(given), None) => Some(Resolved {
            symbol: given,
            origin: Origin::Column,
        }),
        (_, named) => Some(Resolved {
            symbol: named.or_else(|| of_other_residue(atom_name, name_column, aligned))?,
            origin: if column.is_empty() {
                Origin::Derived
            } else {
                Origin::Corrected
            },
        }),
    }
}

/// The element that a column gives, a charge beside it aside.
pub(crate) fn column_symbol(column: &str) -> Option<&'static str> {
    symbol(column.trim_end_matches(|c: char| c.is_ascii_digit() || "+-".contains(c)))
}

/// Whether an atom is hydrogen of any mass.
pub(crate) fn is_hydrogen(symbol: &str) -> bool {
    matches!(symbol, "H" | "D" | "T")
}

fn is_standard(residue_name: &str) -> bool {
    is_amino_acid(residue_name) || is_nucleotide(residue_name) || is_water(residue_name)
}

/// Symbols of the elements in the order of their numbers, and deuterium (IUPAC).
const SYMBOLS: &str = "H He Li Be B C N O F Ne Na Mg Al Si P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu Zn Ga Ge As Se Br Kr \
    Rb Sr Y Zr Nb Mo Tc Ru Rh Pd Ag Cd In Sn Sb Te I Xe Cs Ba La Ce Pr Nd Pm Sm Eu Gd Tb Dy Ho Er Tm Yb Lu Hf Ta W Re Os \
    Ir Pt Au Hg Tl Pb Bi Po At Rn Fr Ra Ac Th Pa U Np Pu Am Cm Bk Cf Es Fm Md No Lr Rf Db Sg Bh Hs Mt Ds Rg Cn Nh Fl Mc \
    Lv Ts Og D";

/// The symbol as in the periodic table, from any letter case.
fn symbol(text: &str) -> Option<&'static str> {
    // The common elements need no search.
    match text {
        "C" => return Some("C"),
        "N" => return Some("N"),
        "O" => return Some("O"),
        "S" => return Some("S"),
        "H" => return Some("H"),
        _ => {}
    }
    SYMBOLS
        .split(' ')
        .find(|symbol| symbol.eq_ignore_ascii_case(text))
}

/// Elements of standard residues are one-letter ones, selenium aside, and begin the atom's name after its digits and
/// primes.
fn of_standard_residue(residue_name: &str, atom_name: &str) -> Option<&'static str> {
    if matches!(residue_name, "MSE" | "SEC") && atom_name.starts_with("SE") {
        return Some("Se");
    }
    let letters = atom_name.trim_start_matches(|c: char| !c.is_ascii_alphabetic());
    match letters.chars().next()? {
        'C' => Some("C"),
        'N' => Some("N"),
        'O' => Some("O"),
        'S' => Some("S"),
        'P' => Some("P"),
        'H' | 'D' => Some("H"),
        // AD1, AE2, XD1: amide oxygen or nitrogen, not distinguished (old ASN, GLN; ASX, GLX).
        'A' | 'X' if amino_acid_type(residue_name, "CB").is_some() && letters.len() == 3 => {
            Some("O")
        }
        _ => None,
    }
}

/// Ions under the names of the CHARMM force field.
const FORCE_FIELD_IONS: [(&str, &str); 5] = [
    ("CLA", "Cl"),
    ("POT", "K"),
    ("SOD", "Na"),
    ("CAL", "Ca"),
    ("CES", "Cs"),
];

/// Ions are named after themselves: ZN in ZN, FE in FE2, CU in CU1. Some programs write N beside NA, and C beside CLA.
fn of_ion(residue_name: &str, atom_name: &str) -> Option<&'static str> {
    let (name, residue) = (letters(atom_name), letters(residue_name));
    if name.is_empty() || name != residue {
        return None;
    }
    let of_force_field = FORCE_FIELD_IONS.iter().find(|(ion, _)| *ion == name);
    match of_force_field {
        Some(&(_, element)) => Some(element),
        None if name.len() <= 2 => symbol(name),
        None => None,
    }
}

/// The first run of letters in a name.
fn letters(text: &str) -> &str {
    let start = text.trim_start_matches(|c: char| !c.is_ascii_alphabetic());
    let end = start.find(|c: char| !c.is_ascii_alphabetic());
    &start[..end.unwrap_or(start.len())]
}

fn of_other_residue(
    atom_name: &str,
    name_column: NameColumn,
    aligned: bool,
) -> Option<&'static str> {
    let name = letters(atom_name);
    let one = name.get(..1).and_then(symbol);
    // Of the two-letter elements that begin like hydrogen only mercury is met.
    if name.starts_with('H') && !(name_column == NameColumn::Filled && atom_name == "HG") {
        return one;
    }
    let two = name.get(..2).and_then(symbol);
    if aligned && atom_name.len() < 4 && atom_name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        match name_column {
            NameColumn::Blank => return one,
            NameColumn::Filled => return two.or(one),
            NameColumn::Unknown => {}
        }
    }
    match two {
        Some(symbol) if UNMISTAKABLE.iter().any(|known| name.starts_with(known)) => Some(symbol),
        _ => one,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use NameColumn::{Blank, Filled, Unknown};

    fn of(
        residue: &str,
        atom: &str,
        column: &str,
        name_column: NameColumn,
    ) -> (&'static str, Origin) {
        let found = resolve(residue, atom, column, name_column, true).unwrap();
        (found.symbol, found.origin)
    }

    #[test]
    fn alpha_carbon_is_not_calcium() {
        // Blank column: pdbtbx and others read CA as calcium. Column CA: some programs write it so.
        assert_eq!(of("ALA", "CA", "", Blank), ("C", Origin::Derived));
        assert_eq!(of("ALA", "CA", "CA", Filled), ("C", Origin::Corrected));
        assert_eq!(of("CA", "CA", "", Filled), ("Ca", Origin::Derived));
        assert_eq!(of("CA", "CA", "CA", Filled), ("Ca", Origin::Column));
    }

    #[test]
    fn ions_are_named_after_themselves() {
        // Some preparation programs write N beside sodium.
        assert_eq!(of("NA", "NA", "N", Blank), ("Na", Origin::Corrected));
        assert_eq!(of("FE2", "FE", "", Filled), ("Fe", Origin::Derived));
        // CHARMM's names of chloride, potassium and sodium, beside other atoms of ligands.
        assert_eq!(of("CLA", "CLA", "", Blank), ("Cl", Origin::Derived));
        assert_eq!(of("POT", "POT", "", Blank), ("K", Origin::Derived));
        assert_eq!(of("SOD", "SOD", "NA", Blank), ("Na", Origin::Column));
        assert_eq!(of("CLA", "CGA", "", Blank), ("C", Origin::Derived));
    }

    #[test]
    fn columns_that_hold_something_else_are_corrected() {
        // Benchmark files carry a chain letter or a running number in columns 77-80.
        assert_eq!(of("ARG", "CD", "N", Blank), ("C", Origin::Corrected));
        assert_eq!(of("ILE", "N", "1", Blank), ("N", Origin::Corrected));
        assert_eq!(of("ILE", "1HD1", "", Filled), ("H", Origin::Derived));
        assert_eq!(of("TYR", "DH", "D", Blank), ("D", Origin::Column));
        assert_eq!(of("MSE", "SE", "", Filled), ("Se", Origin::Derived));
    }

    #[test]
    fn ligand_atoms_go_by_the_alignment_of_their_names() {
        assert_eq!(of("HEM", "FE", "", Filled).0, "Fe");
        assert_eq!(of("HEM", "NA", "", Blank).0, "N");
        assert_eq!(of("LIG", "CL1", "", Filled).0, "Cl");
        assert_eq!(of("LIG", "CD", "", Blank).0, "C");
        assert_eq!(of("LIG", "HO3A", "", Filled).0, "H");
        // Not aligned: only names that cannot be anything else count as two letters.
        assert_eq!(resolve("LIG", "CD", "", Filled, false).unwrap().symbol, "C");
        assert_eq!(
            resolve("LIG", "BR1", "", Filled, false).unwrap().symbol,
            "Br"
        );
        assert_eq!(resolve("LIG", "NA", "", Unknown, true).unwrap().symbol, "N");
    }

    #[test]
    fn charges_beside_the_symbol_are_ignored_and_nonsense_is_unknown() {
        assert_eq!(of("FE2", "FE", "FE2+", Filled), ("Fe", Origin::Column));
        assert_eq!(of("LIG", "N1", "N1+", Unknown), ("N", Origin::Column));
        assert_eq!(resolve("LIG", "XX1", "", Unknown, true), None);
        assert_eq!(resolve("LIG", "", "", Unknown, true), None);
    }
}
