//! Rescoring: what a pose is worth beside its score, by terms that are too dear for all translations at once.
//!
//! A search ranks poses by a correlation, in which every term is one radial function times a class matrix of low rank. Of the few thousand
//! poses that it keeps, more can be asked. [`FineContacts`] asks which atoms meet at which distance: a potential of three
//! ranges over all pairs of the types of [`crate::effect::contact`], summed over the atoms themselves; it was learnt from interfaces. [`AtomPairs`] asks
//! the same of every atom of every residue by itself, in finer steps; so much cannot be learnt from interfaces, and comes from the insides
//! of proteins. [`Relaxation`] asks it once more, of the pose that the two bodies come to rest in when atoms must not overlap. [`Attraction`] counts
//! the residues that touch of those that are thought to, [`MissingContacts`] the atoms that lie where residues are missing, and
//! [`ChainEndContacts`] those near ends of chains that touch. [`Rescorer`] holds all of them.
//!
//! As everywhere a higher score is better, lengths are in Å, and positions are taken relative to the middles of the two bodies.

mod atom_pairs;
mod attraction;
mod bodies;
mod chain_ends;
mod contacts;
mod energy_table;
mod missing;
mod pair_potential;
mod potential;
mod relaxation;
mod rescorer;
mod side;

/// Edge in Å of the cells in which a body's atoms lie.
const CELL_EDGE: f64 = 4.0;

pub use atom_pairs::AtomPairs;
pub use attraction::{Attraction, Residues};
pub use chain_ends::ChainEndContacts;
pub use contacts::FineContacts;
pub use missing::MissingContacts;
pub use pair_potential::{AtomPairPotential, DISTANCES, STEP, atom_kinds};
pub use potential::{DistanceBinnedPotential, RANGES};
pub use relaxation::{Relaxation, Relaxed, Workspace};
pub use rescorer::{Rescored, Rescorer};
