//! Tables as text: cells, columns by name, lines, and what spreadsheets make of them.

pub mod cells;
pub(crate) mod csv_lines;
pub mod named_columns;
pub(crate) mod spreadsheet;
