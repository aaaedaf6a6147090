//! Rows of a run's table by their ranks.

use std::collections::HashMap;
use std::path::Path;

use knotdock::output::tables::poses::{PoseRow, PoseTable};

use crate::arguments::ranks::Ranks;
use knotdock_structures::Error;

/// The rows of some ranks of the table at a path, in the order of the ranks.
pub fn ranked_rows(table_path: &Path, ranks: &Ranks) -> Result<Vec<PoseRow>, Error> {
    let table = PoseTable::read(table_path)?;
    let places = ranked_places(&table, table_path, ranks)?;
    Ok(places
        .into_iter()
        .map(|place| table.rows()[place])
        .collect())
}

/// Places of the rows of some ranks in the table read from a path, in the order of the ranks.
pub fn ranked_places(
    table: &PoseTable,
    table_path: &Path,
    ranks: &Ranks,
) -> Result<Vec<usize>, Error> {
    let rows = table.rows().iter().enumerate();
    let of_rank: HashMap<usize, usize> = rows.map(|(place, row)| (row.rank, place)).collect();
    let places = ranks.0.iter().map(|rank| {
        of_rank.get(rank).copied().ok_or_else(|| {
            Error::input(format!(
                "there is no rank {rank} among the {} rows",
                table.rows().len()
            ))
            .at(table_path)
            .help(
                "choose ranks that the table lists; `knotdock dock --no-cluster` lists every pose",
            )
        })
    });
    places.collect()
}
