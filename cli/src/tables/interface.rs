//! Tables of interfaces: a row for each model of each complex file, and a row for each pair of residues in contact.

use std::io;

use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::POSE_TERMS;
use serde_json::{Map, Value, json};

use knotdock::interface::{Interface, PlacedScore};
use knotdock::output::tables::fields::number;
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
const PAIRS: [&str; 12] = [
    "file",
    "model",
    "chain_1",
    "residue_1",
    "name_1",
    "chain_2",
    "residue_2",
    "name_2",
    "distance",
    "hydrogen_bonds",
    "hydrogen_bond_distance",
    "salt_bridge",
];

/// Writes a row for each pair of residues in contact.
///
/// # Errors
/// Those of the stream.
pub fn write_pairs(stream: &mut dyn io::Write, rows: &[InterfaceRow]) -> io::Result<()> {
    let mut table = TableWriter::new(stream);
    table.row(PAIRS)?;
    for row in rows {
        for pair in &row.interface.pairs {
            let [a, b] = &pair.residues;
            let distance = number(pair.distance);
            let bonds = pair.hydrogen_bonds.to_string();
            let bond = pair.hydrogen_bond_distance.map(number).unwrap_or_default();
            let bridge = pair.salt_bridge.to_string();
            let model = row.model.to_string();
            table.row([
                &row.file, &model, &a.chain, &a.number, &a.name, &b.chain, &b.number, &b.name,
                &distance, &bonds, &bond, &bridge,
            ])?;
        }
    }
    table.flush()
}

/// A value as a field.
fn field(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(value) if value.is_f64() => value.as_f64().map(number).unwrap_or_default(),
        value => value.to_string(),
    }
}
