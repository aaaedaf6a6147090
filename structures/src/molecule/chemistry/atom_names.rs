//! Names of atoms as the wwPDB has them today.

use std::borrow::Cow;

/// The plain name of an atom: `'` where files from before the remediation of 2007 have `*` in a sugar, and `OP1` for
/// their `O1P`.
pub fn plain_atom_name(atom_name: &str) -> Cow<'_, str> {
    match atom_name {
        "O1P" => Cow::Borrowed("OP1"),
        "O2P" => Cow::Borrowed("OP2"),
        "O3P" => Cow::Borrowed("OP3"),
        starred if starred.contains('*') => Cow::Owned(starred.replace('*', "'")),
        plain => Cow::Borrowed(plain),
    }
}

/// Whether an atom of this name shows that a residue of a nucleotide's name is one: it links a sugar to its neighbour.
/// Ruthenium (`RU`), indium iodide (`IN`) and a thyroid hormone (`T3`) are named like nucleotides.
pub(crate) fn links_nucleotides(atom_name: &str) -> bool {
    matches!(plain_atom_name(atom_name).as_ref(), "P" | "O3'" | "O5'")
}
