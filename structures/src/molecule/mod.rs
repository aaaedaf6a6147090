//! Molecules: atoms as read from PDB and mmCIF files, with what was kept, dropped and altered on the way.
//!
//! # Conventions
//!
//! - Lengths are in Å, in the file's own frame.
//! - Chains, residue numbers and insertion codes are the author's (`auth_asym_id`, `auth_seq_id` and `pdbx_PDB_ins_code` in
//!   mmCIF).
//! - Hydrogens are dropped, and radii are united-atom radii, which stand for them, unless [`ReadOptions`] ask for them.
//! - Lines are counted from 1 in the unpacked text.
//!
//! # From file to molecule
//!
//! path -> `source` (open, unpack, tell the format) -> `sieve` (atoms of one model, in a form that pdbtbx is sure to
//! read; what it would lose is carried past) -> `parse` (pdbtbx, no panic past it) -> `assembly`, where one is asked for -> `select` (by `policy`: chains, waters, additives,
//! `elements`, `alternate` locations, `confidence` of predictions) -> `groups`, `radii`, `completeness` -> [`Molecule`] with its [`ReadReport`].

use serde::Serialize;

mod accessible;
mod additives;
mod alternate;
mod assembly;
mod buried;
mod chain_ends;
mod chains;
mod charge_table;
mod completeness;
mod confidence;
mod contact_types;
mod copies;
mod elements;
mod error;
mod foreign;
mod groups;
mod input;
mod labels;
mod ligands;
mod metal_sites;
mod missing;
mod models;
mod other_names;
mod overlap;
mod parse;
mod policy;
mod pseudo_atoms;
mod radii;
mod read;
mod report;
mod report_text;
mod residue_selection;
mod residues;
mod scope;
mod select;
mod sequence;
mod sieve;
mod source;
mod standard_names;
mod termini;
mod wanted;
mod write;

pub use accessible::PROBE;
pub use assembly::BuiltAssembly;
pub use chain_ends::ChainEnds;
pub use confidence::{Confidence, ConfidenceSource, LOW};
pub use contact_types::{CONTACT_TYPES, atom_kinds};
pub use copies::CopiesError;
pub use error::ReadError;
pub use groups::GroupKind;
pub use input::InputSpec;
pub use labels::{LabelReport, Labels};
pub use missing::MissingResidues;
pub use models::JoinedModels;
pub use policy::{
    AlternateLocation, Hetatm, Hydrogens, ModelChoice, PolicyError, ReadOptions, Waters,
};
pub use read::{Listed, read, read_bytes, read_bytes_listed, read_listed};
pub use report::{
    Altered, AlternateChoice, ChainCount, DropKind, Dropped, GroupCount, OtherName, ReadReport,
};
pub use residue_selection::{ResidueSelection, UnknownResidues};
pub use sequence::{PeptideChain, PeptideResidue, one_letter};
pub use source::file_bytes;
pub use standard_names::{plain_atom_name, plain_residue_name, standard_residue_name};
pub use write::{
    ChainMap, ChainName, Partner, WriteError, complex_format, fits, write_complex, write_molecule,
    write_renamed,
};

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
    /// United-atom radius, in Å (see `radii`); all-atom radius where hydrogens were kept.
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
    /// What reading the file did: kept, dropped, altered, warned of. Empty for a molecule made in memory.
    pub report: ReadReport,
    /// Lines at which the file itself ends a chain, rising: of TER, MODEL, ENDMDL and END records, and in mmCIF the first line
    /// of another `label_asym_id` under the same author's name. Atoms on both sides of such a line are of two chains even
    /// where their chain names are equal.
    pub chain_ends: Vec<usize>,
}

impl Atom {
    /// Whether this is hydrogen of any mass, which only molecules read with [`Hydrogens::Keep`] have.
    pub fn is_hydrogen(&self) -> bool {
        elements::is_hydrogen(&self.element)
    }
}

/// Square of the distance of two positions (Å²).
fn squared_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum()
}

impl Molecule {
    /// A molecule made in memory, with an empty report.
    pub fn new(atoms: Vec<Atom>, format: Format) -> Self {
        Self {
            atoms,
            format,
            report: ReadReport::default(),
            chain_ends: Vec::new(),
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
