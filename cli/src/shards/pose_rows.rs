//! Rows of the file of poses, which has the same columns for all pairs.

use std::io;

use super::members::packed;
use knotdock::output::tables::fields::Column;
use knotdock::output::tables::run_table::RunTable;
use knotdock::table_text::cells::TableWriter;

/// Columns that some runs add to their tables, in this order. Each is empty where a pair has none of it.
pub const WIDE_COLUMNS: [&str; 6] = ["restraints_met", "irmsd", "lrmsd", "fnat", "dockq", "capri"];

/// A pair's poses as a member of the file: each row is the pair's name and a row of its `poses.csv`.
#[derive(Clone, Debug)]
pub struct PosesOfPair(Vec<u8>);

impl PosesOfPair {
    /// The first `count` rows of a table by [`RunTable::wide`].
    ///
    /// # Errors
    /// None that memory does not have.
    pub fn new(name: &str, table: &RunTable, count: usize) -> io::Result<Self> {
        let mut text = Vec::new();
        let mut rows = TableWriter::new(&mut text);
        for record in table.records().take(count) {
            rows.row(std::iter::once(name).chain(&record))?;
        }
        rows.flush()?;
        drop(rows);
        packed(&text).map(Self)
    }

    /// Its bytes.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }
}

/// The first member: the names of the columns.
///
/// # Errors
/// None that memory does not have.
pub(super) fn header() -> io::Result<Vec<u8>> {
    let further = WIDE_COLUMNS.map(|name| Column {
        name: name.to_owned(),
        fields: Vec::new(),
    });
    let columns = RunTable::wide(&[], &further).header();
    let mut text = Vec::new();
    let mut table = TableWriter::new(&mut text);
    table.row(std::iter::once("name").chain(&columns))?;
    table.flush()?;
    drop(table);
    packed(&text)
}
