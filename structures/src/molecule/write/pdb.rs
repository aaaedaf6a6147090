//! The PDB writer: wwPDB format 3.3, "Coordinate Section", columns 1 to 80.

use std::io::{self, Write};

use crate::Error;
use crate::molecule::write::{Row, does_not_fit, plain, rounded};

/// Number of the free remarks: not one that the wwPDB reserves.
const REMARK: &str = "REMARK  99 ";

/// Whether the fixed columns can hold all of it.
pub(super) fn check(rows: &[Row<'_>]) -> Result<(), Error> {
    if rows.len() > 99_999 {
        return Err(does_not_fit(&format!(
            "{} atoms, more than 99,999",
            rows.len()
        )));
    }
    let is_ascii = |text: &str| text.bytes().all(|byte| (32..127).contains(&byte));
    let is_text = |text: &str, columns: usize| text.len() <= columns && is_ascii(text);
    for row in rows {
        let atom = row.atom;
        let fault = if !is_text(&atom.name, 4) {
            "its name"
        } else if !is_text(&atom.residue_name, 3) {
            "its residue's name"
        } else if !is_text(row.chain, 1) {
            "its chain's name"
        } else if !(-999..=9999).contains(&atom.residue_number) {
            "its residue's number"
        } else if atom
            .insertion_code
            .is_some_and(|code| !code.is_ascii_graphic())
        {
            "its insertion code"
        } else if atom.element.len() > 2 {
            "its element"
        } else if !atom.position.iter().all(|&x| fits(x, 8, 1000.0)) {
            "its coordinates"
        } else if !fits(atom.occupancy, 6, 100.0) {
            "its occupancy"
        } else if !fits(atom.b_factor, 6, 100.0) {
            "its temperature factor"
        } else {
            continue;
        };
        return Err(does_not_fit(&format!("{fault} (atom {})", row.name())));
    }
    Ok(())
}

/// Whether a number, rounded, fits `width` columns.
fn fits(value: f64, width: i32, per_unit: f64) -> bool {
    let decimals = per_unit.log10().round() as i32;
    // The point takes a column, and so does a minus sign.
    let highest = 10_f64.powi(width - decimals - 1);
    let lowest = -10_f64.powi(width - decimals - 2);
    let value = rounded(value, per_unit);
    lowest < value && value < highest
}

/// Writes remarks, which come before everything else.
pub(super) fn write_head<W: Write>(writer: &mut W, remarks: &[String]) -> io::Result<()> {
    for line in remarks.iter().flat_map(|remark| wrapped(remark)) {
        writeln!(writer, "{:<80}", format!("{REMARK}{line}"))?;
    }
    Ok(())
}

/// Writes rows that [`check`] has passed as a model.
pub(super) fn write_model<W: Write>(
    writer: &mut W,
    rows: &[Row<'_>],
    number: usize,
) -> io::Result<()> {
    writeln!(writer, "{:<80}", format!("MODEL     {number:>4}"))?;
    write_atoms(writer, rows)?;
    writeln!(writer, "{:<80}", "ENDMDL")
}

pub(super) fn write_end<W: Write>(writer: &mut W) -> io::Result<()> {
    writeln!(writer, "{:<80}", "END")
}

/// Writes rows that [`check`] has passed.
pub(super) fn write_atoms<W: Write>(writer: &mut W, rows: &[Row<'_>]) -> io::Result<()> {
    // TER takes a serial number, unless that would be the 100,000th.
    let ends = rows.iter().filter(|row| row.ends_chain).count();
    let numbers_ends = rows.len() + ends <= 99_999;
    let mut serial = 0;
    for row in rows {
        serial += 1;
        let atom = row.atom;
        let [x, y, z] = atom.position.map(|x| rounded(x, 1000.0));
        let record = if atom.hetero { "HETATM" } else { "ATOM" };
        let chain = if row.chain.is_empty() { " " } else { row.chain };
        let insertion = atom.insertion_code.unwrap_or(' ');
        let residue = format!(
            "{:>3} {chain}{:>4}{insertion}",
            atom.residue_name, atom.residue_number
        );
        writeln!(
            writer,
            "{record:<6}{serial:>5} {} {residue}   {x:>8.3}{y:>8.3}{z:>8.3}{:>6.2}{:>6.2}          {:>2}  ",
            name_columns(&atom.name, &atom.element),
            rounded(atom.occupancy, 100.0),
            rounded(atom.b_factor, 100.0),
            atom.element.to_ascii_uppercase(),
        )?;
        if row.ends_chain {
            let end = if numbers_ends {
                serial += 1;
                format!("TER   {serial:>5}      {residue}")
            } else {
                "TER".to_owned()
            };
            writeln!(writer, "{end:<80}")?;
        }
    }
    Ok(())
}

/// Columns 13 to 16: the element is right-justified in the first two, so that names of one-letter elements begin in the
/// second, unless they take all four.
fn name_columns(name: &str, element: &str) -> String {
    let begins_with_element = name
        .get(..element.len())
        .is_some_and(|head| head.eq_ignore_ascii_case(element));
    if name.len() >= 4 || (element.len() == 2 && begins_with_element) {
        format!("{name:<4}")
    } else {
        format!(" {name:<3}")
    }
}

/// A remark as lines that fit beside its number, broken between words where there are any, in printable ASCII.
fn wrapped(text: &str) -> Vec<String> {
    let width = 80 - REMARK.len();
    let plain = plain(text);
    let mut lines = vec![String::new()];
    for word in plain.split_ascii_whitespace() {
        let mut rest = word;
        while !rest.is_empty() {
            let Some(line) = lines.last_mut() else { break };
            let gap = usize::from(!line.is_empty());
            let room = width.saturating_sub(line.len() + gap);
            if rest.len() <= room {
                line.push_str(if gap == 1 { " " } else { "" });
                line.push_str(rest);
                rest = "";
            } else if line.is_empty() {
                let (head, tail) = rest.split_at(room);
                line.push_str(head);
                rest = tail;
            } else {
                lines.push(String::new());
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_their_columns_after_rounding() {
        assert!(fits(9999.999, 8, 1000.0) && fits(-999.999, 8, 1000.0));
        // Rounds to 10000.000, one column too many.
        assert!(!fits(9999.9996, 8, 1000.0) && !fits(-999.9996, 8, 1000.0));
        assert!(fits(999.99, 6, 100.0) && !fits(999.996, 6, 100.0));
        assert!(fits(-99.99, 6, 100.0) && !fits(-100.0, 6, 100.0));
        assert!(!fits(1e6, 8, 1000.0));
    }

    #[test]
    fn remarks_are_wrapped_at_words_and_at_the_edge() {
        let long = "x".repeat(100);
        let lines = wrapped(&format!("two words {long}"));
        assert_eq!(lines, ["two words", &"x".repeat(69), &"x".repeat(31)]);
        assert_eq!(wrapped("é\n1"), ["? 1"]);
        assert_eq!(wrapped(""), [""]);
    }

    #[test]
    fn names_are_aligned_by_element() {
        assert_eq!(name_columns("CA", "C"), " CA ");
        assert_eq!(name_columns("CA", "Ca"), "CA  ");
        assert_eq!(name_columns("FE", "Fe"), "FE  ");
        assert_eq!(name_columns("O5'", "O"), " O5'");
        assert_eq!(name_columns("HH11", "H"), "HH11");
    }
}
