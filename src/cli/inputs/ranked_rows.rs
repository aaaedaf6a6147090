//! Rows of a run's table by their ranks.

use std::collections::HashMap;
use std::path::Path;

use knotdock::output::tables::poses::{PoseRow, PoseTable};

use crate::cli::arguments::ranks::Ranks;
use crate::cli::messages::failure::Failure;

/// The rows of some ranks of the table at a path, in the order of the ranks.
pub fn ranked_rows(table_path: &Path, ranks: &Ranks) -> Result<Vec<PoseRow>, Failure> {
    let table = PoseTable::read(table_path)?;
    let of_rank: HashMap<usize, PoseRow> =
        table.rows().iter().map(|row| (row.rank, *row)).collect();
    let rows = ranks.0.iter().map(|rank| {
        of_rank.get(rank).copied().ok_or_else(|| {
            Failure::input(format!(
                "there is no rank {rank} among the {} rows",
                table.rows().len()
            ))
            .at(table_path)
            .remedy(
                "choose ranks that the table lists; `knotdock dock --no-cluster` lists every pose",
            )
        })
    });
    rows.collect()
}
