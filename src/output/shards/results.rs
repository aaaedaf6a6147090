//! `results.csv` of a shard: the pair's row in the table of pairs, then a batch's columns.

use csv::{ReaderBuilder, StringRecord};

use super::ShardError;
use crate::output::tables::batch_results::{DONE, PairResult, fields, header};
use crate::output::tables::cells::{TableWriter, unquoted_row};

/// A row of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ResultRow {
    /// The pair's row in the table of pairs, from 1.
    pub row: usize,
    /// What a batch's results.csv has of it.
    pub fields: StringRecord,
    /// Where the row ends in the file, in bytes.
    pub end: u64,
}

impl ResultRow {
    /// The pair's name.
    pub fn name(&self) -> &str {
        self.fields.get(0).unwrap_or_default()
    }

    /// Whether the pair was docked.
    pub fn is_done(&self) -> bool {
        self.fields.get(STATUS) == Some(DONE)
    }
}

/// Which of a batch's columns says what became of a pair.
const STATUS: usize = 3;

/// The first line.
pub(super) fn head() -> Vec<u8> {
    let names: Vec<&str> = std::iter::once("row").chain(header()).collect();
    line(&names)
}

/// The line of a pair.
pub(super) fn of_pair(row: usize, result: &PairResult) -> Vec<u8> {
    let mut cells = vec![row.to_string()];
    cells.extend(fields(result));
    line(&cells)
}

fn line<T: AsRef<str>>(cells: &[T]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut table = TableWriter::new(&mut bytes);
    // A vector takes whatever is written.
    let _ = table.row(cells).and_then(|()| table.flush());
    drop(table);
    bytes
}

/// The whole rows of a shard's table; none where its first line is not whole. What follows the first row that is cut
/// short is left out.
///
/// # Errors
/// [`ShardError::Wrong`] where the first line is of another table.
pub(super) fn rows(path: &std::path::Path, bytes: &[u8]) -> Result<Vec<ResultRow>, ShardError> {
    let head = head();
    if bytes.len() < head.len() && head.starts_with(bytes) {
        return Ok(Vec::new());
    }
    if !bytes.starts_with(&head) {
        return Err(ShardError::wrong(
            path,
            "this is not a table of results of a shard",
            "remove the shard's folder, and dock it again",
        ));
    }
    let count = header().len() + 1;
    let mut reader = ReaderBuilder::new().flexible(true).from_reader(bytes);
    let (mut rows, mut record) = (Vec::new(), StringRecord::new());
    while matches!(reader.read_record(&mut record), Ok(true)) {
        let end = reader.position().byte();
        let is_ended = usize::try_from(end)
            .ok()
            .and_then(|end| bytes.get(..end))
            .is_some_and(|read| read.ends_with(b"\n"));
        let plain = unquoted_row(&record);
        let row = plain.get(0).and_then(|row| row.parse().ok());
        match row {
            Some(row) if is_ended && plain.len() == count => rows.push(ResultRow {
                row,
                fields: plain.iter().skip(1).collect(),
                end,
            }),
            _ => break,
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Wherever the file is cut, the rows before that place are found.
    #[test]
    fn whole_rows_are_found_in_what_is_left() {
        let pair = |name: &str, error: &str| PairResult {
            name: name.to_owned(),
            receptor: "a,b.pdb".to_owned(),
            ligand: "=c.pdb".to_owned(),
            outcome: Some(Err(error.to_owned())),
        };
        let mut bytes = head();
        let mut ends = Vec::new();
        for (row, pair) in [(3, pair("x", "of\n\"two\" lines\n")), (1, pair("y", ""))] {
            bytes.extend(of_pair(row, &pair));
            ends.push(bytes.len());
        }
        let path = Path::new("results.csv");
        for length in 0..=bytes.len() {
            let found = rows(path, &bytes[..length]).unwrap();
            let expected = ends.iter().filter(|end| **end <= length).count();
            assert_eq!(found.len(), expected, "{length}");
        }
        let found = rows(path, &bytes).unwrap();
        assert_eq!(found.iter().map(|row| row.row).collect::<Vec<_>>(), [3, 1]);
        assert_eq!(found[0].fields.get(2), Some("=c.pdb"));
        assert!(!found[0].is_done());
        assert!(rows(path, b"name,value\n").is_err());
    }
}
