//! Records of atoms that passed the record filter, and what belongs to them.

use std::path::Path;

use crate::molecule::chemistry::elements::NameColumn;
use crate::molecule::read::assemblies::Assemblies;
use crate::molecule::read::error::ReadError;
use crate::molecule::read::record_filter::provenance::Provenance;

/// Alternate location given to pdbtbx for atoms that have none, so that it does not copy them into other conformers.
pub(crate) const NO_ALTERNATE: char = '~';

/// How many different residue numbers pdbtbx is shown: few make it fast, and more than one keep residues small.
pub(crate) const SHOWN_NUMBERS: usize = 1000;

/// Data of one atom that bypass pdbtbx.
#[derive(Clone, Debug)]
pub(crate) struct AtomRecord {
    pub(crate) line: usize,
    /// Its model, counted from 1 in the order of the file.
    pub(crate) model: usize,
    pub(crate) chain: String,
    /// What the archive calls the chain (`label_asym_id`), where that is another name.
    pub(crate) archive_chain: Option<String>,
    pub(crate) residue_name: String,
    pub(crate) residue_number: i64,
    /// pdbtbx makes capitals of small letters.
    pub(crate) insertion_code: Option<char>,
    pub(crate) alternate_location: Option<char>,
    /// Element column, trimmed; may be empty or nonsense.
    pub(crate) element: String,
    pub(crate) name_column: NameColumn,
    /// Numbers that pdbtbx would not read exactly.
    pub(crate) exact: Option<Exact>,
}

/// The numbers of an mmCIF atom, read by the standard library.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exact {
    pub(crate) position: [f64; 3],
    pub(crate) occupancy: f64,
    pub(crate) b_factor: f64,
}

/// The atoms of the models that are read: text for pdbtbx, and what travels past it, by serial number.
#[derive(Debug, Default)]
pub(crate) struct FilteredRecords {
    /// Text that pdbtbx reads in the file's own format; atom i has the serial number i.
    pub(crate) text: String,
    /// What travels past it; index i belongs to the serial number i.
    pub(crate) records: Vec<AtomRecord>,
    /// Models in the file.
    pub(crate) models: usize,
    /// Atom records in the models that are not read.
    pub(crate) atoms_ignored: usize,
    /// Model and position (Å) of those among them whose coordinates can be read.
    pub(crate) ignored: Vec<(usize, [f64; 3])>,
    /// Lines of atom records that stood out of their columns and were moved.
    pub(crate) displaced: Vec<usize>,
    /// Blank or unreadable occupancies and temperature factors that were replaced by 1 and 0.
    pub(crate) defaults_filled: usize,
    /// Atoms that got their chain from the segid, since the file has no chains.
    pub(crate) chains_from_segids: usize,
    /// Lines at which the file itself ends a chain; see
    /// [`Molecule::chain_breaks`](crate::molecule::Molecule::chain_breaks).
    pub(crate) chain_breaks: Vec<usize>,
    /// Lines and names of further data blocks of an mmCIF file that have atoms, too.
    pub(crate) other_blocks: Vec<(usize, String)>,
    /// Whether a record or item of the format was seen at all.
    pub(crate) recognised: bool,
    /// What the file says of where its coordinates come from.
    pub(crate) provenance: Provenance,
    /// What the file says of its biological assemblies.
    pub(crate) assemblies: Assemblies,
}

impl FilteredRecords {
    /// Notes an atom of a model that is not read.
    pub(crate) fn ignore(&mut self, model: usize, position: Option<[f64; 3]>) {
        self.atoms_ignored += 1;
        self.ignored
            .extend(position.map(|position| (model, position)));
    }
}

/// An error in one field of one line.
pub(crate) fn field(
    file: &Path,
    line: usize,
    field: impl Into<String>,
    text: &str,
    expected: &'static str,
) -> ReadError {
    ReadError::Field {
        file: file.to_path_buf(),
        line,
        field: field.into(),
        text: text.trim().to_string(),
        expected,
    }
}

/// Largest magnitude of a coordinate of an atom, in Å: a metre. Sums and squares of such lengths stay finite, and no
/// molecule is that large or that far off.
const LARGEST_COORDINATE: f64 = 1e10;

/// What a coordinate must be, in words.
pub(crate) const COORDINATE: &str = "a finite number of at most 1e10 in magnitude (Å)";

/// A coordinate of an atom, in Å; nothing where no molecule can lie.
pub(crate) fn coordinate(text: &str) -> Option<f64> {
    number(text).filter(|value| value.abs() <= LARGEST_COORDINATE)
}

/// Whether an atom may lie at a position (Å).
pub(crate) fn is_place(position: [f64; 3]) -> bool {
    position.iter().all(|x| x.abs() <= LARGEST_COORDINATE)
}

/// A number, which must be finite.
pub(crate) fn number(text: &str) -> Option<f64> {
    text.trim()
        .parse::<f64>()
        .ok()
        .filter(|value| value.is_finite())
}
