//! A structure as docked: its atoms, the format it came in, and the report on reading it.

use serde::Serialize;

use crate::molecule::chemistry::{is_hydrogen, is_metal};
use crate::molecule::model::ReadReport;

/// File format of a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// The fixed-column wwPDB format, version 3.3.
    Pdb,
    /// PDBx/mmCIF.
    Mmcif,
}

impl Format {
    /// The usual file name extension, without a dot.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Pdb => "pdb",
            Self::Mmcif => "cif",
        }
    }
}

/// One atom as kept from a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Atom {
    /// Atom name without padding, e.g. `CA`.
    pub name: String,
    /// Residue name, e.g. `ALA`.
    pub residue_name: String,
    /// Author chain name; may be empty in PDB files.
    pub chain: String,
    /// Author residue number.
    pub residue_number: i64,
    /// Insertion code, if any.
    pub insertion_code: Option<char>,
    /// Alternate location that was chosen, if the file names one.
    pub alternate_location: Option<char>,
    /// Element symbol as in the periodic table, e.g. `C`, `Zn`.
    pub element: String,
    /// Coordinates in the file's frame, in Å.
    pub position: [f64; 3],
    /// Occupancy, 0 to 1.
    pub occupancy: f64,
    /// Temperature factor, in Å^2.
    pub b_factor: f64,
    /// Whether the file's record is HETATM.
    pub hetero: bool,
    /// United-atom radius, in Å (see `radii`); all-atom radius where hydrogens were kept.
    pub radius: f64,
    /// 1-based line of the record in the (decompressed) file.
    pub line: usize,
}

impl Atom {
    /// Whether this is hydrogen of any mass, which only molecules read with
    /// [`Hydrogens::Keep`](crate::molecule::Hydrogens::Keep) have.
    pub fn is_hydrogen(&self) -> bool {
        is_hydrogen(&self.element)
    }

    /// Whether this is a metal, whose bonds are longer than others and coordinate.
    pub fn is_metal(&self) -> bool {
        is_metal(&self.element)
    }
}

/// A structure as docked: its kept atoms in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct Molecule {
    /// Kept atoms, in file order.
    pub atoms: Vec<Atom>,
    /// The format that the file had.
    pub format: Format,
    /// Report on reading the file: what was kept, dropped and altered, and the warnings. Empty for a molecule made in
    /// memory.
    pub report: ReadReport,
    /// Lines at which the file itself ends a chain, rising: of TER, MODEL, ENDMDL and END records, and in mmCIF the
    /// first line of another `label_asym_id` under the same author's name. Atoms on both sides of such a line are of
    /// two chains even where their chain names are equal.
    pub chain_breaks: Vec<usize>,
}

impl Molecule {
    /// A molecule made in memory, with an empty report.
    pub fn new(atoms: Vec<Atom>, format: Format) -> Self {
        Self {
            atoms,
            format,
            report: ReadReport::default(),
            chain_breaks: Vec::new(),
        }
    }

    /// The molecule with every position x (Å) moved to `map(x)`, e.g. a ligand placed by a pose.
    #[must_use]
    pub fn map_positions(&self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let mut moved = self.clone();
        for atom in &mut moved.atoms {
            atom.position = map(atom.position);
        }
        moved
    }

    /// The atoms as knots of unit weight and united-atom radius, in the file's frame (Å).
    ///
    /// # Errors
    /// [`crate::knots::KnotsError`] when there is no atom or a number is not usable.
    pub fn knots(&self) -> Result<crate::Knots, crate::knots::KnotsError> {
        crate::Knots::new(
            self.atoms.iter().map(|atom| atom.position).collect(),
            self.atoms.iter().map(|atom| atom.radius).collect(),
        )
    }
}

/// `1 atom`, `2 atoms`.
pub(crate) fn count(number: usize, what: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {what}{plural}")
}

/// A chain's name as shown: `_` for the blank one.
pub(crate) fn show_chain(name: &str) -> &str {
    if name.is_empty() { "_" } else { name }
}

/// A count with words for one and for more: `1 atom repeats`, `2 atoms repeat`.
pub(crate) fn agreeing(number: usize, one: &str, several: &str) -> String {
    let words = if number == 1 { one } else { several };
    format!("{number} {words}")
}

/// The first few of a list, and dots for the rest.
pub(crate) fn examples<T: AsRef<str>>(items: &[T], shown: usize) -> String {
    let first: Vec<&str> = items.iter().take(shown).map(AsRef::as_ref).collect();
    let more = if items.len() > shown { ", ..." } else { "" };
    first.join(", ") + more
}
