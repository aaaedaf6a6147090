//! A finished run among others, in a line.

use std::time::Instant;

use crate::tables::batch_results::RunSummary;
use serde_json::Value;

/// What came of a run; `anew` says whether it was docked now, since `clock`.
pub fn summary_line(summary: &RunSummary, anew: bool, clock: Instant) -> String {
    let [_, clusters] = summary.counts;
    let mut words = format!(
        "{} clusters, best pose score {}",
        clusters.unwrap_or(0),
        rounded(&summary.best["pose_score"], 1).unwrap_or_default()
    );
    for (name, column, digits) in [("z-score", "z_score", 1), ("DockQ", "dockq", 2)] {
        if let Some(value) = rounded(&summary.best[column], digits) {
            words += &format!(", {name} {value}");
        }
    }
    if let Some(rank) = summary.first_acceptable {
        words += &format!("; the first acceptable one at rank {rank}");
    }
    if anew {
        words + &format!("; {:.1} s", clock.elapsed().as_secs_f64())
    } else {
        words + "; done before"
    }
}

/// A number with so many decimals.
fn rounded(value: &Value, digits: usize) -> Option<String> {
    Some(format!("{:.digits$}", value.as_f64()?))
}
