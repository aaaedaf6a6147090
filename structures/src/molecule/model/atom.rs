//! Atoms as kept from a file.

use serde::Serialize;

use crate::molecule::chemistry::elements;

/// One atom as kept from a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
        elements::is_hydrogen(&self.element)
    }
}

/// Square of the distance of two positions (Å²).
pub(crate) fn squared_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum()
}
