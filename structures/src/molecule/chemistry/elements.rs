//! The element of an atom: from its column where that can be true, otherwise from its residue and name.

use std::sync::LazyLock;

use crate::molecule::chemistry::{amino_acid_type, is_amino_acid, is_nucleotide, is_water};

/// Lines of `#`, a header, then symbol, kind, radius, distance and charge.
const TABLE: &str = include_str!("elements.csv");

/// An element of the table beside this file, which has the sources.
#[derive(Debug)]
pub(crate) struct Element {
    /// Symbol as in the periodic table; `D` for deuterium.
    symbol: &'static str,
    kind: ElementKind,
    /// Radius in Å of an atom whose hydrogens are separate atoms.
    pub(crate) radius: Option<f64>,
    /// Equilibrium distance of UFF, in Å.
    pub(crate) distance: Option<f64>,
    /// Charge of the common ion, in e.
    pub(crate) charge: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ElementKind {
    NonMetal,
    /// A metal that sulphur and nitrogen seldom bind: its ligands are oxygens.
    Hard,
    Metal,
}

static ELEMENTS: LazyLock<Vec<Element>> = LazyLock::new(|| {
    let lines = TABLE.lines().filter(|line| !line.starts_with('#')).skip(1);
    let element = |line: &'static str| {
        let fields: Vec<&str> = line.split(',').collect();
        let &[symbol, kind, radius, distance, charge] = fields.as_slice() else {
            // The table is part of the program, and tests read it.
            unreachable!("elements.csv: not an element: `{line}`")
        };
        Element {
            symbol,
            kind: match kind {
                "non-metal" => ElementKind::NonMetal,
                "hard" => ElementKind::Hard,
                _ => ElementKind::Metal,
            },
            radius: radius.parse().ok(),
            distance: distance.parse().ok(),
            charge: charge.parse().ok(),
        }
    };
    lines.map(element).collect()
});

pub(crate) fn element(symbol: &str) -> Option<&'static Element> {
    ELEMENTS.iter().find(|element| element.symbol == symbol)
}

/// Whether ions of an element count as metals: all that are not known as non-metals do.
pub(crate) fn is_metal(symbol: &str) -> bool {
    element(symbol).is_none_or(|element| element.kind != ElementKind::NonMetal)
}

/// Whether sulphur and nitrogen seldom bind a metal.
pub(crate) fn is_hard(symbol: &str) -> bool {
    element(symbol).is_some_and(|element| element.kind == ElementKind::Hard)
}

/// Alignment of an atom's name in PDB columns 13 to 16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NameColumn {
    /// Column 13 is blank: a one-letter element, where the file keeps to the wwPDB's alignment.
    Blank,
    /// Column 13 holds a character.
    Filled,
    /// The format has no columns.
    Unknown,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Resolved {
    /// Symbol as in the periodic table; `D` for deuterium.
    pub(crate) symbol: &'static str,
    pub(crate) origin: Origin,
}

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

/// The element of an atom; `None` if neither column nor names show it.
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
    // Old files and other programs' columns hold chain letters and numbers there, and calcium for CA.
    let fits = |given: &&str| {
        by_names.is_none_or(|named| named == *given || (named == "H" && *given == "D"))
    };
    if let Some(symbol) = given.filter(fits) {
        let origin = Origin::Column;
        return Some(Resolved { symbol, origin });
    }
    Some(Resolved {
        symbol: by_names.or_else(|| of_other_residue(atom_name, name_column, aligned))?,
        origin: match column {
            "" => Origin::Derived,
            _ => Origin::Corrected,
        },
    })
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

/// The symbol as in the periodic table, from any letter case.
fn symbol(text: &str) -> Option<&'static str> {
    let mut symbols = ELEMENTS.iter().map(|element| element.symbol);
    symbols.find(|symbol| symbol.eq_ignore_ascii_case(text))
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
