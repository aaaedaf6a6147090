//! The sieve before pdbtbx: what it lets through, and what it carries past.
//!
//! pdbtbx 0.12 refuses or panics on much of what real files hold: free-form REMARK, short ATOM lines, odd charge columns,
//! old DBREF and SEQADV, dummy CRYST1, blank residue names, mmCIF values that a number or a quote breaks. Only the atoms
//! of the models that are wanted pass the sieve, each as a record in the form that pdbtbx is sure to read, numbered by its serial
//! number. Facts that pdbtbx would change travel beside it in a [`AtomRecord`] of the same index:
//!
//! | fact | what pdbtbx 0.12 does with it |
//! |---|---|
//! | line number, order | regroups atoms by chain, residue and conformer |
//! | blank chain name | invents `A`, `B`, ... |
//! | residue number | adds 10,000 after 9999, for all chains that follow; does not know hybrid-36 |
//! | residue name | cuts it to three letters (PDB), to upper case |
//! | alternate location | copies the atoms without one into every conformer |
//! | element | guesses calcium for CA when the column is blank |
//! | mmCIF decimals | off by an ulp, and wrong above 2^32 |

mod assembly_items;
mod assembly_remark;
mod atom_site;
mod displaced;
mod element_column;
pub(super) mod mmcif;
pub(super) mod pdb;
mod provenance;
mod residue_columns;
pub(super) mod tokens;

pub(super) use displaced::{Displaced, displaced};

use std::path::Path;

use super::assembly::Assemblies;
use super::confidence::Provenance;
use super::error::ReadError;

/// Alternate location given to pdbtbx for atoms that have none, so that it does not copy them into other conformers.
const NO_ALTERNATE: char = '~';

/// Where an atom's name stands in its PDB columns 13 to 16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NameColumn {
    /// Column 13 is blank: a one-letter element, where the file keeps to the wwPDB's alignment.
    Blank,
    /// Column 13 holds a character.
    Filled,
    /// The format has no columns.
    Unknown,
}

/// What travels past pdbtbx for one atom.
#[derive(Clone, Debug)]
pub(super) struct AtomRecord {
    pub(super) line: usize,
    /// Its model, counted from 1 in the order of the file.
    pub(super) model: usize,
    pub(super) chain: String,
    /// What the archive calls the chain (`label_asym_id`), where that is another name.
    pub(super) archive_chain: Option<String>,
    pub(super) residue_name: String,
    pub(super) residue_number: i64,
    /// pdbtbx makes capitals of small letters.
    pub(super) insertion_code: Option<char>,
    pub(super) alternate_location: Option<char>,
    /// Element column, trimmed; may be empty or nonsense.
    pub(super) element: String,
    pub(super) name_column: NameColumn,
    /// Numbers that pdbtbx would not read exactly.
    pub(super) exact: Option<Exact>,
}

/// The numbers of an mmCIF atom, read by the standard library.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exact {
    pub(super) position: [f64; 3],
    pub(super) occupancy: f64,
    pub(super) b_factor: f64,
}

/// The atoms of the models that are read: text for pdbtbx, and what travels past it, by serial number.
#[derive(Debug, Default)]
pub(super) struct Sieved {
    /// Text that pdbtbx reads in the file's own format; atom i has the serial number i.
    pub(super) text: String,
    /// What travels past it; index i belongs to the serial number i.
    pub(super) carried: Vec<AtomRecord>,
    /// Models in the file.
    pub(super) models: usize,
    /// Atom records in the models that are not read.
    pub(super) atoms_ignored: usize,
    /// Model and position (Å) of those among them whose coordinates can be read.
    pub(super) ignored: Vec<(usize, [f64; 3])>,
    /// Lines of atom records that stood out of their columns and were moved.
    pub(super) displaced: Vec<usize>,
    /// Blank or unreadable occupancies and temperature factors that were replaced by 1 and 0.
    pub(super) defaults_filled: usize,
    /// Lines at which the file itself ends a chain; see [`Molecule::chain_ends`](super::Molecule::chain_ends).
    pub(super) chain_ends: Vec<usize>,
    /// Lines and names of further data blocks of an mmCIF file that have atoms, too.
    pub(super) other_blocks: Vec<(usize, String)>,
    /// Whether a record or item of the format was seen at all.
    pub(super) recognised: bool,
    /// What the file says of where its coordinates come from.
    pub(super) provenance: Provenance,
    /// What the file says of its biological assemblies.
    pub(super) assemblies: Assemblies,
}

impl Sieved {
    /// Notes an atom of a model that is not read.
    fn ignore(&mut self, model: usize, position: Option<[f64; 3]>) {
        self.atoms_ignored += 1;
        self.ignored
            .extend(position.map(|position| (model, position)));
    }
}

/// An error in one field of one line.
fn field(
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

/// A coordinate, which must be a finite number.
fn coordinate(text: &str) -> Option<f64> {
    text.trim()
        .parse::<f64>()
        .ok()
        .filter(|value| value.is_finite())
}
