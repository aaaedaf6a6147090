//! Tables as text: cells, columns by name, lines, and what spreadsheets make of them.

pub mod cells;
pub mod csv_lines;
pub mod named_columns;
pub mod spreadsheet;
