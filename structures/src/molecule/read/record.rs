//! Atoms as a file has them, and the file's other statements.

use crate::Error;
use crate::molecule::chemistry::NameColumn;
use crate::molecule::model::{Atom, DropKind, ReadReport};
use crate::molecule::read::assembly::Assemblies;
use crate::molecule::read::confidence::Provenance;

#[derive(Clone, Debug)]
pub(crate) struct Record {
    /// The atom. Its element is the text of the element column, which may be empty or nonsense; its radius is 0.
    pub(crate) atom: Atom,
    /// Its model, counted from 1 in the order of the file.
    pub(crate) model: usize,
    /// What the archive calls the chain (`label_asym_id`), if that is another name.
    pub(crate) archive_chain: Option<String>,
    pub(crate) name_column: NameColumn,
}

/// The atoms of the models that are read, and the file's other statements.
#[derive(Debug, Default)]
pub(crate) struct FileContents {
    /// Text that pdbtbx reads in the file's own format; atom i has the serial number i.
    pub(crate) text: String,
    /// The atoms by their serial number. pdbtbx adds what it reads.
    pub(crate) records: Vec<Record>,
    pub(crate) models: usize,
    /// Model and position (Å) of the atoms of other models whose coordinates can be read.
    pub(crate) ignored: Vec<(usize, [f64; 3])>,
    /// Lines at which the file itself ends a chain; see
    /// [`Molecule::chain_breaks`](crate::molecule::Molecule::chain_breaks).
    pub(crate) chain_breaks: Vec<usize>,
    /// Whether a record or item of the format was seen at all.
    pub(crate) recognised: bool,
    pub(crate) provenance: Provenance,
    pub(crate) assemblies: Assemblies,
    pub(crate) report: ReadReport,
}

impl FileContents {
    pub(crate) fn ignore(&mut self, model: usize, position: Option<[f64; 3]>) {
        self.report.drop_atoms(DropKind::Model, "", 1);
        let position = position.map(|position| (model, position));
        self.ignored.extend(position);
    }

    /// A number, or a default that is counted as filled in.
    pub(crate) fn or_default(&mut self, number: Option<f64>, default: f64) -> f64 {
        self.report.altered.defaults_filled += usize::from(number.is_none());
        number.unwrap_or(default)
    }
}

pub(crate) fn field_error(line: usize, field: &str, text: &str, expected: &str) -> Error {
    let text = text.trim();
    Error::input(format!("{field} is '{text}' where {expected} is needed"))
        .on_line(line as u64)
        .help("correct the record, or remove the atom")
}

/// Largest magnitude of a coordinate of an atom, in Å: a metre. Sums and squares of such lengths stay finite, and no
/// molecule is that large or that far off.
const LARGEST_COORDINATE: f64 = 1e10;

pub(crate) const COORDINATE: &str = "a finite number of at most 1e10 in magnitude (Å)";

/// A coordinate of an atom, in Å; nothing where no molecule can be.
pub(crate) fn coordinate(text: &str) -> Option<f64> {
    number(text).filter(|value| value.abs() <= LARGEST_COORDINATE)
}

/// Whether an atom may be at a position (Å).
pub(crate) fn is_place(position: [f64; 3]) -> bool {
    position.iter().all(|x| x.abs() <= LARGEST_COORDINATE)
}

/// A number, which must be finite.
pub(crate) fn number(text: &str) -> Option<f64> {
    let value = text.trim().parse::<f64>().ok();
    value.filter(|value| value.is_finite())
}
