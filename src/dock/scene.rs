//! Which effects a scene calls for: what the inputs can feed, what the user asks for, and why each is on or off.

use crate::dock::flexible_regions::FlexibleRegions;
use crate::error::SearchError;
use crate::mesh::MeshPair;
use crate::options::effect_choice::EffectChoice;
use crate::options::{AntibodySurface, DockOptions};
use crate::priors::active_residues::{ActiveResidues, AssumedSite};
use crate::priors::restraints::Restraints;
use crate::rank::rescoring::Rescoring;
use knotdock_scoring::effect::{Effect, Term, contact, electrostatics, restraint};
use knotdock_scoring::engine::Plan;
use knotdock_scoring::symmetry::RingAxis;
use knotdock_scoring::terms::pose::Rescorer;
use knotdock_structures::Knots;
use knotdock_structures::molecule::{LabelReport, Labels, Molecule};
use serde::Serialize;

/// Whether an effect is on, and why.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decision {
    /// The effect.
    pub effect: Effect,
    /// Whether it is on.
    pub on: bool,
    /// Why.
    pub reason: String,
}

/// The unit of a scene's lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    /// Molecules.
    Angstrom,
    /// Meshes: whatever the two files are in.
    File,
}

impl std::fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Angstrom => "Å",
            Self::File => "unit",
        })
    }
}

/// Two bodies with the terms that act between them.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Unit of all lengths.
    pub unit: LengthUnit,
    /// What plays the part of an Ångström, in that unit: first and last steps of climbs are shares of it.
    pub angstrom: f64,
    /// The receptor, labelled where an effect needs it.
    pub receptor: Knots,
    /// The ligand, likewise.
    pub ligand: Knots,
    /// Terms beside shape.
    pub terms: Vec<Term>,
    /// One decision for each effect, in the order of [`Effect::ALL`].
    pub decisions: Vec<Decision>,
    /// What was assumed in labelling receptor and ligand.
    pub labels: [LabelReport; 2],
    /// Residues that should be in contact.
    pub active: ActiveResidues,
    /// Unresolved segments and residues near termini; empty where they cost nothing.
    pub regions: FlexibleRegions,
    /// The axis of the ring that the molecule is, where two such rings are asked for.
    pub ring_axis: Option<RingAxis>,
}

/// What a contact of an attracted atom earns in the search, as a share of what a pose earns in which all such residues touch, times their number: a
/// residue that touches has some 70, so that the contacts of all earn about a quarter of that however many are named.
const PULL: f64 = 4e-3;

/// Share of a molecule's heavy atoms that must have contact types for the contact potential to speak for it.
const TYPED_SHARE: f64 = 0.5;

impl Scene {
    /// The scene of two molecules.
    ///
    /// # Errors
    /// [`SearchError`] on unusable knots, on a pH or weight out of range, and when an effect is asked for that the molecules cannot feed.
    pub fn new(
        receptor: &Molecule,
        ligand: &Molecule,
        options: &DockOptions,
    ) -> Result<Self, SearchError> {
        options.check_ranges()?;
        let ring_axis = ring_axis(receptor, options)?;
        let molecules = [receptor, ligand];
        let labels = molecules.map(|molecule| molecule.labels(options.terms.ph));
        let restraints = Restraints::new(molecules, options)?;
        let why_not = |effect: Effect| {
            if effect == Effect::Restraint {
                let none = match options.restraints.antibody {
                    AntibodySurface::Cdrs => {
                        "neither is an antibody, and no residue is blocked or attracted"
                    }
                    AntibodySurface::Whole => {
                        "no residue is blocked or attracted, and all of an antibody may touch"
                    }
                };
                return (!restraints.any()).then(|| none.to_owned());
            }
            let sides = ["receptor", "ligand"]
                .into_iter()
                .zip(molecules)
                .zip(&labels);
            sides
                .map(|((side, molecule), labels)| lacking(effect, side, molecule, &labels.report))
                .find_map(|reason| reason)
        };
        let mut decisions = Vec::new();
        for effect in Effect::ALL {
            let asked = match &options.kernel.effects {
                EffectChoice::Auto => None,
                EffectChoice::Only(effects) => Some(effects.contains(&effect)),
            };
            let (on, reason) = match (effect, asked, why_not(effect)) {
                (Effect::Shape, ..) => (true, "always on".to_owned()),
                (Effect::Restraint, Some(false), _) if options.restraints.names_residues() => {
                    return Err(SearchError::Option {
                        name: "effects",
                        value: options.kernel.effects.clone().into(),
                        bound:
                            "auto or name restraint too, since residues are blocked or attracted"
                                .to_owned(),
                    });
                }
                (_, Some(false), _) => (false, "not asked for".to_owned()),
                (_, Some(true), Some(reason)) => {
                    return Err(SearchError::Effect { effect, reason });
                }
                (Effect::Restraint, _, None) => (true, restraints.reason.clone()),
                (_, Some(true), None) => (true, "asked for".to_owned()),
                (_, None, Some(reason)) => (false, reason),
                (Effect::Electrostatics, None, None) => {
                    (true, "both sides carry charges".to_owned())
                }
                (Effect::Contact, None, None) => (
                    true,
                    "both sides are proteins of known atom types".to_owned(),
                ),
            };
            decisions.push(Decision { effect, on, reason });
        }
        let cores = molecules.map(|molecule| core_weights(molecule, options.terms.core_weight));
        let [receptor_labels, ligand_labels] = labels;
        let on = |effect: Effect| decisions.iter().any(|d| d.effect == effect && d.on);
        // A label that no effect reads is left off.
        let label = |knots: Knots, labels: Labels| -> Result<(Knots, LabelReport), SearchError> {
            let charges = if on(Effect::Electrostatics) {
                labels.charges
            } else {
                Vec::new()
            };
            let (types, kinds) = if on(Effect::Contact) {
                (labels.contact_types, labels.atom_kinds)
            } else {
                (Vec::new(), Vec::new())
            };
            let knots = knots.with_labels(charges, types)?.with_atom_kinds(kinds)?;
            Ok((knots, labels.report))
        };
        let (receptor, receptor_report) = label(receptor.knots()?, receptor_labels)?;
        let (ligand, ligand_report) = label(ligand.knots()?, ligand_labels)?;
        let mut terms = Vec::new();
        if on(Effect::Electrostatics) {
            let weight = options.terms.electrostatics_weight;
            terms.push(electrostatics::term(&receptor, &ligand, weight));
        }
        if on(Effect::Contact) {
            let potential = options.terms.contact_potential.clone().unwrap_or_default();
            terms.push(contact::term(
                &receptor,
                &ligand,
                options.terms.contact_weight,
                &potential,
            ));
        }
        if on(Effect::Restraint) {
            let [own, other] = &restraints.marks;
            let residues: usize = restraints.attracted.iter().map(Vec::len).sum();
            let weights = restraint::Weights {
                blocked: options.restraints.restraint_weight,
                attracted: PULL * options.restraints.active_weight / residues.max(1) as f64,
            };
            terms.push(restraint::term(&receptor, &ligand, [own, other], weights));
        }
        let named = ActiveResidues::named(restraints.attracted, options);
        // What is known takes the place of what is assumed.
        let active = if !named.sets.is_empty() || !on(Effect::Contact) {
            named
        } else {
            let [own, other] = &restraints.marks;
            ActiveResidues::assumed(molecules, [own, other], options)
        };
        // Terms count atoms; how much a buried one weighs is a matter of shape.
        let [receptor, ligand] =
            [(receptor, &cores[0]), (ligand, &cores[1])].map(|(knots, core)| {
                let mut knots = knots;
                for (weight, core) in knots.weights.iter_mut().zip(core) {
                    *weight *= core;
                }
                knots
            });
        Ok(Self {
            unit: LengthUnit::Angstrom,
            angstrom: 1.0,
            receptor,
            ligand,
            terms,
            decisions,
            labels: [receptor_report, ligand_report],
            active,
            regions: FlexibleRegions::of(molecules, options),
            ring_axis,
        })
    }

    /// The scene of two meshes, of which shape is all there is to score.
    ///
    /// # Errors
    /// [`SearchError`] when another effect is asked for.
    pub fn of_meshes(pair: &MeshPair, options: &DockOptions) -> Result<Self, SearchError> {
        let decide = |effect: Effect| {
            let reason = match effect {
                Effect::Shape => "always on",
                Effect::Electrostatics => "meshes carry no charges",
                Effect::Contact => "meshes have no atom types",
                Effect::Restraint => "meshes have no residues",
            };
            let asked = (effect == Effect::Restraint && options.restraints.names_residues())
                || matches!(&options.kernel.effects, EffectChoice::Only(effects) if effects.contains(&effect));
            if asked && effect != Effect::Shape {
                let reason = reason.to_owned();
                return Err(SearchError::Effect { effect, reason });
            }
            Ok(Decision {
                effect,
                on: effect == Effect::Shape,
                reason: reason.to_owned(),
            })
        };
        let decisions = Effect::ALL.into_iter().map(decide);
        let [receptor, ligand] = [0, 1].map(|part| pair.parts[part].knots.clone());
        Ok(Self {
            unit: LengthUnit::File,
            angstrom: pair.angstrom(),
            receptor,
            ligand,
            terms: Vec::new(),
            decisions: decisions.collect::<Result<_, _>>()?,
            labels: [LabelReport::default(), LabelReport::default()],
            active: Default::default(),
            regions: Default::default(),
            ring_axis: None,
        })
    }

    /// The engine's plan for the scene.
    ///
    /// # Errors
    /// [`SearchError`] on knots or options that no engine can correlate.
    pub(crate) fn engine_plan(&self, options: &DockOptions) -> Result<Plan, SearchError> {
        let terms = self.terms.clone();
        let engine = options.kernel.engine();
        let tolerance = options.kernel.tolerance;
        let plan = Plan::with_effects(&self.receptor, &self.ligand, engine, tolerance, terms)?;
        Ok(plan)
    }

    /// The active site that the partner of a peptidase is assumed to bind, where one is.
    pub fn active_site(&self) -> Option<&AssumedSite> {
        self.active.assumed.as_ref()
    }

    /// The pose terms prepared for rescoring; `None` if no term acts.
    pub fn rescorer(&self, options: &DockOptions) -> Option<Rescorer> {
        let bodies = [&self.receptor, &self.ligand];
        Rescoring::new(bodies, &self.active, &self.regions, options).rescorer()
    }
}

/// The axis of a molecule that is a ring, where two such rings are asked for.
fn ring_axis(molecule: &Molecule, options: &DockOptions) -> Result<Option<RingAxis>, SearchError> {
    let Some((symmetry, folds)) = options
        .search
        .symmetry
        .and_then(|of| Some((of, of.folds()?)))
    else {
        return Ok(None);
    };
    let no_ring = |reason: String| SearchError::Ring { symmetry, reason };
    let copies = molecule.copies(folds);
    let copies = copies.map_err(|error| no_ring(error.to_string()))?;
    let axis = RingAxis::of(&copies).map_err(|error| no_ring(error.to_string()))?;
    Ok(Some(axis))
}

/// Points a sphere at which atoms are asked whether water reaches them.
const SURFACE_POINTS: usize = 64;

/// The weight in shape of each atom; empty where all weigh 1.
fn core_weights(molecule: &Molecule, weight: f64) -> Vec<f64> {
    if weight == 1.0 {
        return Vec::new();
    }
    molecule
        .accessible_areas(SURFACE_POINTS)
        .into_iter()
        .map(|area| if area == 0.0 { weight } else { 1.0 })
        .collect()
}

/// What one molecule lacks for an effect; `None` when it can feed it.
fn lacking(
    effect: Effect,
    side: &str,
    molecule: &Molecule,
    labels: &LabelReport,
) -> Option<String> {
    match effect {
        Effect::Electrostatics if labels.charged_atoms == 0 => {
            Some(format!("no atom of the {side} carries a charge"))
        }
        Effect::Contact => {
            // Hydrogens, where they are kept, have no types of their own.
            let atoms = molecule.atoms.iter();
            let atoms = atoms.filter(|atom| !atom.is_hydrogen()).count();
            let too_few = (labels.typed_atoms as f64) < TYPED_SHARE * atoms as f64;
            (too_few || labels.typed_atoms == 0).then(|| {
                format!(
                    "only {} of the {side}'s {atoms} atoms are of known contact types",
                    labels.typed_atoms
                )
            })
        }
        Effect::Shape | Effect::Electrostatics | Effect::Restraint => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::priors::restraints::tests::peptide;
    use knotdock_scoring::terms::pose;
    use knotdock_structures::molecule::{CONTACT_TYPES, atom_kinds};

    /// However many residues are named, all of their contacts together draw as much.
    #[test]
    fn attracted_residues_share_their_pull() {
        let molecule = peptide(4.0);
        let pull = |residues: &str| {
            let options = DockOptions::default().changed(|options| {
                options.restraints.active_weight = 1000.0;
                options.restraints.active_ligand = Some(residues.parse().unwrap());
            });
            let scene = Scene::new(&molecule, &molecule, &options).unwrap();
            let is_restraint = |term: &&Term| term.effect == Effect::Restraint;
            let term = scene.terms.iter().find(is_restraint).unwrap();
            let (free, attracted) = (term.receptor[0].class, term.ligand[0].class);
            term.matrix[free][attracted]
        };
        assert_eq!(pull("A:1"), 4.0);
        assert_eq!(pull("A:1,A:3-4,A:1"), 4.0 / 3.0);
    }

    /// Two crates hold the names, since neither may know the other's files.
    #[test]
    fn the_types_of_molecules_are_those_of_the_potential() {
        assert_eq!(CONTACT_TYPES, contact::TYPES);
        assert_eq!(atom_kinds(), pose::atom_kinds());
    }
}
