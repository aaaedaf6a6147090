//! Molecules: atoms as read from PDB and mmCIF files, with a report on atoms kept, dropped and altered.
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
//! - `model`: molecules, and quantities that follow from the places of atoms: residues, chains, surface, unresolved
//!   segments.
//! - `chemistry`: tables of names, elements, radii, charges, contact types, chi angles and rotamers.
//! - `write`: molecules and complexes as PDB or mmCIF.

mod chemistry;
mod model;
mod read;
mod write;

pub use self::chemistry::{
    CONTACT_TYPES, LabelReport, Labels, Rotamer, atom_kinds, log_probability, nucleotide_letter,
    one_letter, plain_atom_name, plain_residue_name, rotamers, standard_residue_name,
};
pub use self::model::{
    Altered, AlternateChoice, Atom, BuiltAssembly, ChainCount, Confidence, ConfidenceSource,
    DropKind, Dropped, Format, GroupCount, GroupKind, HeldSideChain, HydrogenBonding, InputSpec,
    JoinedModels, Molecule, OtherName, PROBE, PeptideChain, PeptideResidue, ReadReport,
    ResidueSelection, SideChain, Termini, TurningBond, UnknownResidues, UnresolvedResidues,
    hydrogen_bonding, spiral,
};
pub use self::read::{
    AlternateLocation, AtomFate, Hetatm, Hydrogens, LOW, ModelChoice, ReadOptions, Waters,
    file_bytes, model_count, read, read_bytes, read_bytes_with_fates, read_with_fates,
};
pub use self::write::{
    ChainMap, ChainName, ModelWriter, Partner, complex_format, fits, write_complex, write_molecule,
    write_renamed,
};
