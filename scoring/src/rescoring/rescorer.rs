//! All that poses are rescored with.

use super::{
    AtomPairs, Attraction, ChainEndContacts, FineContacts, MissingContacts, Relaxation, Workspace,
};
use crate::se3::Pose;

/// Terms that are asked of a pose beside its score.
pub struct Rescorer {
    /// Contacts by range of distance.
    pub fine_contacts: Option<FineContacts>,
    /// The atom pair potential.
    pub atom_pairs: Option<AtomPairs>,
    /// The same with atoms that must not overlap, where the pose comes to rest.
    pub relaxation: Option<Relaxation>,
    /// Residues that should be in contact.
    pub attraction: Option<Attraction>,
    /// Residues that are missing where the other side may not be.
    pub missing: Option<MissingContacts>,
    /// Residues near ends of chains, which should not be in contact.
    pub chain_ends: Option<ChainEndContacts>,
}

/// What they say of a pose, weighted; higher is better. `None` where the term is left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rescored {
    /// Fine contacts.
    pub fine_contact: Option<f64>,
    /// The atom pair potential.
    pub atom_pair: Option<f64>,
    /// What the pose is worth once relaxed.
    pub relaxed: Option<f64>,
    /// The residues that touch of those that should.
    pub attraction: Option<f64>,
    /// The atoms that lie where residues are missing.
    pub missing: Option<f64>,
    /// The atoms near ends of chains that touch.
    pub chain_ends: Option<f64>,
}

impl Rescorer {
    /// What is added to a pose's score.
    pub fn score(&self, pose: &Pose, workspace: &mut Workspace) -> Rescored {
        Rescored {
            fine_contact: self.fine_contacts.as_ref().map(|terms| terms.score(pose)),
            atom_pair: self.atom_pairs.as_ref().map(|terms| terms.score(pose)),
            relaxed: self
                .relaxation
                .as_ref()
                .map(|relaxation| relaxation.score(pose, workspace)),
            attraction: self.attraction.as_ref().map(|terms| terms.score(pose)),
            missing: self.missing.as_ref().map(|terms| terms.score(pose)),
            chain_ends: self.chain_ends.as_ref().map(|terms| terms.score(pose)),
        }
    }
}

impl Rescored {
    /// All terms together.
    pub fn sum(&self) -> f64 {
        self.fine_contact.unwrap_or(0.0)
            + self.atom_pair.unwrap_or(0.0)
            + self.relaxed.unwrap_or(0.0)
            + self.attraction.unwrap_or(0.0)
            + self.missing.unwrap_or(0.0)
            + self.chain_ends.unwrap_or(0.0)
    }
}
