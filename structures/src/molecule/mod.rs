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
//! - `read`: from a file to atoms. `source` opens, unpacks and detects the format; `pdb` and `mmcif` repair the atoms of
//!   the wanted models and keep what `pdbtbx` would lose. `assembly` builds an assembly on request. `select` applies the
//!   `policy` on chains, waters, additives, alternate locations and confidence. The result is a [`Molecule`] with its
//!   [`ReadReport`].
//! - `model`: what a molecule is, and what follows from the places of its atoms: residues, chains, surface, unresolved
//!   segments.
//! - `chemistry`: tables of names, elements, radii, charges, contact types, chi angles and rotamers.
//! - `write`: molecules and complexes as PDB or mmCIF.

mod chemistry;
mod model;
mod read;
mod write;

pub use self::chemistry::labels::{LabelReport, Labels};
pub use self::chemistry::names::plain_atom_name;
pub use self::chemistry::names::{plain_residue_name, standard_residue_name};
pub use self::chemistry::residues::{CONTACT_TYPES, atom_kinds, one_letter};
pub use self::chemistry::rotamers::{Rotamer, log_probability, rotamers};
pub use self::model::chains::Termini;
pub use self::model::groups::GroupKind;
pub use self::model::molecule::Atom;
pub use self::model::molecule::Format;
pub use self::model::molecule::Molecule;
pub use self::model::polar_atoms::{HydrogenBonding, hydrogen_bonding};
pub use self::model::report::{
    Altered, AlternateChoice, BuiltAssembly, ChainCount, Confidence, ConfidenceSource, DropKind,
    Dropped, GroupCount, JoinedModels, OtherName, ReadReport,
};
pub use self::model::residue_selection::{ResidueSelection, UnknownResidues};
pub use self::model::sequence::{PeptideChain, PeptideResidue};
pub use self::model::side_chains::HeldSideChain;
pub use self::model::side_chains::{SideChain, TurningBond};
pub use self::model::surface::{PROBE, spiral};
pub use self::model::unresolved::UnresolvedResidues;
pub use self::read::confidence::LOW;
pub use self::read::input::InputSpec;
pub use self::read::policy::{
    AlternateLocation, Hetatm, Hydrogens, ModelChoice, ReadOptions, Waters,
};
pub use self::read::source::file_bytes;
pub use self::read::{
    AtomFate, model_count, read, read_bytes, read_bytes_with_fates, read_with_fates,
};
pub use self::write::{
    ChainMap, ChainName, ModelWriter, Partner, complex_format, fits, write_complex, write_molecule,
    write_renamed,
};
