//! The atoms of a structure file as a table: what was kept of it, and what was dropped and why.
//!
//! RFC 4180, but with LF as the line end; a row an atom of the model that was read, in the order of the file.
//! `docs/reference/json_output.md` describes the columns.

use knotdock_structures::Error;
use std::path::Path;

use knotdock_structures::molecule::{AtomFate, DropKind};

use knotdock::output::files::whole_file::write_whole;
use knotdock::output::tables::fields::number;
use knotdock::table_text::cells::TableWriter;

/// The columns, in order.
pub const COLUMNS: [&str; 16] = [
    "line",
    "record",
    "atom",
    "altloc",
    "residue",
    "chain",
    "number",
    "insertion",
    "element",
    "x",
    "y",
    "z",
    "occupancy",
    "b_factor",
    "radius",
    "dropped",
];

/// Writes the table, whole or not at all.
///
/// # Errors
/// [`Error`].
pub fn write(path: &Path, fates: &[AtomFate]) -> Result<(), Error> {
    write_whole(path, |file| {
        let mut table = TableWriter::new(file);
        table.row(COLUMNS)?;
        for entry in fates {
            table.row(fields(entry))?;
        }
        table.flush()
    })
}

fn fields(entry: &AtomFate) -> [String; COLUMNS.len()] {
    let atom = &entry.atom;
    let character = |value: Option<char>| value.map_or(String::new(), String::from);
    let [x, y, z] = atom.position;
    [
        atom.line.to_string(),
        if atom.hetero { "HETATM" } else { "ATOM" }.to_owned(),
        atom.name.clone(),
        character(atom.alternate_location),
        atom.residue_name.clone(),
        atom.chain.clone(),
        atom.residue_number.to_string(),
        character(atom.insertion_code),
        atom.element.clone(),
        number(x),
        number(y),
        number(z),
        number(atom.occupancy),
        number(atom.b_factor),
        entry
            .dropped
            .map_or_else(|| number(atom.radius), |_| String::new()),
        entry.dropped.map_or("", reason).to_owned(),
    ]
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
