//! Rescoring of one docking: the inputs and weights of its pose terms.

use crate::options::DockOptions;
use crate::priors::active_residues::ActiveResidues;
use crate::priors::flexible_regions::FlexibleRegions;
use crate::priors::restrained::Restrained;
use crate::priors::{self, SiteRole};
use knotdock_scoring::terms::pose::{
    DistanceRestraints, POSE_TERMS, Rescorer, TermDefinition, TermInputs,
};
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;
use knotdock_structures::molecule::{Labels, Molecule, Termini, UnresolvedResidues};
use serde::Serialize;

/// A pose term that acts in a docking, with its weight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ActingTerm {
    /// Id of the term: its column in `poses.csv`.
    pub id: &'static str,
    /// Its weight.
    pub weight: f64,
    /// Unit of the weight.
    pub unit: &'static str,
}

/// Inputs and weights of the pose terms between two bodies.
pub struct Rescoring<'a> {
    inputs: TermInputs<'a>,
    weights: [f64; POSE_TERMS.len()],
}

impl<'a> Rescoring<'a> {
    /// The inputs that two labelled bodies and the priors provide, with the weights of the options.
    ///
    /// Active residues have their own weight, which depends on the prior that names them.
    pub fn new(
        bodies: [&'a Knots; 2],
        (active, restrained): (&'a ActiveResidues, &'a Restrained),
        regions: &'a FlexibleRegions,
        options: &'a DockOptions,
    ) -> Self {
        Self {
            inputs: TermInputs {
                bodies,
                fine_contact_potential: options.terms.fine_contact_potential.as_ref(),
                atom_pair_potential: options.terms.atom_pair_potential.as_ref(),
                active_residues: &active.sets,
                unresolved: regions.unresolved.each_ref().map(|side| &side.segments[..]),
                termini: regions.termini.each_ref().map(|side| &side.atoms[..]),
                distance_restraints: &restrained.distances,
                membrane: restrained.membrane.as_ref(),
                predicted: restrained.predicted.each_ref().map(Vec::as_slice),
            },
            weights: std::array::from_fn(|index| match POSE_TERMS[index].id {
                "active_residues" => active.weight,
                id => options.terms.weight(id).unwrap_or(0.0),
            }),
        }
    }

    /// The terms prepared for scoring poses; `None` if no term acts.
    pub fn rescorer(&self) -> Option<Rescorer> {
        Rescorer::new(&self.inputs, &self.weights)
    }

    /// The definitions of the terms that act, with their weights, in the order of the registry.
    fn acting_definitions(&self) -> impl Iterator<Item = (&'static TermDefinition, f64)> {
        let terms = POSE_TERMS.iter().zip(self.weights);
        terms.filter(|(term, weight)| term.acts(&self.inputs, *weight))
    }

    /// The terms that act.
    pub fn acting(&self) -> Vec<ActingTerm> {
        let acting = self.acting_definitions().map(|(term, weight)| ActingTerm {
            id: term.id,
            weight,
            unit: term.unit,
        });
        acting.collect()
    }

    /// Time to rescore a pose, as a share of the time with every term; 0 if no term acts.
    pub fn time_share(&self) -> f64 {
        let shares = self.acting_definitions().map(|(term, _)| term.time_share);
        shares.fold(0.0, f64::max)
    }
}

/// Each pose term with the number of parts that it reads of a molecule, in the order of the registry.
///
/// Active residues are those of the sites that priors favour.
pub fn term_counts(
    molecule: &Molecule,
    labels: &Labels,
    unresolved: &UnresolvedResidues,
    termini: &Termini,
) -> Result<Vec<(&'static TermDefinition, usize)>, KnotsError> {
    let knots = molecule.knots()?;
    let knots = knots.with_labels(Vec::new(), labels.contact_types.clone())?;
    let knots = knots.with_atom_kinds(labels.atom_kinds.clone())?;
    let sites = priors::sites(molecule).into_iter();
    let favoured = sites.filter(|site| site.role == SiteRole::Favoured);
    let active: Vec<_> = favoured.map(|site| [site.residues, Vec::new()]).collect();
    let inputs = TermInputs {
        bodies: [&knots, &knots],
        fine_contact_potential: None,
        atom_pair_potential: None,
        active_residues: &active,
        unresolved: [&unresolved.segments, &[]],
        termini: [&termini.atoms, &[]],
        distance_restraints: DistanceRestraints::none(),
        predicted: [&[], &[]],
        membrane: None,
    };
    let count = |term: &'static TermDefinition| {
        let [count, _] = (term.count)(&inputs);
        (term, count)
    };
    // Terms that read what only options give have no part of a molecule.
    let of_molecules = POSE_TERMS.iter().filter(|term| term.is_shown_always);
    Ok(of_molecules.map(count).collect())
}
