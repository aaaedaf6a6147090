//! Figures of the clusters, which poses.csv does not hold: from the search, or from the report that is written anew.

use std::path::Path;

use serde_json::{Value, json};

use crate::report::html::data_of;
use crate::report::shown::significant;
use knotdock::bounded_read::read_bounded;
use knotdock::output::files::seal::is_sealed;
use knotdock::output::run_contacts::MAX_ROWS;
use knotdock::output::tables::poses::PoseTable;
use knotdock::rank::cluster::ClusterFigures;

/// Digits of scores and of distances.
const DIGITS: [i32; 2] = [5, 3];
/// Largest report that is read.
const MAX_BYTES: u64 = 64 << 20;

/// The figures of the clusters in a table's first rows, as the scripts of a report read them: size, best, mean and standard
/// deviation of the scores, mean and largest RMSD.
pub fn figures(clusters: &[ClusterFigures], table: &PoseTable) -> Value {
    let rows = 0..table.rows().len().min(MAX_ROWS);
    let numbers = rows.filter_map(|row| table.field(row, "cluster")?.parse().ok());
    let shown = numbers.max().unwrap_or(0);
    let row = |cluster: &ClusterFigures| {
        let [mean, largest] = match cluster.rmsd {
            None => [Value::Null, Value::Null],
            Some(rmsd) => rmsd.map(|rmsd| json!(significant(rmsd, DIGITS[1]))),
        };
        let scores = [cluster.best, cluster.mean, cluster.deviation];
        let [best, score, deviation] = scores.map(|score| significant(score, DIGITS[0]));
        json!([cluster.size, best, score, deviation, mean, largest])
    };
    clusters.iter().take(shown).map(row).collect()
}

/// The figures in the report of a run, if it is as it was written and has the clusters of the table; else `null`.
pub fn figures_of(report: &Path, table: &PoseTable) -> Value {
    let text = is_sealed(report).then(|| read_bounded(report, MAX_BYTES).ok());
    let data = text.flatten().and_then(|text| data_of(&text));
    let figures = data.map_or(Value::Null, |mut data| data["clusters"].take());
    let number = |row: usize, column: &str| table.field(row, column)?.parse::<usize>().ok();
    let is_alike = |row: usize| {
        let cluster = number(row, "cluster").and_then(|number| number.checked_sub(1));
        let size = cluster.and_then(|cluster| figures.get(cluster)?.get(0)?.as_u64());
        size.is_none_or(|size| number(row, "cluster_size").map(|size| size as u64) == Some(size))
    };
    match (0..table.rows().len()).all(is_alike) {
        true => figures,
        false => Value::Null,
    }
}
