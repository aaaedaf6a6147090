//! Tables whose first row names their columns, in any order, as people and spreadsheets write them.
//!
//! Lines that begin with `#` and rows of empty fields are skipped. Columns are separated by commas, semicolons or tabs.

use csv::StringRecord;
use knotdock_structures::Error;

use crate::table_text::cells::unquoted;

/// The byte that begins a comment.
pub const COMMENT: Option<u8> = Some(b'#');

/// The columns of a table.
pub(crate) struct Columns<const N: usize> {
    /// The columns that a table may have.
    pub names: [&'static str; N],
    /// Those that it must have.
    pub needed: &'static [&'static str],
    /// Remedy for a header with other columns.
    pub remedy: &'static str,
}

/// Reads a table and visits each row with its line. Fields are in the order of the columns' names, empty if the table
/// lacks the column. Returns false for a table without a header. Lines end with LF.
///
/// # Errors
/// [`Error`] with the line: no CSV in UTF-8, columns that are not known or missing, a row of another number of fields,
/// and the errors of `visit`.
pub(crate) fn read_rows<const N: usize>(
    bytes: Vec<u8>,
    columns: &Columns<N>,
    mut visit: impl FnMut(u64, &[&str; N]) -> Result<(), Error>,
) -> Result<bool, Error> {
    let unreadable = |message: String| {
        Error::input(format!("the table cannot be read: {message}"))
            .help("give a CSV table in UTF-8")
    };
    let (text, delimiter) = plain(bytes).map_err(unreadable)?;
    let line = |position: &csv::Position| line_of(text.as_bytes(), position, COMMENT);
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(COMMENT)
        .delimiter(delimiter)
        .from_reader(text.as_bytes());
    let mut header: Option<Vec<usize>> = None;
    for record in reader.records() {
        let record = record
            .map_err(|error| unreadable(error.to_string()).on_line(error.position().map(line)))?;
        // A comment may have blanks before it, and spreadsheets end tables with rows of empty fields.
        let is_comment = record.get(0).is_some_and(|field| field.starts_with('#'));
        if is_comment || record.iter().all(str::is_empty) {
            continue;
        }
        let line = record.position().map_or(1, line);
        match &header {
            None => {
                let places = columns.places(&record);
                header = Some(places.map_err(|error| error.on_line(line))?);
            }
            Some(places) if record.len() != places.len() => {
                let (fields, columns) = (record.len(), places.len());
                let message = format!("the row has {fields} fields and the header {columns}");
                return Err(Error::input(message).on_line(line).help(
                    "give each row a field for each column, and put a field with commas in quotes",
                ));
            }
            Some(places) => {
                let mut row = [""; N];
                for (&place, field) in places.iter().zip(&record) {
                    row[place] = unquoted(field);
                }
                visit(line, &row).map_err(|error| error.on_line(line))?;
            }
        }
    }
    Ok(header.is_some())
}

impl<const N: usize> Columns<N> {
    /// Place of each column of a header among the names.
    fn places(&self, header: &StringRecord) -> Result<Vec<usize>, Error> {
        let names: Vec<String> = header.iter().map(column_name).collect();
        let refused = |message: String| Error::input(message).help(self.remedy);
        let mut places = Vec::new();
        for name in &names {
            let place = self.names.iter().position(|column| column == name);
            let place = place
                .ok_or_else(|| refused(format!("column `{}` is not known", shortened(name))))?;
            if places.contains(&place) {
                return Err(refused(format!("there are two columns `{name}`")));
            }
            places.push(place);
        }
        let mut needed = self.needed.iter();
        match needed.find(|column| !names.iter().any(|name| name == *column)) {
            Some(column) => {
                let present = listed(names.iter().map(String::as_str));
                let message = format!("there is no column `{column}`; the header has {present}");
                Err(refused(message))
            }
            None => Ok(places),
        }
    }
}

/// The beginning of a text, for messages.
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

/// The text without a byte order mark, and the byte that separates its columns.
pub fn plain(bytes: Vec<u8>) -> Result<(String, u8), String> {
    let text = String::from_utf8(bytes)
        .map_err(|_| "it is not text in UTF-8, as which spreadsheets can save it".to_owned())?;
    let mut text = match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    };
    let first = text.lines().next().unwrap_or_default().trim_end();
    if let Some([delimiter]) = first.strip_prefix("sep=").map(str::as_bytes) {
        let delimiter = *delimiter;
        // A comment, so that lines keep their numbers.
        text.replace_range(..1, "#");
        return Ok((text, delimiter));
    }
    let header = text
        .lines()
        .find(|line| !line.is_empty() && !line.starts_with('#'))
        .unwrap_or_default();
    let count = |byte: &u8| header.bytes().filter(|other| other == byte).count();
    // The last of equals is taken.
    let delimiter = b"\t;,".iter().max_by_key(|&byte| count(byte));
    let delimiter = *delimiter.unwrap_or(&b',');
    Ok((text, delimiter))
}

/// A column's name as options of the command line are spelled, but for `_` in place of `-`.
pub fn column_name(name: &str) -> String {
    name.to_lowercase().replace(['-', ' '], "_")
}

/// The 1-based line on which a record begins, whose position is that of the reader before it passed over empty lines and
/// comments, which begin with the byte `comment`.
pub fn line_of(text: &[u8], position: &csv::Position, comment: Option<u8>) -> u64 {
    let from = usize::try_from(position.byte()).unwrap_or(usize::MAX);
    let rest = text.get(from..).unwrap_or_default();
    position.line() + passed_over(rest.split(|&byte| byte == b'\n'), comment)
}

/// The number of lines before a record that the reader passes over. No line after the record's is read: reading the rest of
/// the file for every row would be quadratic.
fn passed_over<'a>(
    lines: impl DoubleEndedIterator<Item = &'a [u8]> + Clone,
    comment: Option<u8>,
) -> u64 {
    let is_passed = |line: &[u8]| {
        line.strip_suffix(b"\r").unwrap_or(line).is_empty()
            || comment.is_some_and(|comment| line.starts_with(&[comment]))
    };
    let passed = lines
        .clone()
        .position(|line| !is_passed(line))
        .unwrap_or_else(|| {
            // There is a record, if only a last line that the reader took for one.
            let rest = lines.rev().skip_while(|line| line.is_empty());
            rest.count().saturating_sub(1)
        });
    passed as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<(u64, [String; 2])>, Error> {
        let columns = Columns {
            names: ["chain", "weight"],
            needed: &["chain"],
            remedy: "name the columns",
        };
        let mut rows = Vec::new();
        read_rows(text.into(), &columns, |line, row| {
            rows.push((line, row.map(str::to_owned)));
            Ok(())
        })?;
        Ok(rows)
    }

    #[test]
    fn columns_go_by_their_names() {
        let row =
            |line: u64, chain: &str, weight: &str| (line, [chain.to_owned(), weight.to_owned()]);
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
            let error = read(text).unwrap_err();
            assert_eq!((error.line(), error.message()), (Some(line), message));
            assert!(error.remedy().is_some());
        }
        let columns = Columns {
            names: ["c"],
            needed: &[],
            remedy: "",
        };
        let error = read_rows(vec![b'c', 0xff], &columns, |_, _| Ok(())).unwrap_err();
        assert!(error.message().contains("UTF-8"), "{error}");
    }

    /// Every row went through the rest of the file for its line: 40,000 rows took 79 s, and 80,000 four times as long.
    #[test]
    fn no_line_after_the_record_is_read() {
        let read = std::cell::Cell::new(0);
        let text = "\n# no\n1,2\n".to_owned() + &"3,4\n".repeat(40_000);
        let lines = text.as_bytes().split(|&byte| byte == b'\n');
        let counted = lines.inspect(|_| read.set(read.get() + 1));
        assert_eq!(passed_over(counted, Some(b'#')), 2);
        assert_eq!(read.get(), 3);
    }

    #[test]
    fn what_the_reader_passes_over_counts() {
        let text = "a,b\n\n1,2\n# no\n \n\n3,4\n5,6\n";
        let lines = |text: &str, comment| {
            let reader = csv::ReaderBuilder::new()
                .comment(comment)
                .flexible(true)
                .from_reader(text.as_bytes());
            let records = reader.into_records();
            let lines = records.map(|record| {
                let record = record.unwrap();
                line_of(text.as_bytes(), record.position().unwrap(), comment)
            });
            lines.collect::<Vec<_>>()
        };
        // A line of blanks is a record of one field.
        for text in [text, &text.replace('\n', "\r\n")] {
            assert_eq!(lines(text, Some(b'#')), [3, 5, 7, 8]);
            assert_eq!(lines(text, None), [3, 4, 5, 7, 8]);
        }
    }
}
