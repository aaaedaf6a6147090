//! The columns that a known complex adds to `poses.csv`.

use crate::evaluate::PoseQuality;

use super::fields::{Column, number};

/// Columns `irmsd` and `lrmsd` in Å, `fnat` and `dockq` from 0 to 1, and `capri`, the class's name.
pub fn columns(qualities: &[PoseQuality]) -> Vec<Column> {
    let column = |name: &str, field: &dyn Fn(&PoseQuality) -> String| Column {
        name: name.to_owned(),
        fields: qualities.iter().map(field).collect(),
    };
    vec![
        column("irmsd", &|quality| number(quality.irmsd)),
        column("lrmsd", &|quality| number(quality.lrmsd)),
        column("fnat", &|quality| number(quality.fnat)),
        column("dockq", &|quality| number(quality.dockq)),
        column("capri", &|quality| quality.capri.name().to_owned()),
    ]
}
