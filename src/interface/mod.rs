//! The interface of a complex: which residues touch, their hydrogen bonds and salt bridges, and their score.
//!
//! # Conventions
//!
//! - A complex is two molecules in place, side 0 and side 1. Lengths are in Å, areas in Å^2.
//! - **Contact**: two residues with heavy atoms nearer than 5 Å (Méndez et al., Proteins 52 (2003) 51-67). Their distance
//!   is that of the nearest heavy atoms.
//! - **Hydrogen bond**: a donor and an acceptor 2.2 to 3.5 Å apart (Baker & Hubbard, Prog. Biophys. Mol. Biol. 44 (1984)
//!   97-179), each on the side of the other that faces away from its bonded atoms. Files mostly lack hydrogens, so
//!   angles at them cannot be judged.
//! - **Salt bridge**: a nitrogen of a positive group within 4 Å of an oxygen of a negative one (Barlow & Thornton, J.
//!   Mol. Biol. 168 (1983) 867-885), at most one for two residues. Groups are side chains and phosphates that carry a
//!   charge in the electrostatic effect, and their atoms are those that share it: no bases, sugars, esters or termini.
//! - **Shape complementarity**: Sc of Lawrence & Colman (J. Mol. Biol. 234 (1993) 946-950).
//! - **Buried surface**: accessible area (probe of 1.4 Å) alone less that in the complex.

mod complementarity;
mod contacts;
mod score;
mod surface_dots;

pub use complementarity::shape_complementarity;
pub use contacts::{
    CONSENSUS, Contact, ContactFinder, ResidueShare, heavy_residues, residue_shares,
};
pub use score::{PlacedScore, score_in_place};

use knotdock_scoring::se3::Pose;
use knotdock_structures::knots::KnotsError;
use knotdock_structures::molecule::{Atom, Molecule};
use serde::Serialize;
use std::collections::BTreeSet;

use crate::pose_geometry::SURFACE_POINTS;
use crate::refine::clashes;

/// Largest distance of a contact, in Å.
pub const CONTACT: f64 = 5.0;
/// Largest distance between donor and acceptor of a hydrogen bond, in Å.
pub const HYDROGEN_BOND: f64 = 3.5;
/// Largest distance between the charged atoms of a salt bridge, in Å.
pub const SALT_BRIDGE: f64 = 4.0;
/// Distance in Å below which a donor and an acceptor overlap: the shortest hydrogen bonds have 2.2 Å (Jeffrey, An
/// Introduction to Hydrogen Bonding, 1997).
pub const CLASH: f64 = 2.2;
/// A residue as files name it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct ResidueName {
    /// Its chain, by the author's name.
    pub chain: String,
    /// Its number and insertion code, as `52A`.
    pub number: String,
    /// Its name, as `GLY`.
    pub name: String,
}

impl ResidueName {
    /// The name of an atom's residue.
    pub fn of(atom: &Atom) -> Self {
        let insertion = atom.insertion_code.map(String::from).unwrap_or_default();
        Self {
            chain: atom.chain.clone(),
            number: format!("{}{insertion}", atom.residue_number),
            name: atom.residue_name.clone(),
        }
    }
}

/// The interface of a complex.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Interface {
    /// Residues in contact, in the order of side 0, then of side 1.
    pub pairs: Vec<Contact<ResidueName>>,
    /// Residues of each side that have a contact.
    pub residues: [usize; 2],
    /// Hydrogen bonds.
    pub hydrogen_bonds: usize,
    /// Salt bridges.
    pub salt_bridges: usize,
    /// Pairs of heavy atoms that overlap by more than 0.5 Å, as [`crate::refine`] counts them.
    pub clashes: usize,
    /// Surface of each side that the other buries, in Å^2.
    pub buried: [f64; 2],
    /// Shape complementarity Sc, 1 for surfaces that match; `None` if nothing is buried but a rim.
    pub shape_complementarity: Option<f64>,
}

impl Interface {
    /// The interface of two molecules in place; charges are those at a pH.
    ///
    /// # Errors
    /// [`KnotsError`] for a molecule without atoms.
    pub fn of([first, second]: [&Molecule; 2], ph: f64) -> Result<Self, KnotsError> {
        let finder = ContactFinder::new([first, second], ph);
        let contacts = finder.contacts(&[Pose::identity()]);
        let touching = |side: usize| {
            let residues = contacts.iter().map(|contact| contact.residues[side]);
            residues.collect::<BTreeSet<usize>>().len()
        };
        let pair = |contact: &Contact| Contact {
            residues: [0, 1].map(|side| finder.residues()[side][contact.residues[side]].clone()),
            distance: contact.distance,
            hydrogen_bonds: contact.hydrogen_bonds,
            hydrogen_bond_distance: contact.hydrogen_bond_distance,
            salt_bridge: contact.salt_bridge,
        };
        let (clashes, (buried, shape_complementarity)) = rayon::join(
            || clashes([first, second], ph),
            || {
                rayon::join(
                    || first.buried_areas(second, SURFACE_POINTS),
                    || shape_complementarity([first, second]),
                )
            },
        );
        Ok(Self {
            residues: [touching(0), touching(1)],
            hydrogen_bonds: contacts.iter().map(|contact| contact.hydrogen_bonds).sum(),
            salt_bridges: contacts
                .iter()
                .filter(|contact| contact.salt_bridge)
                .count(),
            clashes: clashes?,
            buried,
            shape_complementarity,
            pairs: contacts.iter().map(pair).collect(),
        })
    }
}

#[cfg(test)]
mod tests;
