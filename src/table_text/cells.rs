//! Cells of tables that no spreadsheet takes for formulas.
//!
//! Spreadsheets run a cell that begins with `=`, `+`, `-`, `@`, a tab or a carriage return, and the names in structure
//! files may be anyone's. All tables with names of files are written here: such a cell gets a single quote in front unless
//! it is a number (OWASP, "CSV Injection"). Readers of tables remove it.

use std::borrow::Cow;
use std::io;

use csv::StringRecord;

/// Beginnings of formulas.
const STARTS: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// Whether a cell is a formula's text, perhaps behind quotes: these stay what they are by one more.
fn is_formula(cell: &str) -> bool {
    cell.trim_start_matches('\'').starts_with(STARTS)
}

/// A cell as it is written.
pub fn quoted(cell: &str) -> Cow<'_, str> {
    let is_number = || cell.parse::<f64>().is_ok_and(f64::is_finite);
    match is_formula(cell) && !is_number() {
        true => format!("'{cell}").into(),
        false => cell.into(),
    }
}

/// A written cell as it was.
pub fn unquoted(cell: &str) -> &str {
    match cell.strip_prefix('\'') {
        Some(rest) if is_formula(rest) => rest,
        _ => cell,
    }
}

/// A row as it was, read from a table.
pub fn unquoted_row(row: &StringRecord) -> StringRecord {
    let mut plain: StringRecord = row.iter().map(unquoted).collect();
    plain.set_position(row.position().cloned());
    plain
}

/// A writer of a table: RFC 4180, but with LF as the line end.
pub struct TableWriter<W: io::Write>(csv::Writer<W>);

impl<W: io::Write> TableWriter<W> {
    /// A table that goes to a stream.
    pub fn new(stream: W) -> Self {
        Self(csv::Writer::from_writer(stream))
    }

    /// Writes a row.
    pub fn row<T: AsRef<str>>(&mut self, cells: impl IntoIterator<Item = T>) -> io::Result<()> {
        for cell in cells {
            self.0.write_field(quoted(cell.as_ref()).as_bytes())?;
        }
        self.0.write_record(None::<&[u8]>)?;
        Ok(())
    }

    /// Hands on all that was written.
    pub fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain `=cmd|'/c calc'!A1` ran a program when the atom table was opened in a spreadsheet.
    #[test]
    fn formulas_are_quoted_and_come_back() {
        let names = [
            "=1+1", "@SUM(A1)", "+A", "-A", "\tx", "\rx", "'=1", "''-A", "-inf", "=", "-", "--5",
        ];
        for name in names {
            let cell = quoted(name);
            assert_eq!(cell, format!("'{name}"));
            assert_eq!(unquoted(&cell), name);
        }
        for name in ["", "A", "O5'", "'A", "'", "a=b", "-1.5", "+2", "-1e-7", "5"] {
            assert_eq!(quoted(name), name);
            assert_eq!(unquoted(name), name);
        }
    }

    #[test]
    fn a_row_is_written_cell_by_cell() {
        let written = |row: &[&str]| {
            let mut bytes = Vec::new();
            let mut table = TableWriter::new(&mut bytes);
            table.row(row).unwrap();
            table.flush().unwrap();
            drop(table);
            String::from_utf8(bytes).unwrap()
        };
        assert_eq!(written(&["a", "=b,c", "-5", ""]), "a,\"'=b,c\",-5,\n");
        assert_eq!(written(&[""]), "\"\"\n");
    }
}
