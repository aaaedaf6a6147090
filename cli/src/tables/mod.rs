//! Tables of the program's commands, and those of the terminal.

pub(crate) mod batch_results;
pub mod pair_table;
pub(crate) mod report;

use std::borrow::Borrow;
use std::io;

use serde_json::{Map, Value};

use knotdock::output::tables::fields::number;
use knotdock::table_text::cells::TableWriter;

/// A column of a table: its name, and its value in a row, as JSON has it.
pub(crate) type Column<Row> = (&'static str, fn(&Row) -> Value);

/// Writes a table as CSV (RFC 4180, but with LF as the line end). Missing values are empty.
pub(crate) fn write_table<'c, Row: 'c>(
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
pub(crate) fn object<Row>(columns: &[Column<Row>], row: &Row) -> Map<String, Value> {
    let entries = columns.iter();
    entries
        .map(|(name, value)| ((*name).to_owned(), value(row)))
        .collect()
}

/// A value as a field of CSV: numbers in the shortest digits that read back, nothing for `null`.
pub(crate) fn field(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(value) if value.is_f64() => value.as_f64().map(number).unwrap_or_default(),
        value => value.to_string(),
    }
}
