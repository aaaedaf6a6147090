//! Tables of the program's commands, and those of the terminal.

pub mod atom_table;
pub mod batch_results;
pub mod collisions;
pub mod complexes;
pub mod interface;
pub mod pair_table;
pub mod pose_list;
pub mod refined;
pub mod report;

use std::borrow::Borrow;
use std::io;

use knotdock::output::tables::fields::number;
use knotdock::table_text::cells::TableWriter;
use serde_json::{Map, Value};

/// A column of a table: its name, and its value in a row, as JSON has it.
pub type Column<Row> = (&'static str, fn(&Row) -> Value);

/// Writes a table as CSV (RFC 4180, but with LF as the line end). Missing values are empty.
///
/// # Errors
/// Those of the stream.
pub fn write_table<'c, Row: 'c>(
    stream: &mut dyn io::Write,
    columns: impl IntoIterator<Item = &'c Column<Row>>,
    rows: impl IntoIterator<Item = impl Borrow<Row>>,
) -> io::Result<()> {
    let columns: Vec<_> = columns.into_iter().collect();
    let mut table = TableWriter::new(stream);
    table.row(columns.iter().map(|(name, _)| *name))?;
    for row in rows {
        table.row(columns.iter().map(|(_, value)| field(&value(row.borrow()))))?;
    }
    table.flush()
}

/// A row as a JSON object with the names of the columns; missing values are `null`.
pub fn object<Row>(columns: &[Column<Row>], row: &Row) -> Map<String, Value> {
    let entries = columns.iter();
    entries
        .map(|(name, value)| ((*name).to_owned(), value(row)))
        .collect()
}

/// A value as a field of CSV: numbers in the shortest digits that read back, nothing for `null`.
pub fn field(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(value) if value.is_f64() => value.as_f64().map(number).unwrap_or_default(),
        value => value.to_string(),
    }
}
