//! The table of pairs that a batch docks: one row per pair, columns by name.

use std::collections::HashSet;
use std::path::Path;

use csv::StringRecord;

use knotdock::bounded_read::{MAX_PAIRS, read_bounded};
use knotdock::output::files::checksum::sha256;
use knotdock::table_text::cells::unquoted;
use knotdock::table_text::named_columns::{column_name, line_of, plain};
use knotdock_structures::Error;

/// What a line begins with that is no row.
const COMMENT: Option<u8> = Some(b'#');

/// A row of the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairRow {
    /// 1-based line in the file.
    pub line: u64,
    /// Name of the pair; empty where it has none.
    pub name: String,
    /// What stays: a file, perhaps with chains, as on the command line of `knotdock dock`.
    pub receptor: String,
    /// What moves, likewise; may be empty where copies of the receptor are docked into a ring.
    pub ligand: String,
    /// Options of `knotdock dock` with their values, by the names of their columns; those without a value are left out.
    pub options: Vec<(String, String)>,
}

impl PairRow {
    /// The beginning of SHA-256 of its fields.
    pub fn checksum(&self) -> String {
        let said = (&self.name, &self.receptor, &self.ligand, &self.options);
        let mut sum = sha256(serde_json::json!(said).to_string().as_bytes());
        sum.truncate(16);
        sum
    }
}

/// Reads a table of pairs: a header with `receptor` and `ligand`, perhaps `name`, and options of `knotdock dock`,
/// then at least one row. A row needs no ligand if it is docked into a ring: by a column `symmetry`, or because all
/// are (`rings`).
///
/// Spreadsheets save what they call CSV in several ways. Columns are separated by whichever of comma, semicolon and
/// tab the header has most of, or by the one that a first line `sep=;` names. A byte order mark is skipped. Column
/// names may have capital letters, and blanks or `-` for `_`.
///
/// # Errors
/// [`Error`], with file and line.
pub fn read_pairs(path: &Path, rings: bool) -> Result<Vec<PairRow>, Error> {
    let refused = |message: String| {
        Error::input(message).at(path).help(
            "give a CSV file with columns `receptor` and `ligand`, optionally `name` and options of `knotdock dock`, \
             and a row for each pair",
        )
    };
    let name = path.display();
    let bytes = read_bounded(path, MAX_PAIRS)
        .map_err(|source| refused(format!("cannot read {name}: {source}")))?;
    let wrong = |line: Option<u64>, fault: String| {
        refused(format!("{name} is not a table of pairs: {fault}")).on_line(line)
    };
    let (text, delimiter) = plain(bytes).map_err(|message| wrong(None, message))?;
    let line = |position: &csv::Position| line_of(text.as_bytes(), position, COMMENT);
    let malformed = |error: csv::Error| {
        let line = error.position().map(line);
        wrong(line, error.to_string())
    };
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(COMMENT)
        .delimiter(delimiter)
        .from_reader(text.as_bytes());
    let header = reader.headers().map_err(malformed)?;
    let first = header.position().map(line).or(Some(1));
    let header: StringRecord = header.iter().map(column_name).collect();
    let mut seen = HashSet::new();
    if let Some(column) = header.iter().find(|column| !seen.insert(*column)) {
        return Err(wrong(first, format!("there are two columns `{column}`")));
    }
    for column in ["receptor", "ligand"] {
        if !seen.contains(column) {
            let there: Vec<String> = header.iter().map(|name| format!("`{name}`")).collect();
            let message = match there.as_slice() {
                [] => format!("there is no column `{column}`: the file is empty"),
                there => format!(
                    "there is no column `{column}`; the first line has {}",
                    there.join(", ")
                ),
            };
            return Err(wrong(first, message));
        }
    }
    let rows = reader.records().map(|record| {
        let record = record.map_err(malformed)?;
        let line = record.position().map_or(0, line);
        let row = row(&header, &record, line);
        let rings = rings || row.options.iter().any(|(name, _)| name == "symmetry");
        for (column, field) in [("receptor", &row.receptor), ("ligand", &row.ligand)] {
            if field.is_empty() && !(rings && column == "ligand") {
                return Err(wrong(Some(line), format!("the pair has no {column}")));
            }
        }
        Ok(row)
    });
    let rows: Vec<PairRow> = rows.collect::<Result<_, _>>()?;
    if rows.is_empty() {
        return Err(wrong(None, "there is no pair in it".to_owned()));
    }
    Ok(rows)
}

fn row(header: &StringRecord, record: &StringRecord, line: u64) -> PairRow {
    let mut row = PairRow {
        line,
        name: String::new(),
        receptor: String::new(),
        ligand: String::new(),
        options: Vec::new(),
    };
    for (column, field) in header.iter().zip(record) {
        let field = unquoted(field).to_owned();
        match column {
            "name" => row.name = field,
            "receptor" => row.receptor = field,
            "ligand" => row.ligand = field,
            _ if field.is_empty() => {}
            option => row.options.push((option.to_owned(), field)),
        }
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<PairRow>, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pairs.csv");
        std::fs::write(&path, text).unwrap();
        read_pairs(&path, false)
    }

    #[test]
    fn columns_are_found_by_name_and_the_rest_are_options() {
        let rows = read(
            "ligand, receptor,active_ligand,name,rotations\n# of March\n\n\"b.cif:A,B\",a.pdb,,first,\nd.pdb,c.pdb,A:5,,120\n",
        )
        .unwrap();
        let option = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        let rings = read("receptor,ligand,symmetry\na.pdb,,C3\n").unwrap();
        assert_eq!(rings[0].ligand, "");
        assert_eq!(rings[0].options, [option("symmetry", "C3")]);
        assert_eq!(
            (rows[0].receptor.as_str(), rows[0].ligand.as_str()),
            ("a.pdb", "b.cif:A,B")
        );
        assert_eq!((rows[0].name.as_str(), rows[0].line), ("first", 4));
        assert!(rows[0].options.is_empty());
        assert_eq!(rows[1].name, "");
        let expected = [option("active_ligand", "A:5"), option("rotations", "120")];
        assert_eq!(rows[1].options, expected);
    }

    /// Found with tables that spreadsheets had saved: `no column receptor` was all that was said.
    #[test]
    fn tables_of_spreadsheets_are_read() {
        let plain = read("receptor,ligand,active_ligand\n\"a.pdb:H,L\",b.pdb,A:5\n").unwrap();
        for text in [
            "receptor;ligand;active_ligand\na.pdb:H,L;b.pdb;A:5\n",
            "receptor\tligand\tactive_ligand\r\na.pdb:H,L\tb.pdb\tA:5\r\n",
            "\u{feff}Receptor,LIGAND,Active ligand\n\"a.pdb:H,L\",b.pdb,A:5\n",
            "\u{feff}\"Receptor\";\"Ligand\";\"active-ligand\"\n\"a.pdb:H,L\";b.pdb;A:5\n",
        ] {
            assert_eq!(read(text).unwrap(), plain, "{text:?}");
        }
        let named = read("sep=|\r\nreceptor|ligand\r\na.pdb:H,L|b.pdb\r\n").unwrap();
        assert_eq!(
            (named[0].receptor.as_str(), named[0].line),
            ("a.pdb:H,L", 3)
        );
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("utf16.csv");
        std::fs::write(&path, b"\xff\xfer\0e\0c\0").unwrap();
        let error = read_pairs(&path, false).unwrap_err();
        assert!(error.to_string().contains("UTF-8"), "{error}");
    }

    #[test]
    fn tables_that_are_none_are_refused_by_line() {
        for (text, line, fault) in [
            ("", Some(1), "no column `receptor`"),
            ("receptor,name\na.pdb,x\n", Some(1), "no column `ligand`"),
            ("# pairs\na;b\n", Some(2), "the first line has `a`, `b`"),
            ("receptor,ligand,ligand\na,b,c\n", Some(1), "two columns"),
            ("receptor,ligand\n", None, "no pair"),
            ("receptor,ligand\na.pdb,b.pdb\nc.pdb\n", Some(3), "fields"),
            ("receptor,ligand\na.pdb,\n", Some(2), "no ligand"),
            ("receptor,ligand,symmetry\n,,C2\n", Some(2), "no receptor"),
            ("receptor,ligand,symmetry\na,,\n", Some(2), "no ligand"),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.line(), line, "{text}");
            assert!(error.to_string().contains(fault), "{error}");
        }
        let error = read_pairs(Path::new("nowhere.csv"), false).unwrap_err();
        assert_eq!(error.file(), Some(Path::new("nowhere.csv")));
        assert!(error.to_string().contains("cannot read"), "{error}");
    }
}
