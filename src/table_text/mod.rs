//! Tables as text: cells, and columns by name.

pub mod cells;
pub mod named_columns;
