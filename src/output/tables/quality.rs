//! The columns that a known complex adds to `poses.csv`.

use serde_json::{Map, Value, json};

use crate::evaluate::{Criterion, PoseQuality};

use crate::output::tables::fields::{Column, number};

/// Columns of the complexes that a run writes: pairs of heavy atoms that overlap by more than 0.5 Å, and the interface RMSD in
/// Å. They are of this run's complexes alone.
pub const OF_COMPLEXES: [&str; 2] = ["complex_clashes", "complex_irmsd"];

/// Columns `irmsd` and `lrmsd` in Å, `fnat` and `dockq` from 0 to 1, and `capri`, the class's name; empty for a pose that
/// could not be measured.
pub fn columns(qualities: &[Option<PoseQuality>]) -> Vec<Column> {
    let column = |name: &str, field: &dyn Fn(&PoseQuality) -> String| Column {
        name: name.to_owned(),
        fields: qualities
            .iter()
            .map(|quality| quality.as_ref().map(field).unwrap_or_default())
            .collect(),
    };
    vec![
        column("irmsd", &|quality| number(quality.irmsd)),
        column("lrmsd", &|quality| number(quality.lrmsd)),
        column("fnat", &|quality| number(quality.fnat)),
        column("dockq", &|quality| number(quality.dockq)),
        column("capri", &|quality| quality.capri.name().to_owned()),
    ]
}

/// The quality of one pose as JSON, with whether it is acceptable and near-native.
pub fn object(quality: &PoseQuality) -> Map<String, Value> {
    let entries = [
        ("irmsd", json!(quality.irmsd)),
        ("lrmsd", json!(quality.lrmsd)),
        ("fnat", json!(quality.fnat)),
        ("dockq", json!(quality.dockq)),
        ("capri", json!(quality.capri.name())),
        ("acceptable", json!(Criterion::Acceptable.is_met(quality))),
        ("near_native", json!(Criterion::NearNative.is_met(quality))),
    ];
    let entries = entries.map(|(name, value)| (name.to_owned(), value));
    Map::from_iter(entries)
}
