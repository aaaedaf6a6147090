//! The table of pairs that a batch docks: one row a pair, columns by name.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use csv::StringRecord;

use super::csv_lines::line_of;

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

/// Why a table of pairs cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PairTableError {
    /// The file cannot be read, is not CSV, or a row has more or fewer fields than the header.
    #[error("{} is not a table of pairs: {message}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// 1-based line, where known.
        line: Option<u64>,
        /// What is wrong.
        message: String,
    },
    /// The file cannot be opened.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

impl PairTableError {
    /// The file in question.
    pub fn path(&self) -> &Path {
        match self {
            Self::Csv { path, .. } | Self::Open { path, .. } => path,
        }
    }

    /// The 1-based line in question, where there is one.
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::Csv { line, .. } => *line,
            Self::Open { .. } => None,
        }
    }
}

/// Reads a table of pairs: a header with `receptor` and `ligand`, perhaps `name`, and options of `knotdock dock`, then at least one row. A row needs no
/// ligand if it is docked into a ring: by a column `symmetry`, or because all are (`rings`).
///
/// # Errors
/// [`PairTableError`].
pub fn read_pairs(path: &Path, rings: bool) -> Result<Vec<PairRow>, PairTableError> {
    let text = std::fs::read_to_string(path).map_err(|source| PairTableError::Open {
        path: path.to_owned(),
        source,
    })?;
    let wrong = |line: Option<u64>, message: String| PairTableError::Csv {
        path: path.to_owned(),
        line,
        message,
    };
    let line = |position: &csv::Position| line_of(text.as_bytes(), position, COMMENT);
    let malformed = |error: csv::Error| {
        let line = error.position().map(line);
        wrong(line, error.to_string())
    };
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(COMMENT)
        .from_reader(text.as_bytes());
    // Options are spelled with either line.
    let header = reader.headers().map_err(malformed)?;
    let header: StringRecord = header.iter().map(|name| name.replace('-', "_")).collect();
    let mut seen = HashSet::new();
    if let Some(column) = header.iter().find(|column| !seen.insert(*column)) {
        return Err(wrong(Some(1), format!("there are two columns `{column}`")));
    }
    for column in ["receptor", "ligand"] {
        if !seen.contains(column) {
            return Err(wrong(Some(1), format!("there is no column `{column}`")));
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
        let field = field.to_owned();
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

    fn read(text: &str) -> Result<Vec<PairRow>, PairTableError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pairs.csv");
        std::fs::write(&path, text).unwrap();
        read_pairs(&path, false)
    }

    #[test]
    fn columns_are_found_by_name_and_the_rest_are_options() {
        let rows = read(
            "ligand, receptor,attract_ligand,name,rotations\n# of March\n\n\"b.cif:A,B\",a.pdb,,first,\nd.pdb,c.pdb,A:5,,120\n",
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
        let expected = [option("attract_ligand", "A:5"), option("rotations", "120")];
        assert_eq!(rows[1].options, expected);
    }

    #[test]
    fn tables_that_are_none_are_refused_by_line() {
        for (text, line, said) in [
            ("", Some(1), "no column `receptor`"),
            ("receptor,name\na.pdb,x\n", Some(1), "no column `ligand`"),
            ("receptor,ligand,ligand\na,b,c\n", Some(1), "two columns"),
            ("receptor,ligand\n", None, "no pair"),
            ("receptor,ligand\na.pdb,b.pdb\nc.pdb\n", Some(3), "fields"),
            ("receptor,ligand\na.pdb,\n", Some(2), "no ligand"),
            ("receptor,ligand,symmetry\n,,C2\n", Some(2), "no receptor"),
            ("receptor,ligand,symmetry\na,,\n", Some(2), "no ligand"),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.line(), line, "{text}");
            assert!(error.to_string().contains(said), "{error}");
        }
        assert!(matches!(
            read_pairs(Path::new("nowhere.csv"), false),
            Err(PairTableError::Open { .. })
        ));
    }
}
