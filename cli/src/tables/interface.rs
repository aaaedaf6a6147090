//! Tables of interfaces: a row for each model of each complex file, and a row for each pair of residues in contact.

use std::io;

use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::POSE_TERMS;
use serde_json::{Map, Value, json};

use crate::tables::{Column, field, write_table};
use knotdock::interface::{Contact, Interface, PlacedScore, ResidueName};
use knotdock::table_text::cells::TableWriter;

/// A complex.
#[derive(Clone, Debug)]
pub struct InterfaceRow {
    /// Its file as it was named.
    pub file: String,
    /// Its place among the models of the file, from 1.
    pub model: usize,
    /// Chains of each side, with commas between them.
    pub chains: [String; 2],
    /// What holds it together.
    pub interface: Interface,
    /// What it scores.
    pub score: PlacedScore,
}

impl InterfaceRow {
    /// The columns of its row, by name.
    fn columns(&self) -> Map<String, Value> {
        let Self {
            interface, score, ..
        } = self;
        let mut columns = Map::new();
        let mut add = |name: &str, value: Value| columns.insert(name.to_owned(), value);
        add("file", json!(self.file));
        add("model", json!(self.model));
        add("chains_1", json!(self.chains[0]));
        add("chains_2", json!(self.chains[1]));
        add("contacts", json!(interface.pairs.len()));
        add("residues_1", json!(interface.residues[0]));
        add("residues_2", json!(interface.residues[1]));
        add("hydrogen_bonds", json!(interface.hydrogen_bonds));
        add("salt_bridges", json!(interface.salt_bridges));
        add(
            "buried_area",
            json!(interface.buried[0] + interface.buried[1]),
        );
        add("buried_area_1", json!(interface.buried[0]));
        add("buried_area_2", json!(interface.buried[1]));
        add(
            "shape_complementarity",
            json!(interface.shape_complementarity),
        );
        add("pose_score", json!(score.pose_score()));
        add("search_score", json!(score.search_score));
        for effect in Effect::ALL {
            add(effect.name(), json!(score.effects[effect as usize]));
        }
        for term in POSE_TERMS.iter().filter(|term| term.is_shown_always) {
            add(term.id, json!(score.pose_terms.get(term.id)));
        }
        columns
    }
}

/// The rows as JSON objects, each with its pairs of residues.
pub fn objects(rows: &[InterfaceRow]) -> Vec<Value> {
    let object = |row: &InterfaceRow| {
        let mut object = row.columns();
        object.insert("pairs".to_owned(), json!(row.interface.pairs));
        Value::Object(object)
    };
    rows.iter().map(object).collect()
}

/// Writes a row for each complex.
///
/// # Errors
/// Those of the stream.
pub fn write_rows(stream: &mut dyn io::Write, rows: &[InterfaceRow]) -> io::Result<()> {
    let mut table = TableWriter::new(stream);
    if let Some(first) = rows.first() {
        table.row(first.columns().keys())?;
    }
    for row in rows {
        table.row(row.columns().values().map(field))?;
    }
    table.flush()
}

/// Columns of the table of pairs.
fn pair_columns<'a>() -> [Column<(&'a InterfaceRow, &'a Contact<ResidueName>)>; 12] {
    [
        ("file", |(row, _)| json!(row.file)),
        ("model", |(row, _)| json!(row.model)),
        ("chain_1", |(_, pair)| json!(pair.residues[0].chain)),
        ("residue_1", |(_, pair)| json!(pair.residues[0].number)),
        ("name_1", |(_, pair)| json!(pair.residues[0].name)),
        ("chain_2", |(_, pair)| json!(pair.residues[1].chain)),
        ("residue_2", |(_, pair)| json!(pair.residues[1].number)),
        ("name_2", |(_, pair)| json!(pair.residues[1].name)),
        ("distance", |(_, pair)| json!(pair.distance)),
        ("hydrogen_bonds", |(_, pair)| json!(pair.hydrogen_bonds)),
        ("hydrogen_bond_distance", |(_, pair)| {
            json!(pair.hydrogen_bond_distance)
        }),
        ("salt_bridge", |(_, pair)| json!(pair.salt_bridge)),
    ]
}

/// Writes a row for each pair of residues in contact.
///
/// # Errors
/// Those of the stream.
pub fn write_pairs(stream: &mut dyn io::Write, rows: &[InterfaceRow]) -> io::Result<()> {
    let pairs = rows
        .iter()
        .flat_map(|row| row.interface.pairs.iter().map(move |pair| (row, pair)));
    write_table(stream, &pair_columns(), pairs)
}
