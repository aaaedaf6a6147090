//! Complexes of any program against a known one: one row per model of a file.

use std::io;

use serde_json::{Value, json};

use crate::tables::{Column, object, write_table};
use knotdock::evaluate::{Criterion, PoseQuality};

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

/// The columns, in order; those of [`JSON_ALONE`] are not in the file.
const COLUMNS: [Column<EvaluatedComplex>; 15] = [
    ("file", |row| json!(row.file)),
    ("model", |row| json!(row.model)),
    ("chains_1", |row| json!(row.chains[0])),
    ("chains_2", |row| json!(row.chains[1])),
    ("irmsd", |row| json!(row.quality.irmsd)),
    ("lrmsd", |row| json!(row.quality.lrmsd)),
    ("fnat", |row| json!(row.quality.fnat)),
    ("dockq", |row| json!(row.quality.dockq)),
    ("capri", |row| json!(row.quality.capri.name())),
    ("acceptable", |row| {
        json!(Criterion::Acceptable.is_met(&row.quality))
    }),
    ("near_native", |row| {
        json!(Criterion::NearNative.is_met(&row.quality))
    }),
    ("interface_share", |row| json!(row.matched)),
    ("native_chains", |row| json!(row.native_chains)),
    ("backbone_rmsd_1", |row| json!(row.fits[0])),
    ("backbone_rmsd_2", |row| json!(row.fits[1])),
];

const JSON_ALONE: [&str; 4] = [
    "acceptable",
    "near_native",
    "backbone_rmsd_1",
    "backbone_rmsd_2",
];

/// The rows as JSON objects.
pub fn objects(rows: &[EvaluatedComplex]) -> Vec<Value> {
    let objects = rows.iter().map(|row| object(&COLUMNS, row).into());
    objects.collect()
}

/// Writes a row for each complex.
///
/// # Errors
/// Those of the stream.
pub fn write_complexes(rows: &[EvaluatedComplex], stream: &mut dyn io::Write) -> io::Result<()> {
    let columns = COLUMNS.iter();
    let columns = columns.filter(|(name, _)| !JSON_ALONE.contains(name));
    write_table(stream, columns, rows)
}
