//! Atom records out of their columns: shifted by blanks, with tabs, or in small letters.
//!
//! The decimal points of the coordinates say where a record's columns are: the format has them in columns 35, 43 and
//! 51. A record is moved so that they stand there; one in which they do not keep their distance of eight has lost its
//! columns.

use crate::molecule::chemistry::residues::{is_amino_acid, is_nucleotide, is_water};
use crate::molecule::read::record_filter::record::number;
use crate::molecule::read::record_filter::residue_columns::residue_number;

/// Where the decimal points of the coordinates stand, from 0.
const POINTS: [usize; 3] = [34, 42, 50];

/// Where the coordinates end, from 0.
const END: usize = 54;

/// Columns between the stops of a tab.
const TAB: usize = 8;

/// Most columns by which a record is taken for shifted behind its name.
const MAX_SHIFT: usize = 8;

/// An atom record out of its columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Displaced {
    /// The record as it stands once it is moved.
    Moved(String),
    /// A record whose columns are not to be found.
    Lost,
}

/// The atom record of a line that does not begin as one, if it holds one.
pub(crate) fn displaced(line: &str) -> Option<Displaced> {
    let record = line.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
    if !record.starts_with(['A', 'a', 'H', 'h']) {
        return None;
    }
    let name_of = |name: &'static str| {
        let (head, rest) = (record.get(..name.len())?, record.get(name.len()..)?);
        let is_followed = rest.starts_with(|c: char| c.is_whitespace() || c.is_ascii_digit());
        (head.eq_ignore_ascii_case(name) && is_followed).then_some((name, rest))
    };
    let (name, rest) = name_of("HETATM").or_else(|| name_of("ATOM"))?;
    let capitals = record.starts_with(name);
    if let Some(moved) = realigned(name, rest, !capitals) {
        return Some(Displaced::Moved(moved));
    }
    if line.contains('\t') {
        let expanded = expand_tabs(line);
        let rest = expanded.trim_start().get(name.len()..).unwrap_or("");
        if let Some(moved) = realigned(name, rest, !capitals) {
            return Some(Displaced::Moved(moved));
        }
    }
    // Free text may begin with the word; an atom's has three coordinates.
    let is_decimal = |word: &&str| word.contains('.') && number(word).is_some();
    let decimals = rest.split_whitespace().filter(is_decimal).count();
    (decimals >= 3).then_some(Displaced::Lost)
}

/// The record of a line that begins as one, moved where all behind its name is shifted: its coordinates and the name of
/// its residue both stand as far beside their columns.
pub(crate) fn shifted(record: &str) -> Option<String> {
    let bytes = record.as_bytes();
    if POINTS.iter().all(|&at| bytes.get(at) == Some(&b'.')) {
        return None;
    }
    let name = if record.starts_with("HETATM") {
        "HETATM"
    } else {
        "ATOM"
    };
    let expanded;
    let record = if record.contains('\t') {
        expanded = expand_tabs(record);
        expanded.as_str()
    } else {
        record
    };
    let moved = realigned(name, record.get(name.len()..)?, false)?;
    let is_known = |text: &str| {
        // To the right of its columns, as the format has it: a cut ARG must not pass for the nucleotide RG.
        let residue = text.get(17..20).unwrap_or(" ").trim_start();
        is_amino_acid(residue) || is_nucleotide(residue) || is_water(residue)
    };
    (is_known(&moved) && !is_known(record)).then_some(moved)
}

/// The record of this name whose columns behind it are moved to their places; nothing where they are not an atom's
/// then.
fn realigned(name: &str, rest: &str, small: bool) -> Option<String> {
    let point = rest.find('.')?;
    let columns = if name.len() + point <= POINTS[0] {
        let blanks = POINTS[0] - point - name.len();
        format!("{name}{}{rest}", " ".repeat(blanks))
    } else {
        let surplus = name.len() + point - POINTS[0];
        let head = rest.get(..surplus)?;
        let is_blank = surplus <= MAX_SHIFT && head.bytes().all(|byte| byte == b' ');
        if !is_blank {
            return None;
        }
        format!("{name}{}", rest.get(surplus..)?)
    };
    if !is_atom_in_columns(&columns) {
        return None;
    }
    Some(if small {
        in_capitals(&columns)
    } else {
        columns
    })
}

/// Whether the columns hold what those of an atom do.
fn is_atom_in_columns(record: &str) -> bool {
    let bytes = record.as_bytes();
    let columns = |from: usize, to: usize| record.get(from..to).unwrap_or("");
    let numbers = [(30, 38), (38, 46), (46, END)];
    bytes.iter().take(END).all(|byte| (32..127).contains(byte))
        && POINTS.iter().all(|&at| bytes.get(at) == Some(&b'.'))
        && numbers
            .iter()
            .all(|&(from, to)| number(columns(from, to)).is_some())
        && residue_number(columns(22, 26), columns(26, 27)).is_some()
        && !columns(12, 16).trim().is_empty()
        && columns(11, 12) == " "
}

/// The names of atom, residue and element in capitals; that of the chain stays as it is.
fn in_capitals(record: &str) -> String {
    let is_name =
        |at: usize| (12..16).contains(&at) || (17..20).contains(&at) || (76..78).contains(&at);
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
        if c == '\t' {
            expanded.extend(std::iter::repeat_n(' ', width));
        } else {
            expanded.push(c);
        }
        column += width;
    }
    expanded
}

#[cfg(test)]
mod tests {
    use super::*;

    const ATOM: &str =
        "ATOM      1  N   ARG B   1     -12.445  -5.796   0.461  1.00 18.79           N  ";

    fn moved(line: &str) -> Option<String> {
        match displaced(line) {
            Some(Displaced::Moved(record)) => Some(record),
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
            assert_eq!(displaced(lost), Some(Displaced::Lost), "{lost}");
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
            assert_eq!(displaced(other), None, "{other}");
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
}
