//! Complexes of any program against a known one: one row per model of a file.

use std::io;

use serde_json::{Map, Value, json};

use knotdock::evaluate::PoseQuality;
use knotdock::output::tables::fields::number;
use knotdock::output::tables::quality;
use knotdock::table_text::cells::TableWriter;

/// A complex, and how near it is to the known one.
#[derive(Clone, Debug)]
pub struct EvaluatedComplex {
    /// Its file as it was named.
    pub file: String,
    /// Its place among the models of the file, from 1.
    pub model: usize,
    /// Chains of each side, with commas between them.
    pub chains: [String; 2],
    /// Its chains with those of the known complex, as `A:E,B:F`.
    pub native_chains: String,
    /// Backbone RMSD in Å of each side by itself with the known complex's.
    pub fits: [f64; 2],
    /// Share of the interface residues of the known complex that it has.
    pub matched: f64,
    /// How near it is.
    pub quality: PoseQuality,
}

impl EvaluatedComplex {
    /// Its row as a JSON object.
    pub fn object(&self) -> Value {
        let mut object = Map::new();
        object.insert("file".to_owned(), json!(self.file));
        object.insert("model".to_owned(), json!(self.model));
        object.insert("chains_1".to_owned(), json!(self.chains[0]));
        object.insert("chains_2".to_owned(), json!(self.chains[1]));
        object.extend(quality::object(&self.quality));
        object.insert("interface_share".to_owned(), json!(self.matched));
        object.insert("native_chains".to_owned(), json!(self.native_chains));
        object.insert("backbone_rmsd_1".to_owned(), json!(self.fits[0]));
        object.insert("backbone_rmsd_2".to_owned(), json!(self.fits[1]));
        Value::Object(object)
    }
}

/// Writes a row for each complex: `file`, `model`, `chains_1`, `chains_2`, `irmsd` and `lrmsd` in Å, `fnat`, `dockq`,
/// `capri`, `interface_share` (the share of the known complex's interface residues that the file has) and
/// `native_chains` (the chains with those of the known complex, as `A:E,B:F`).
///
/// # Errors
/// Those of the stream.
pub fn write_complexes(rows: &[EvaluatedComplex], stream: &mut dyn io::Write) -> io::Result<()> {
    let mut table = TableWriter::new(stream);
    let header = [
        "file",
        "model",
        "chains_1",
        "chains_2",
        "irmsd",
        "lrmsd",
        "fnat",
        "dockq",
        "capri",
        "interface_share",
        "native_chains",
    ];
    table.row(header)?;
    for row in rows {
        let quality = &row.quality;
        table.row([
            row.file.clone(),
            row.model.to_string(),
            row.chains[0].clone(),
            row.chains[1].clone(),
            number(quality.irmsd),
            number(quality.lrmsd),
            number(quality.fnat),
            number(quality.dockq),
            quality.capri.name().to_owned(),
            number(row.matched),
            row.native_chains.clone(),
        ])?;
    }
    table.flush()
}
