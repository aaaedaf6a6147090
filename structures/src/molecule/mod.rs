//! Molecules: atoms as read from PDB and mmCIF files, with what was kept, dropped and altered on the way.

use serde::Serialize;

/// File format of a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// The fixed-column wwPDB format, version 3.3.
    Pdb,
    /// PDBx/mmCIF.
    Mmcif,
}

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
    /// United-atom radius, in Å (see `radii`).
    pub radius: f64,
    /// 1-based line of the record in the (decompressed) file.
    pub line: usize,
}

/// A structure as docked: its kept atoms in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct Molecule {
    /// Kept atoms, in file order.
    pub atoms: Vec<Atom>,
    /// The format that the file had.
    pub format: Format,
}

impl Molecule {
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
