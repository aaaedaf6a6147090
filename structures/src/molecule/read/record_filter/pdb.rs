//! The record filter for PDB files: fixed columns, wwPDB format 3.3, "Coordinate Section".
//!
//! Columns in comments are 1-based, as in the format's description.

use std::borrow::Cow;
use std::path::Path;

use crate::molecule::chemistry::elements::NameColumn;
use crate::molecule::read::error::ReadError;
use crate::molecule::read::lines::lines;
use crate::molecule::read::policy::ModelChoice;
use crate::molecule::read::record_filter::assembly_remark::Remark;
use crate::molecule::read::record_filter::atom_line::is_atom;
use crate::molecule::read::record_filter::displaced::{Displaced, displaced, shifted};
use crate::molecule::read::record_filter::element_column::element;
use crate::molecule::read::record_filter::provenance::{Provenance, is_measured};
use crate::molecule::read::record_filter::record::{
    AtomRecord, COORDINATE, FilteredRecords, NO_ALTERNATE, SHOWN_NUMBERS, coordinate, field, number,
};
use crate::molecule::read::record_filter::residue_columns::{
    has_wide_chains, residue_and_chain, residue_number,
};
use crate::molecule::read::record_filter::segid::segid;

/// Record names that show a file to be PDB even where it holds no atom.
const RECORDS: [&str; 14] = [
    "HEADER", "TITLE", "COMPND", "SOURCE", "REMARK", "CRYST1", "SEQRES", "MODEL", "ENDMDL", "TER",
    "END", "CONECT", "MASTER", "EXPDTA",
];

/// Records that end a chain.
const ENDS: [&str; 4] = ["TER", "MODEL", "ENDMDL", "END"];

/// Sieves the text of a PDB file; of the models those that `model` takes.
pub(crate) fn filter(
    file: &Path,
    text: &str,
    model: ModelChoice,
) -> Result<FilteredRecords, ReadError> {
    let mut filtered = FilteredRecords::default();
    let mut models = Models::default();
    let mut assemblies = Remark::default();
    let wide_chains = has_wide_chains(text);
    // Whether any atom of the file has a chain, and the segids of those that are read.
    let (mut has_chains, mut segids) = (false, Vec::new());
    for (line, record) in lines(text) {
        if let Some(place) = AtomLine::of(record) {
            filtered.recognised = true;
            has_chains |= place.text().is_some_and(|text| !is_blank(chain(text)));
            let number = models.of(place.text().unwrap_or(record));
            if !model.takes(number) {
                filtered.ignore(number, place.text().and_then(position));
                continue;
            }
            let Some(text) = place.text() else {
                return Err(ReadError::MisplacedRecord {
                    file: file.to_path_buf(),
                    line,
                });
            };
            if matches!(place, AtomLine::Moved(_)) {
                filtered.displaced.push(line);
            }
            atom(file, line, text, wide_chains, number, &mut filtered)?;
            segids.push(segid(text));
        } else {
            let name = record_name(record);
            filtered.recognised |= RECORDS.contains(&name.as_ref());
            models.note(&name);
            if ENDS.contains(&name.as_ref()) && !filtered.records.is_empty() {
                filtered.chain_breaks.push(line);
            }
            assemblies.note(line, record);
            if name == "EXPDTA" && is_measured(record.get(10..).unwrap_or("")) {
                filtered.provenance = Provenance::NoConfidence;
            }
        }
    }
    filtered.models = models.count;
    filtered.assemblies = assemblies.assemblies();
    if !has_chains {
        for (record, segid) in filtered.records.iter_mut().zip(segids) {
            filtered.chains_from_segids += usize::from(!segid.is_empty());
            record.chain = segid;
        }
    }
    Ok(filtered)
}

/// The column of the chain.
fn chain(record: &str) -> &str {
    slice(record, 21, 22)
}

fn is_blank(columns: &str) -> bool {
    columns.trim().is_empty()
}

/// An atom's record, and where it stands.
enum AtomLine<'a> {
    /// In its columns, as far as can be seen.
    InPlace(&'a str),
    /// Moved to them.
    Moved(String),
    /// Anywhere.
    Lost,
}

impl<'a> AtomLine<'a> {
    /// The atom record of a line, if it holds one.
    fn of(line: &'a str) -> Option<Self> {
        if is_atom(line) {
            return Some(shifted(line).map_or(Self::InPlace(line), Self::Moved));
        }
        displaced(line).map(|found| match found {
            Displaced::Moved(record) => Self::Moved(record),
            Displaced::Lost => Self::Lost,
        })
    }

    fn text(&self) -> Option<&str> {
        match self {
            Self::InPlace(text) => Some(text),
            Self::Moved(text) => Some(text),
            Self::Lost => None,
        }
    }
}

/// The name of another record: the first word of its line. Programs that write atoms in small letters do so here, too.
fn record_name(record: &str) -> Cow<'_, str> {
    let name = record.split_ascii_whitespace().next().unwrap_or("");
    if name.bytes().any(|byte| byte.is_ascii_lowercase())
        && !name.bytes().any(|byte| byte.is_ascii_uppercase())
    {
        Cow::Owned(name.to_ascii_uppercase())
    } else {
        Cow::Borrowed(name)
    }
}

/// The coordinates of a record, where they can be read.
fn position(record: &str) -> Option<[f64; 3]> {
    let read = |from: usize| coordinate(record.get(from..from + 8)?);
    Some([read(30)?, read(38)?, read(46)?])
}

/// Distinguishes the models.
#[derive(Default)]
struct Models {
    /// Columns 13 to 27 of the first atom, and its segid if its chain is blank: what a second model starts with too.
    first: Option<(String, String)>,
    /// A MODEL, ENDMDL or END record stands since the last atom.
    boundary: Option<Boundary>,
    /// Models so far: the number of the one being read.
    count: usize,
}

enum Boundary {
    /// MODEL or ENDMDL: a new model follows.
    Model,
    /// END: a new model follows if it starts with the same atom (trajectories are written so), otherwise it is another
    /// part of the same structure (complexes are often put together so).
    End,
}

impl Models {
    fn note(&mut self, record_name: &str) {
        match record_name {
            "MODEL" | "ENDMDL" => self.boundary = Some(Boundary::Model),
            "END" if self.boundary.is_none() => self.boundary = Some(Boundary::End),
            _ => {}
        }
    }

    /// The number of the model that an atom record belongs to, from 1.
    fn of(&mut self, record: &str) -> usize {
        let identity = || {
            let columns = record.get(12..27).unwrap_or(record);
            let segid = Some(segid(record)).filter(|_| is_blank(chain(record)));
            (columns.to_owned(), segid.unwrap_or_default())
        };
        let boundary = self.boundary.take();
        let Some(first) = &self.first else {
            self.first = Some(identity());
            self.count = 1;
            return 1;
        };
        let starts_model = match boundary {
            Some(Boundary::Model) => true,
            Some(Boundary::End) => identity() == *first,
            None => false,
        };
        if starts_model {
            self.count += 1;
        }
        self.count
    }
}

/// Adds one atom record; `wide_chains` as of [`residue_and_chain`].
fn atom(
    file: &Path,
    line: usize,
    record: &str,
    wide_chains: bool,
    model: usize,
    filtered: &mut FilteredRecords,
) -> Result<(), ReadError> {
    check_columns(file, line, record)?;
    check_coordinates(file, line, record)?;
    let slice = |start: usize, end: usize| slice(record, start, end);

    let name = slice(12, 16);
    let (residue_name, chain) = residue_and_chain(slice(17, 22), wide_chains);
    let (residue_number, insertion) =
        residue_number(slice(22, 26), slice(26, 27)).ok_or_else(|| {
            field(
                file,
                line,
                "the residue number (columns 23-26)",
                slice(22, 27),
                "a whole number",
            )
        })?;
    let alternate = slice(16, 17).chars().next().filter(|c| *c != ' ');

    let atom = AtomRecord {
        line,
        model,
        chain: chain.to_string(),
        archive_chain: None,
        residue_name: residue_name.to_string(),
        residue_number,
        insertion_code: Some(insertion).filter(|code| *code != ' '),
        alternate_location: alternate,
        element: element(record).to_string(),
        name_column: if name.starts_with(' ') {
            NameColumn::Blank
        } else {
            NameColumn::Filled
        },
        exact: None,
    };
    write_line(record, filtered);
    filtered.records.push(atom);
    Ok(())
}

/// Columns from `start` to `end`, counted from 0, as far as the record has them.
fn slice(record: &str, start: usize, end: usize) -> &str {
    // ASCII up to column 66, so that slices up to there fall between characters; `get` guards the rest.
    record.get(start..end.min(record.len())).unwrap_or("")
}

/// The columns of the three coordinates.
fn positions(record: &str) -> [&str; 3] {
    [(30, 38), (38, 46), (46, 54)].map(|(start, end)| slice(record, start, end))
}

/// Refuses a record that is too short, or not ASCII.
fn check_columns(file: &Path, line: usize, record: &str) -> Result<(), ReadError> {
    if record.len() < 54 {
        return Err(ReadError::ShortRecord {
            file: file.to_path_buf(),
            line,
            length: record.len(),
        });
    }
    // The serial number in columns 7-11, perhaps from 5 on, is not used, and may hold anything.
    let columns = record.as_bytes().iter().take(66).skip(12);
    if let Some(odd) = columns.into_iter().find(|byte| !(32..127).contains(*byte)) {
        let text = format!("byte {odd:#04x}");
        return Err(field(
            file,
            line,
            "a character in columns 13-66",
            &text,
            "plain ASCII text",
        ));
    }
    Ok(())
}

/// Refuses coordinates that are no numbers, or run together.
fn check_coordinates(file: &Path, line: usize, record: &str) -> Result<(), ReadError> {
    let positions = positions(record);
    for ((axis, columns), text) in [("x", "31-38"), ("y", "39-46"), ("z", "47-54")]
        .into_iter()
        .zip(positions)
    {
        if coordinate(text).is_none() {
            let name = format!("coordinate {axis} (columns {columns})");
            return Err(field(file, line, name, text, COORDINATE));
        }
    }
    if let Some(text) = run_together(positions) {
        let name = "the coordinates (columns 31-54)";
        return Err(field(
            file,
            line,
            name,
            &text,
            "three numbers in columns of eight (larger ones need mmCIF)",
        ));
    }
    Ok(())
}

/// Writes the line of an atom that pdbtbx reads.
fn write_line(record: &str, filtered: &mut FilteredRecords) {
    let mut shown = |text: &str, default: &'static str, width: usize| -> String {
        let text = text.trim();
        if number(text).is_some() {
            format!("{text:>width$}")
        } else {
            filtered.defaults_filled += 1;
            format!("{default:>width$}")
        }
    };
    let occupancy = shown(slice(record, 54, 60), "1.00", 6);
    let b_factor = shown(slice(record, 60, 66), "0.00", 6);

    // pdbtbx adds 100,000 each time that the serial number comes back to 0 after 99,999.
    let serial = filtered.records.len() % 100_000;
    // Chain and residue are carried past pdbtbx, which for each atom goes through all chains and residues that it has.
    let shown_number = filtered.records.len() % SHOWN_NUMBERS;
    let name = slice(record, 12, 16);
    let [x, y, z] = positions(record);
    // The element travels past pdbtbx; carbon is what it finds fastest.
    filtered.text.push_str(&format!(
        "{:6}{serial:>5} {name}{NO_ALTERNATE}UNK A{shown_number:>4}    {x}{y}{z}{occupancy}{b_factor}{:10} C  \n",
        if record.starts_with("HETATM") {
            "HETATM"
        } else {
            "ATOM"
        },
        "",
    ));
}

/// Whether two coordinates run into one another, so that the columns no longer say where one ends.
///
/// Programs that print 1e6 Å with `%8.3f` shift the columns and leave numbers that parse but are wrong. In a sound
/// record a number may touch the one before only if that one has its three decimals.
fn run_together(positions: [&str; 3]) -> Option<String> {
    let touches = |left: &str, right: &str| {
        let decimals = left
            .trim()
            .split_once('.')
            .map_or(0, |(_, tail)| tail.len());
        left.ends_with(|c: char| c.is_ascii_digit() || c == '.')
            && right.starts_with(|c: char| c.is_ascii_digit() || c == '.')
            && (decimals != 3 || !right.contains('.'))
    };
    let [x, y, z] = positions;
    (touches(x, y) || touches(y, z)).then(|| positions.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifted_columns_are_distinguished_from_touching_ones() {
        assert_eq!(run_together(["1234.567", "1234.567", "-100.000"]), None);
        assert_eq!(run_together(["-100.123", "-200.456", "   1.000"]), None);
        // 1000000.000 three times, printed without a blank: parses as 1e6, 10000, 1e5.
        assert!(run_together(["1000000.", "00010000", "00.00010"]).is_some());
    }
}
