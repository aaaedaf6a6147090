//! Weights and tables of the terms of the score.

use std::path::Path;

use knotdock_scoring::terms::effect::contact::Potential;
use knotdock_scoring::terms::pose::{AtomPairPotential, DistanceBinnedPotential};
use knotdock_structures::Error;

use super::definition::{Content, Optional, options};
use super::values::Range;
use crate::bounded_read::{MAX_TABLE, read_bounded_text};

/// Weights of a term.
const WEIGHT: Range = Range::between(0.0, 1e6);

options! {
    /// Weights and tables of the terms of the score. The defaults of the weights were chosen on training pairs.
    TermOptions as terms, "Terms", Molecules {
        /// Weight in shape of atoms that no water reaches, against 1 for the others.
        core_weight: f64 = 1.0, "NUMBER", Range::between(0.0, 1e3), in files;
        /// Weight of the electrostatic energy: score per kcal/mol.
        electrostatics_weight: f64 = 24.0, "NUMBER", WEIGHT, in files;
        /// Weight of the contact potential: score per RT.
        contact_weight: f64 = 2.0, "NUMBER", WEIGHT, in files;
        /// Cost of a contact of a blocked atom: score.
        restraint_weight: f64 = 1.0, "NUMBER", WEIGHT, in files;
        /// Weight of the fine contact potential, which scores poses where the contact effect is on: score per RT; 0
        /// leaves the term out.
        fine_contact_weight: f64 = 2.0, "NUMBER", WEIGHT, in files;
        /// Weight of the atom pair potential, which scores poses where the contact effect is on: score per RT; 0
        /// leaves the term out.
        atom_pair_weight: f64 = 1.0, "NUMBER", WEIGHT, in files;
        /// Weight of the atom pair potential with a penalty on overlap, after a rigid move of at most 2 Å; it scores
        /// poses where the contact effect is on: score per RT; 0 leaves the term out.
        relaxed_weight: f64 = 3.0, "NUMBER", WEIGHT, in files;
        /// Score of a pose in which all active residues are in contact; other poses get their share of it: score; 0
        /// leaves the term out.
        active_weight: f64 = 2000.0, "NUMBER", WEIGHT, in files;
        /// Cost of an atom where unresolved residues of the other side are, in gaps of a chain or past its termini,
        /// times the share of their conformers there: score; 0 leaves the term out.
        unresolved_weight: f64 = 3.0, "NUMBER", WEIGHT, in files;
        /// Cost of an atom near a terminus of its chain, or near a gap in it, that is in contact with the other
        /// side: score; 0 leaves the term out.
        termini_weight: f64 = 2.0, "NUMBER", WEIGHT, in files;
        /// Cost of each Å by which a pose violates the distance restraints: score per Å; 0 leaves the term out.
        violation_weight: f64 = 400.0, "NUMBER", WEIGHT, in files;
        /// Score of a residue in contact for each nat by which its log-odds to be in the interface exceed those of
        /// the mean: score per nat; 0 leaves the term out.
        interface_weight: f64 = 5.0, "NUMBER", WEIGHT, in files;
        /// Cost of each Å by which a pose lies in the membrane: score per Å; 0 leaves the term out.
        membrane_weight: f64 = 50.0, "NUMBER", WEIGHT, in files;
        /// Contact potential in place of the program's own.
        ///
        /// A table as scripts/potentials/contact_potential.py writes it.
        contact_potential: Option<Potential> = None, "FILE", Optional(Content(contact)), in files;
        /// Fine contact potential in place of the program's own.
        ///
        /// A table as scripts/potentials/contact_potential.py --fine writes it.
        fine_contact_potential: Option<DistanceBinnedPotential> = None, "FILE", Optional(Content(fine_contact)), in files;
        /// Atom pair potential in place of the program's own.
        ///
        /// A table as scripts/potentials/atom_pair_potential.py writes it.
        atom_pair_potential: Option<AtomPairPotential> = None, "FILE", Optional(Content(atom_pair)), in files;
        /// pH at which charges are assigned.
        ph: f64 = 7.0, "PH", Range::between(0.0, 14.0);
    }
}

impl TermOptions {
    /// The weight of the term with an id of the registries; shape has none.
    pub fn weight(&self, id: &str) -> Option<f64> {
        Some(match id {
            "electrostatics" => self.electrostatics_weight,
            "contact" => self.contact_weight,
            "restraint" => self.restraint_weight,
            "fine_contact" => self.fine_contact_weight,
            "atom_pair" => self.atom_pair_weight,
            "relaxed" => self.relaxed_weight,
            "active_residues" => self.active_weight,
            "unresolved" => self.unresolved_weight,
            "termini" => self.termini_weight,
            "restraints_penalty" => self.violation_weight,
            "interface_predictions" => self.interface_weight,
            "membrane" => self.membrane_weight,
            _ => return None,
        })
    }
}

/// The contact potential of a file.
fn contact(path: &Path) -> Result<Potential, Error> {
    table(path, "contact_potential.py", Potential::parse)
}

/// The fine contact potential of a file.
fn fine_contact(path: &Path) -> Result<DistanceBinnedPotential, Error> {
    let script = "contact_potential.py --fine";
    table(path, script, DistanceBinnedPotential::parse)
}

/// The atom pair potential of a file.
fn atom_pair(path: &Path) -> Result<AtomPairPotential, Error> {
    table(path, "atom_pair_potential.py", AtomPairPotential::parse)
}

/// The table in a file; `script` writes such tables.
fn table<P>(path: &Path, script: &str, parse: fn(&str) -> Result<P, Error>) -> Result<P, Error> {
    let refused = |error: Error| {
        let remedy = format!("give a table as scripts/{script} writes it, or leave the option out");
        error.at(path).help(remedy)
    };
    let text = read_bounded_text(path, MAX_TABLE).map_err(|error| {
        let message = format!("the table of energies cannot be read: {error}");
        refused(Error::input(message))
    })?;
    parse(&text).map_err(refused)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::definitions;
    use knotdock_scoring::terms::effect::Effect;
    use knotdock_scoring::terms::pose::POSE_TERMS;

    /// Each term of the registries has its own weight among the options; shape, against which the others are weighed,
    /// has none.
    #[test]
    fn every_term_has_its_weight() {
        let effects = Effect::ALL.map(|effect| effect.definition().id);
        let ids = effects
            .into_iter()
            .chain(POSE_TERMS.iter().map(|term| term.id));
        let ids: Vec<&str> = ids.filter(|id| *id != "shape").collect();
        let default = TermOptions::default();
        assert_eq!(default.weight("shape"), None);
        let is_weight = |name: &str| name.ends_with("_weight") && name != "core_weight";
        let own = definitions().iter().filter(|one| one.subject() == "terms");
        assert_eq!(own.filter(|one| is_weight(one.name())).count(), ids.len());
        for id in ids {
            assert!(
                default.weight(id).is_some_and(|weight| weight > 0.0),
                "{id}"
            );
        }
    }
}
