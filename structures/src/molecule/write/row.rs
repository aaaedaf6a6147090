//! Atoms as rows of a file, and their values as text.

use crate::molecule::model::atom::Atom;

/// An atom under the name that its chain has in the file.
pub(crate) struct Row<'a> {
    pub(crate) atom: &'a Atom,
    pub(crate) chain: &'a str,
    /// The chain's polymer ends with this atom.
    pub(crate) ends_chain: bool,
}

/// An atom as named in messages.
pub(crate) fn name(row: &Row<'_>) -> String {
    let atom = row.atom;
    format!(
        "{} of {} {}{}",
        atom.name, atom.residue_name, row.chain, atom.residue_number
    )
}

/// A number rounded to so many thousandths or hundredths, without the sign that a rounded-off zero would keep.
pub(crate) fn rounded(value: f64, per_unit: f64) -> f64 {
    let value = (value * per_unit).round() / per_unit;
    if value == 0.0 { 0.0 } else { value }
}

/// Free text in printable ASCII, on one line: both formats allow no more.
pub(crate) fn plain(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            c if c.is_ascii_graphic() => c,
            c if c.is_whitespace() => ' ',
            _ => '?',
        })
        .collect()
}
