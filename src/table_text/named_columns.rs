//! Tables whose first row names their columns, in any order, as people and spreadsheets write them.
//!
//! Lines that begin with `#` and rows of empty fields are skipped. Columns are separated by commas, semicolons or tabs.

use std::collections::HashSet;

use csv::StringRecord;

use crate::table_text::cells::unquoted;
use crate::table_text::csv_lines::line_of;
use crate::table_text::spreadsheet::{column_name, plain};

const COMMENT: Option<u8> = Some(b'#');

/// Why rows cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableFault {
    /// No text, or no rows of fields.
    #[error("the table cannot be read: {0}")]
    Unreadable(String),
    /// A column that is needed is not there.
    #[error("there is no column `{column}`; the header has {present}")]
    MissingColumn {
        /// The column.
        column: &'static str,
        /// The columns that there are, in words.
        present: String,
    },
    /// A column that means nothing here.
    #[error("column `{0}` is not known")]
    UnknownColumn(String),
    /// Two columns of one name.
    #[error("there are two columns `{0}`")]
    RepeatedColumn(String),
    /// A row with more or fewer fields than the header.
    #[error("the row has {fields} fields and the header {columns}")]
    FieldCount {
        /// Fields of the row.
        fields: usize,
        /// Fields of the header.
        columns: usize,
    },
}

impl TableFault {
    /// Remedy where a row has more or fewer fields than the header.
    pub const FIELD_COUNT_REMEDY: &str =
        "give each row a field for each column, and put a field with commas in quotes";
}

/// A fault with its 1-based line, where one is at fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct AtLine<F> {
    pub line: Option<usize>,
    pub fault: F,
}

/// Reads a table with some of the columns given, `needed` among them, and visits each row with its line. Fields are in
/// the order of `columns`, empty where there is none. False where not even a header is there. Lines end with LF.
pub(crate) fn read_rows<const N: usize, F: From<TableFault>>(
    bytes: Vec<u8>,
    columns: [&'static str; N],
    needed: &[&'static str],
    mut visit: impl FnMut(usize, &[&str; N]) -> Result<(), F>,
) -> Result<bool, AtLine<F>> {
    let unreadable = |line: Option<usize>, message: String| AtLine {
        line,
        fault: TableFault::Unreadable(message).into(),
    };
    let (text, delimiter) = plain(bytes).map_err(|message| unreadable(None, message))?;
    let line = |position: &csv::Position| {
        usize::try_from(line_of(text.as_bytes(), position, COMMENT)).unwrap_or(usize::MAX)
    };
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(COMMENT)
        .delimiter(delimiter)
        .from_reader(text.as_bytes());
    let mut header: Option<Vec<usize>> = None;
    for record in reader.records() {
        let record =
            record.map_err(|error| unreadable(error.position().map(line), error.to_string()))?;
        // A comment may have blanks before it, and spreadsheets end tables with rows of empty fields.
        let is_comment = record.get(0).is_some_and(|field| field.starts_with('#'));
        if is_comment || record.iter().all(str::is_empty) {
            continue;
        }
        let line = record.position().map_or(1, line);
        let at_line = |fault: F| AtLine {
            line: Some(line),
            fault,
        };
        let of_table = |fault: TableFault| at_line(fault.into());
        match &header {
            None => header = Some(places(&record, &columns, needed).map_err(of_table)?),
            Some(places) if record.len() != places.len() => {
                return Err(of_table(TableFault::FieldCount {
                    fields: record.len(),
                    columns: places.len(),
                }));
            }
            Some(places) => {
                let mut row = [""; N];
                for (&place, field) in places.iter().zip(&record) {
                    row[place] = unquoted(field);
                }
                visit(line, &row).map_err(at_line)?;
            }
        }
    }
    Ok(header.is_some())
}

/// Which of `columns` each column of a header is.
fn places(
    header: &StringRecord,
    columns: &[&'static str],
    needed: &[&'static str],
) -> Result<Vec<usize>, TableFault> {
    let names: Vec<String> = header.iter().map(column_name).collect();
    let mut seen = HashSet::new();
    let mut places = Vec::new();
    for name in &names {
        let place = columns.iter().position(|column| column == name);
        places.push(place.ok_or_else(|| TableFault::UnknownColumn(shortened(name)))?);
        if !seen.insert(name.as_str()) {
            return Err(TableFault::RepeatedColumn(name.clone()));
        }
    }
    match needed.iter().find(|column| !seen.contains(*column)) {
        Some(column) => Err(TableFault::MissingColumn {
            column,
            present: listed(names.iter().map(String::as_str)),
        }),
        None => Ok(places),
    }
}

/// A text of the file as far as a message needs it.
pub(crate) fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    let mut shown: String = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if let Some((end, _)) = shown.char_indices().nth(MOST) {
        shown.truncate(end);
        shown += " ...";
    }
    shown
}

/// Words with commas between, the first thirty.
pub fn listed<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    const MOST: usize = 30;
    let mut words = words.into_iter();
    let mut shown: Vec<&str> = words.by_ref().take(MOST).collect();
    if words.next().is_some() {
        shown.push("...");
    }
    shown.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<(usize, [String; 2])>, AtLine<TableFault>> {
        let mut rows = Vec::new();
        read_rows(text.into(), ["chain", "weight"], &["chain"], |line, row| {
            rows.push((line, row.map(str::to_owned)));
            Ok(())
        })?;
        Ok(rows)
    }

    #[test]
    fn columns_go_by_their_names() {
        let row =
            |line: usize, chain: &str, weight: &str| (line, [chain.to_owned(), weight.to_owned()]);
        let rows = read("# of May\nWeight;Chain\n1;A\n\n;\n2;\"B\"\n").unwrap();
        assert_eq!(rows, [row(3, "A", "1"), row(6, "B", "2")]);
        assert_eq!(read("chain\nA\n").unwrap(), [row(2, "A", "")]);
        assert_eq!(read("").unwrap(), []);
    }

    #[test]
    fn headers_are_refused_by_their_line() {
        for (text, line, message) in [
            (
                "weight\n",
                1,
                "there is no column `chain`; the header has weight",
            ),
            ("#\nchain,mass\n", 2, "column `mass` is not known"),
            ("chain,chain\n", 1, "there are two columns `chain`"),
            ("chain\nA,1\n", 2, "the row has 2 fields and the header 1"),
        ] {
            let AtLine { line: at, fault } = read(text).unwrap_err();
            assert_eq!((at, fault.to_string().as_str()), (Some(line), message));
        }
        let bytes = vec![b'c', 0xff];
        let fault = read_rows::<1, TableFault>(bytes, ["c"], &[], |_, _| Ok(())).unwrap_err();
        assert!(matches!(fault.fault, TableFault::Unreadable(_)));
    }
}
