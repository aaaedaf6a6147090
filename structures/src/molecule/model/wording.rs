//! Counts and chain names in words.

/// `1 atom`, `2 atoms`.
pub(crate) fn count(number: usize, what: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {what}{plural}")
}

/// A chain's name as shown: `_` for the blank one.
pub(crate) fn show_chain(name: &str) -> &str {
    if name.is_empty() { "_" } else { name }
}
