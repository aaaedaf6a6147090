//! Fields of tables.

/// A column to append: its name and one field per row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name in the header.
    pub name: String,
    /// The fields, in the order of the rows.
    pub fields: Vec<String>,
}

/// A number as a field: the shortest digits that read back to the same f64, empty when it is not a finite number.
pub fn number(value: f64) -> String {
    if value.is_finite() {
        (value + 0.0).to_string() // + 0.0 prints a negative zero as 0
    } else {
        String::new()
    }
}
