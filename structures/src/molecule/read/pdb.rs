//! Reading of PDB files: fixed columns, wwPDB format 3.3, "Coordinate Section".

use crate::Error;
use crate::molecule::chemistry::NameColumn;
use crate::molecule::model::{Atom, count};
use crate::molecule::read::assembly::Remark350;
use crate::molecule::read::confidence::{Provenance, is_measured};
use crate::molecule::read::pdb_columns::{
    AtomLine, atom_line, columns, coordinates, element, has_wide_chains, residue_and_chain,
    residue_number, segid,
};
use crate::molecule::read::pdbtbx::{NO_ALTERNATE, SHOWN_NUMBERS};
use crate::molecule::read::source::lines;
use crate::molecule::read::{
    COORDINATE, FileContents, ModelChoice, Record, coordinate, field_error, number,
};

/// Record names that show a file to be PDB even where it holds no atom.
const RECORDS: [&str; 14] = [
    "HEADER", "TITLE", "COMPND", "SOURCE", "REMARK", "CRYST1", "SEQRES", "MODEL", "ENDMDL", "TER",
    "END", "CONECT", "MASTER", "EXPDTA",
];

const ENDS: [&str; 4] = ["TER", "MODEL", "ENDMDL", "END"];

/// Reads the text of a PDB file; of the models those that `model` takes.
pub(crate) fn read(text: &str, model: ModelChoice) -> Result<FileContents, Error> {
    let mut contents = FileContents::default();
    let mut models = Models::default();
    let mut assemblies = Remark350::default();
    let wide_chains = has_wide_chains(text);
    // Whether any atom of the file has a chain, and the segids of those that are read.
    let (mut has_chains, mut segids) = (false, Vec::new());
    // Lines of atom records that were moved to their columns.
    let mut moved = Vec::new();
    for (line, record) in lines(text) {
        if let Some(place) = atom_line(record) {
            contents.recognised = true;
            has_chains |= place.text().is_some_and(|text| !is_blank(chain(text)));
            let number = models.number_of(place.text().unwrap_or(record));
            if !model.takes(number) {
                contents.ignore(number, place.text().and_then(position));
                continue;
            }
            let text = place.text().ok_or_else(|| misplaced(line))?;
            moved.extend(matches!(place, AtomLine::Moved(_)).then_some(line));
            read_atom(line, text, wide_chains, number, &mut contents)?;
            segids.push(segid(text));
        } else {
            let name = record_name(record);
            contents.recognised |= RECORDS.contains(&name.as_str());
            models.note(&name);
            if ENDS.contains(&name.as_str()) && !contents.records.is_empty() {
                contents.chain_breaks.push(line);
            }
            assemblies.note(line, record);
            if name == "EXPDTA" && is_measured(record.get(10..).unwrap_or("")) {
                contents.provenance = Provenance::NoConfidence;
            }
        }
    }
    contents.models = models.count;
    contents.assemblies = assemblies.assemblies();
    if !has_chains {
        for (record, segid) in contents.records.iter_mut().zip(segids) {
            contents.report.altered.chains_from_segids += usize::from(!segid.is_empty());
            record.atom.chain = segid;
        }
    }
    if let Some(first) = moved.first() {
        contents.report.warnings.push(format!(
            "{} out of the columns of the format, the first at line {first}: moved and read",
            count(moved.len(), "atom record")
        ));
    }
    Ok(contents)
}

fn misplaced(line: usize) -> Error {
    let message =
        "the line holds an atom record that does not stand in the columns of the PDB format";
    Error::input(message).on_line(line as u64).help(
        "begin it with ATOM or HETATM in column 1, in capitals, with blanks and no tabs, and put x, y and z into \
         columns 31-38, 39-46 and 47-54",
    )
}

fn chain(record: &str) -> &str {
    columns(record, 21, 22)
}

fn is_blank(columns: &str) -> bool {
    columns.trim().is_empty()
}

/// The name of another record: the first word of its line. Programs that write atoms in small letters do so here, too.
fn record_name(record: &str) -> String {
    let name = record.split_ascii_whitespace().next().unwrap_or("");
    if name.bytes().any(|byte| byte.is_ascii_uppercase()) {
        name.to_owned()
    } else {
        name.to_ascii_uppercase()
    }
}

/// The coordinates of a record, where they can be read.
fn position(record: &str) -> Option<[f64; 3]> {
    let read = |from: usize| coordinate(record.get(from..from + 8)?);
    Some([read(30)?, read(38)?, read(46)?])
}

#[derive(Default)]
struct Models {
    /// Columns 13 to 27 of the first atom, and its segid if its chain is blank: what a second model starts with too.
    first: Option<(String, String)>,
    /// A MODEL, ENDMDL or END record since the last atom.
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
    fn number_of(&mut self, record: &str) -> usize {
        let identity = || {
            let columns = record.get(12..27).unwrap_or(record);
            let segid = Some(segid(record)).filter(|_| is_blank(chain(record)));
            (columns.to_owned(), segid.unwrap_or_default())
        };
        let starts_model = match (&self.first, self.boundary.take()) {
            (None, _) => {
                self.first = Some(identity());
                true
            }
            (_, Some(Boundary::Model)) => true,
            (Some(first), Some(Boundary::End)) => identity() == *first,
            (_, None) => false,
        };
        self.count += usize::from(starts_model);
        self.count
    }
}

/// Adds one atom record; `wide_chains` as of [`residue_and_chain`].
fn read_atom(
    line: usize,
    record: &str,
    wide_chains: bool,
    model: usize,
    contents: &mut FileContents,
) -> Result<(), Error> {
    check_columns(line, record)?;
    let (residue_name, chain) = residue_and_chain(record, wide_chains);
    let [number, code] = [columns(record, 22, 26), columns(record, 26, 27)];
    let (residue_number, code) = residue_number(number, code).ok_or_else(|| {
        let found = columns(record, 22, 27);
        field_error(
            line,
            "the residue number (columns 23-26)",
            found,
            "a whole number",
        )
    })?;
    let atom = Atom {
        line,
        chain: chain.to_owned(),
        residue_name: residue_name.to_owned(),
        residue_number,
        insertion_code: Some(code).filter(|code| *code != ' '),
        alternate_location: columns(record, 16, 17).chars().find(|c| *c != ' '),
        element: element(record).to_owned(),
        ..Atom::default()
    };
    write_repaired(record, contents);
    contents.records.push(Record {
        atom,
        model,
        archive_chain: None,
        name_column: match columns(record, 12, 13) {
            " " => NameColumn::Blank,
            _ => NameColumn::Filled,
        },
    });
    Ok(())
}

/// Refuses a record that is too short or not ASCII, and coordinates that are no numbers or run together.
fn check_columns(line: usize, record: &str) -> Result<(), Error> {
    if record.len() < 54 {
        let length = record.len();
        let message = format!(
            "the atom record ends after {length} characters, before its coordinates are complete"
        );
        return Err(Error::input(message).on_line(line as u64).help(
            "fetch the file again: it may be cut short; coordinates stand in columns 31 to 54",
        ));
    }
    // The serial number in columns 7-11, perhaps from 5 on, is not used, and may hold anything.
    let mut used = record.bytes().take(66).skip(12);
    if let Some(odd) = used.find(|byte| !(32..127).contains(byte)) {
        let (place, text) = ("a character in columns 13-66", format!("byte {odd:#04x}"));
        return Err(field_error(line, place, &text, "plain ASCII text"));
    }
    let coordinates = coordinates(record);
    for (axis, text) in [
        "x (columns 31-38)",
        "y (columns 39-46)",
        "z (columns 47-54)",
    ]
    .into_iter()
    .zip(coordinates)
    {
        if coordinate(text).is_none() {
            return Err(field_error(
                line,
                &format!("coordinate {axis}"),
                text,
                COORDINATE,
            ));
        }
    }
    if run_together(coordinates) {
        let expected = "three numbers in columns of eight (larger ones need mmCIF)";
        let place = "the coordinates (columns 31-54)";
        return Err(field_error(line, place, &coordinates.concat(), expected));
    }
    Ok(())
}

/// Writes the record that pdbtbx reads: the columns that it is sure to read, without those that it does not need.
///
/// For each atom it goes through all chains and residues that it has, so it sees few. Carbon is the element that it
/// finds fastest.
fn write_repaired(record: &str, contents: &mut FileContents) {
    let [occupancy, b_factor] =
        [(54, 60, "1.00"), (60, 66, "0.00")].map(|(start, end, default)| {
            let text = columns(record, start, end).trim();
            let is_number = number(text).is_some();
            contents.report.altered.defaults_filled += usize::from(!is_number);
            if is_number { text } else { default }
        });
    let kind = if record.starts_with("HETATM") {
        "HETATM"
    } else {
        "ATOM"
    };
    // pdbtbx adds 100,000 each time that the serial number comes back to 0 after 99,999.
    let serial = contents.records.len() % 100_000;
    let residue = contents.records.len() % SHOWN_NUMBERS;
    let (name, position) = (columns(record, 12, 16), columns(record, 30, 54));
    contents.text.push_str(&format!(
        "{kind:6}{serial:>5} {name}{NO_ALTERNATE}UNK A{residue:>4}    {position}{occupancy:>6}{b_factor:>6}{:10} C  \n",
        ""
    ));
}

/// Whether two coordinates run into one another, so that the columns no longer say where one ends.
///
/// Programs that print 1e6 Å with `%8.3f` shift the columns and leave numbers that parse but are wrong. In a sound
/// record a number may touch the one before only if that one has its three decimals.
fn run_together([x, y, z]: [&str; 3]) -> bool {
    let touches = |left: &str, right: &str| {
        let decimals = left
            .trim()
            .split_once('.')
            .map_or(0, |(_, tail)| tail.len());
        left.ends_with(|c: char| c.is_ascii_digit() || c == '.')
            && right.starts_with(|c: char| c.is_ascii_digit() || c == '.')
            && (decimals != 3 || !right.contains('.'))
    };
    touches(x, y) || touches(y, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifted_columns_are_distinguished_from_touching_ones() {
        assert!(!run_together(["1234.567", "1234.567", "-100.000"]));
        assert!(!run_together(["-100.123", "-200.456", "   1.000"]));
        // 1000000.000 three times, printed without a blank: parses as 1e6, 10000, 1e5.
        assert!(run_together(["1000000.", "00010000", "00.00010"]));
    }
}
