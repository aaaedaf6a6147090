//! Data of a molecule: atoms, residues, chains, and quantities that follow from their places.

mod chains;
mod copies;
mod groups;
mod molecule;
mod polar_atoms;
mod report;
mod residue_selection;
mod sequence;
mod side_chains;
mod surface;
mod unresolved;

pub use self::chains::Termini;
pub use self::groups::GroupKind;
pub use self::molecule::{Atom, Format, Molecule};
pub use self::polar_atoms::{HydrogenBonding, hydrogen_bonding};
pub use self::report::{
    Altered, AlternateChoice, BuiltAssembly, ChainCount, Confidence, ConfidenceSource, DropKind,
    Dropped, GroupCount, InputSpec, JoinedModels, OtherName, ReadReport,
};
pub use self::residue_selection::{ResidueSelection, UnknownResidues};
pub use self::sequence::{PeptideChain, PeptideResidue};
pub use self::side_chains::{HeldSideChain, SideChain, TurningBond};
pub use self::surface::{PROBE, spiral};
pub use self::unresolved::UnresolvedResidues;

pub(crate) use self::chains::{Chain, CutEnd, Gap, MAX_CAP_LENGTH, cut_ends};
pub(crate) use self::groups::{
    Place, Residue, ResidueKey, number_text, residue_key, residue_runs, residues,
};
pub(crate) use self::molecule::{agreeing, count, examples, show_chain};
pub(crate) use self::residue_selection::Picked;
