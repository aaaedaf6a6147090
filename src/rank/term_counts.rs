//! Numbers of a molecule's parts that each pose term reads.

use crate::priors::{self, SiteRole};
use knotdock_scoring::terms::pose::{DistanceRestraints, POSE_TERMS, TermDefinition, TermInputs};
use knotdock_structures::knots::KnotsError;
use knotdock_structures::molecule::{Labels, Molecule, Termini, UnresolvedResidues};

/// Each pose term with the number of parts that it reads of a molecule, in the order of the registry.
///
/// Active residues are those of the sites that priors favour.
///
/// # Errors
/// [`KnotsError`] on a molecule without atoms.
pub fn of(
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
