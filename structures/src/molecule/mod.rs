//! Molecules: atoms as read from PDB and mmCIF files, with what was kept, dropped and altered on the way.
//!
//! # Conventions
//!
//! - Lengths are in Å, in the file's own frame.
//! - Chains, residue numbers and insertion codes are the author's (`auth_asym_id`, `auth_seq_id` and
//!   `pdbx_PDB_ins_code` in mmCIF).
//! - Hydrogens are dropped, and radii are united-atom radii, which stand for them, unless [`ReadOptions`] ask for them.
//! - Lines are counted from 1 in the unpacked text.
//!
//! # Modules
//!
//! - `read`: from a file to atoms. `source` opens, unpacks and detects the format; `record_filter` passes the atoms of
//!   the wanted models in a form that pdbtbx is sure to read; `parse` calls pdbtbx. `assembly` builds an assembly where
//!   one is requested. `select` applies the `policy` on chains, waters, additives, alternate locations and confidence.
//!   The result is a [`Molecule`] with its [`ReadReport`].
//! - `model`: what a molecule is, and what follows from where its atoms stand: residues, chains, surface, unresolved
//!   segments.
//! - `chemistry`: tables of names, elements, radii, charges, contact types, chi angles and rotamers.
//! - `write`: molecules and complexes as PDB or mmCIF.

mod chemistry;
mod model;
mod read;
mod write;

pub use self::chemistry::atom_names::plain_atom_name;
pub use self::chemistry::contact_types::{CONTACT_TYPES, atom_kinds};
pub use self::chemistry::hydrogen_bonds::{HydrogenBonding, hydrogen_bonding};
pub use self::chemistry::labels::{LabelReport, Labels};
pub use self::chemistry::rotamers::{Rotamer, log_probability, rotamers};
pub use self::chemistry::standard_names::{plain_residue_name, standard_residue_name};
pub use self::model::accessible::{PROBE, spiral};
pub use self::model::atom::Atom;
pub use self::model::copies::CopiesError;
pub use self::model::format::Format;
pub use self::model::groups::GroupKind;
pub use self::model::held_side_chain::HeldSideChain;
pub use self::model::molecule::Molecule;
pub use self::model::report::{
    Altered, AlternateChoice, BuiltAssembly, ChainCount, Confidence, ConfidenceSource, DropKind,
    Dropped, GroupCount, JoinedModels, OtherName, ReadReport,
};
pub use self::model::residue_selection::{ResidueSelection, UnknownResidues};
pub use self::model::sequence::{PeptideChain, PeptideResidue, one_letter};
pub use self::model::side_chains::{SideChain, TurningBond};
pub use self::model::termini::Termini;
pub use self::model::unresolved::UnresolvedResidues;
pub use self::read::confidence::LOW;
pub use self::read::error::ReadError;
pub use self::read::input::InputSpec;
pub use self::read::policy::{
    AlternateLocation, Hetatm, Hydrogens, ModelChoice, PolicyError, ReadOptions, Waters,
};
pub use self::read::source::file_bytes;
pub use self::read::{
    AtomFate, model_count, read, read_bytes, read_bytes_with_fates, read_with_fates,
};
pub use self::write::error::WriteError;
pub use self::write::{
    ChainMap, ChainName, ModelWriter, Partner, complex_format, fits, write_complex, write_molecule,
    write_renamed,
};
