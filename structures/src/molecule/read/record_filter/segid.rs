//! The segment identifier (segid) of a PDB record, columns 73-76: how CNS, X-PLOR, HADDOCK and CHARMM name molecules.
//!
//! The format dropped it in 1996. Other things may be in these columns:
//!
//! - the code of the entry, with the number of the line in columns 77-80, in entries older than that;
//! - the end of the partial charge in PDBQT.

use crate::molecule::read::record_filter::element_column::has_partial_charge;

/// The segid of a record; empty if it has none.
pub(crate) fn segid(record: &str) -> String {
    let columns = |from: usize, to: usize| record.get(from..to.min(record.len())).unwrap_or("");
    let line_number = columns(76, 80).trim();
    let is_numbered =
        !line_number.is_empty() && line_number.bytes().all(|byte| byte.is_ascii_digit());
    if is_numbered || has_partial_charge(record) {
        return String::new();
    }
    let letters = columns(72, 76).chars();
    // A chain with both kinds of quotes cannot be written as mmCIF.
    let is_kept = |letter: &char| letter.is_ascii_graphic() && *letter != '"';
    letters.filter(is_kept).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
