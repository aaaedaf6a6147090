//! What poses are rescored by: the terms that the scene's effects make possible and whose weights ask for them.

use super::active_residues::ActiveResidues;
use super::effects::Decision;
use super::loose::Loose;
use super::options::DockOptions;
use knotdock_scoring::effect::Effect;
use knotdock_scoring::rescoring::{
    AtomPairs, Attraction, ChainEndContacts, FineContacts, MissingContacts, Relaxation, Rescorer,
};
use knotdock_structures::Knots;

/// Weights of the terms that poses are rescored by; 0 for those that are not asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Asked {
    fine_contact: f64,
    atom_pair: f64,
    relaxed: f64,
    attraction: f64,
    missing: f64,
    chain_ends: f64,
}

impl Asked {
    /// Potentials where the contact effect is on, what should be touched where there is something, and what is loose where anything is.
    pub fn of(
        decisions: &[Decision],
        attracted: &ActiveResidues,
        loose: &Loose,
        options: &DockOptions,
    ) -> Self {
        let contact = |decision: &Decision| decision.effect == Effect::Contact && decision.on;
        let typed = decisions.iter().any(contact);
        let when = |asked: bool, weight: f64| if asked { weight } else { 0.0 };
        Self {
            fine_contact: when(typed, options.fine_contact_weight),
            atom_pair: when(typed, options.atom_pair_weight),
            relaxed: when(typed, options.relaxed_weight),
            attraction: when(attracted.any(), attracted.weight),
            missing: when(loose.any_missing(), options.unresolved_weight),
            chain_ends: when(loose.any_ends(), options.termini_weight),
        }
    }

    /// Whether poses give way, which is most of what rescoring costs.
    pub fn relaxes(&self) -> bool {
        self.relaxed > 0.0
    }

    /// Whether anything is asked.
    pub fn any(&self) -> bool {
        let stands = [
            self.fine_contact,
            self.atom_pair,
            self.attraction,
            self.missing,
            self.chain_ends,
        ];
        stands.into_iter().any(|weight| weight > 0.0) || self.relaxes()
    }

    /// The terms of two labelled bodies; `None` where nothing is asked.
    pub fn rescorer(
        &self,
        [receptor, ligand]: [&Knots; 2],
        attracted: &ActiveResidues,
        loose: &Loose,
        options: &DockOptions,
    ) -> Option<Rescorer> {
        let asked = |weight: f64| (weight > 0.0).then_some(weight);
        let pair_potential = || options.atom_pair_potential.clone().unwrap_or_default();
        self.any().then(|| Rescorer {
            fine_contacts: asked(self.fine_contact).map(|weight| {
                let potential = options.fine_contact_potential.clone().unwrap_or_default();
                FineContacts::new(receptor, ligand, &potential, weight)
            }),
            atom_pairs: asked(self.atom_pair)
                .map(|weight| AtomPairs::new(receptor, ligand, &pair_potential(), weight)),
            relaxation: asked(self.relaxed)
                .map(|weight| Relaxation::new(receptor, ligand, &pair_potential(), weight)),
            attraction: asked(self.attraction)
                .map(|weight| Attraction::new(receptor, ligand, &attracted.sets, weight)),
            missing: asked(self.missing).map(|weight| {
                let missing = loose.missing_residues.each_ref();
                let stretches = missing.map(|side| side.segments.as_slice());
                MissingContacts::new(receptor, ligand, stretches, weight)
            }),
            chain_ends: asked(self.chain_ends).map(|weight| {
                let ends = loose.chain_end_residues.each_ref();
                let ends = ends.map(|side| side.atoms.as_slice());
                ChainEndContacts::new(receptor, ligand, ends, weight)
            }),
        })
    }
}
