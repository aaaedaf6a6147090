//! The atoms of a structure file as a table: what was kept of it, and what was dropped and why.
//!
//! RFC 4180, but with LF as the line end; a row an atom of the model that was read, in the order of the file.
//! `docs/reference/json_output.md` describes the columns.

use std::path::Path;

use knotdock_structures::Error;
use knotdock_structures::molecule::{AtomFate, DropKind};
use serde_json::json;

use crate::tables::{Column, write_table};
use knotdock::output::files::whole_file::write_whole;

/// The columns, in order.
const COLUMNS: [Column<AtomFate>; 16] = [
    ("line", |fate| json!(fate.atom.line)),
    ("record", |fate| {
        json!(if fate.atom.hetero { "HETATM" } else { "ATOM" })
    }),
    ("atom", |fate| json!(fate.atom.name)),
    ("altloc", |fate| json!(fate.atom.alternate_location)),
    ("residue", |fate| json!(fate.atom.residue_name)),
    ("chain", |fate| json!(fate.atom.chain)),
    ("number", |fate| json!(fate.atom.residue_number)),
    ("insertion", |fate| json!(fate.atom.insertion_code)),
    ("element", |fate| json!(fate.atom.element)),
    ("x", |fate| json!(fate.atom.position[0])),
    ("y", |fate| json!(fate.atom.position[1])),
    ("z", |fate| json!(fate.atom.position[2])),
    ("occupancy", |fate| json!(fate.atom.occupancy)),
    ("b_factor", |fate| json!(fate.atom.b_factor)),
    ("radius", |fate| {
        json!(fate.dropped.is_none().then_some(fate.atom.radius))
    }),
    ("dropped", |fate| json!(fate.dropped.map(reason))),
];

/// Writes the table, whole or not at all.
///
/// # Errors
/// [`Error`].
pub fn write(path: &Path, fates: &[AtomFate]) -> Result<(), Error> {
    write_whole(path, |file| write_table(file, &COLUMNS, fates))
}

/// A reason as the report names it.
fn reason(kind: DropKind) -> &'static str {
    match kind {
        DropKind::Chain => "chain",
        DropKind::OtherResidue => "other_residue",
        DropKind::Assembly => "assembly",
        DropKind::Hydrogen => "hydrogen",
        DropKind::Water => "water",
        DropKind::Residue => "residue",
        DropKind::PseudoAtom => "pseudo_atom",
        DropKind::Additive => "additive",
        DropKind::Hetatm => "hetatm",
        DropKind::AlternateLocation => "alternate_location",
        DropKind::LowConfidence => "low_confidence",
        DropKind::Model => "model",
    }
}
