//! The scene of a docking run: two labelled bodies with the terms that act between them.

use crate::dock::effect_decisions::{self, Decision};
use crate::error::unplanned;
use crate::mesh::MeshPair;
use crate::options::refused;
use crate::options::{DockOptions, SharpChoice};
use crate::priors;
use crate::priors::active_residues::{ActiveResidues, AssumedSite};
use crate::priors::flexible_regions::FlexibleRegions;
use crate::priors::residue_roles::ResidueRoles;
use crate::priors::restrained::Restrained;
use crate::rank::rescoring::Rescoring;
use knotdock_scoring::engine::{EngineOptions, Plan};
use knotdock_scoring::kernel::Band;
use knotdock_scoring::symmetry::RingAxis;
use knotdock_scoring::terms::effect::{Effect, EffectInputs, LabelCounts, Term};
use knotdock_scoring::terms::pose::Rescorer;
use knotdock_structures::Error;
use knotdock_structures::molecule::{LabelReport, Labels, Molecule};
use knotdock_structures::{Knots, PolarAtom};
use serde::Serialize;

/// The unit of a scene's lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    /// Molecules.
    Angstrom,
    /// Meshes: whatever the two files are in.
    File,
}

impl LengthUnit {
    /// T of the clusters' scores as a share of the best score, by the kind of bodies.
    pub(crate) fn cluster_temperature(self) -> f64 {
        match self {
            Self::Angstrom => 0.1,
            Self::File => 0.0,
        }
    }
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
    /// Length in that unit that stands for an Ångström: first and last steps of refinement are shares of it.
    pub angstrom: f64,
    /// Depth of the skin where the kernel is the product kernel, in that unit; `None`: it is B&I's cone.
    pub skin: Option<f64>,
    /// The receptor, labelled where an effect needs it.
    pub receptor: Knots,
    /// The ligand, likewise.
    pub ligand: Knots,
    /// Terms beside shape.
    pub terms: Vec<Term>,
    /// One decision for each effect, in the order of [`Effect::ALL`].
    pub decisions: Vec<Decision>,
    /// Assumptions in labelling receptor and ligand.
    pub labels: [LabelReport; 2],
    /// Residues that should be in contact.
    pub active: ActiveResidues,
    /// Restraints on distances between the two.
    pub restraints: Restrained,
    /// Unresolved segments and residues near termini; empty where they cost nothing.
    pub regions: FlexibleRegions,
    /// The parts of the atoms of receptor and ligand in hydrogen bonds, where sharp fits are looked for.
    pub polar: Option<[Vec<PolarAtom>; 2]>,
    /// Axis of the ring that the molecule is, where two such rings are docked.
    pub ring_axis: Option<RingAxis>,
}

/// Score of a contact of an active atom in the search, times the number of active residues, as a share of the weight
/// of active residues.
///
/// A residue in contact has about 70 contacts. So the contacts of all active residues earn about a quarter of that
/// weight, however many there are.
const PULL: f64 = 4e-3;

impl Scene {
    /// The scene of two molecules.
    ///
    /// # Errors
    /// [`Error`] on unusable knots, on a pH or weight out of range, and when an effect is requested that the
    /// molecules lack something for.
    pub fn new(
        receptor: &Molecule,
        ligand: &Molecule,
        options: &DockOptions,
    ) -> Result<Self, Error> {
        options.check_ranges()?;
        let ring_axis = ring_axis(receptor, options)?;
        let molecules = [receptor, ligand];
        let labels = molecules.map(|molecule| molecule.labels(options.terms.ph));
        let sites = molecules.map(priors::sites);
        let sites = sites.each_ref().map(Vec::as_slice);
        let named = ResidueRoles::new(molecules, sites, options)?;
        let residues: usize = named.active.iter().map(Vec::len).sum();
        let active_weight = options.terms.active_weight;
        let [own, other] = &named.roles;
        let inputs = EffectInputs {
            labels: [0, 1].map(|side| label_counts(molecules[side], &labels[side].report)),
            contact_potential: options.terms.contact_potential.as_ref(),
            roles: [own, other],
            roles_reason: &named.reason,
            active_weight: PULL * active_weight / residues.max(1) as f64,
        };
        let decisions = effect_decisions::of_molecules(&inputs, options)?;
        let cores = molecules.map(|molecule| core_weights(molecule, options.terms.core_weight));
        let [receptor_labels, ligand_labels] = labels;
        let on = |effect: Effect| decisions.iter().any(|d| d.effect == effect && d.on);
        // Knots carry only the labels that an effect reads.
        let label = |knots: Knots, labels: Labels| -> Result<(Knots, LabelReport), Error> {
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
        let terms = decisions.iter().filter(|decision| decision.on);
        let terms = terms.filter_map(|Decision { effect, .. }| {
            let definition = effect.definition();
            // Shape has none: the others are weighed against it.
            let weight = options.terms.weight(definition.id).unwrap_or(1.0);
            (definition.term)([&receptor, &ligand], &inputs, weight)
        });
        let terms = terms.collect();
        // Residues that are named take the place of those that a prior names.
        let active = if named.active.iter().any(|side| !side.is_empty()) || !on(Effect::Contact) {
            ActiveResidues::named(named.active, options)
        } else {
            ActiveResidues::assumed(sites, [own, other], options)
        };
        let polar =
            sharp_fits(options, on(Effect::Contact))?.then(|| molecules.map(Molecule::polar_atoms));
        // The weight of buried atoms is a matter of shape alone, so it comes after the terms.
        let [receptor, ligand] =
            [(receptor, &cores[0]), (ligand, &cores[1])].map(|(knots, core)| {
                let mut knots = knots;
                for (weight, core) in knots.weights.iter_mut().zip(core) {
                    *weight *= core;
                }
                knots
            });
        let distances = Restrained::new(molecules, &options.restraints)?;
        Ok(Self {
            unit: LengthUnit::Angstrom,
            angstrom: 1.0,
            skin: None,
            receptor,
            ligand,
            terms,
            decisions,
            labels: [receptor_report, ligand_report],
            active,
            restraints: distances,
            polar,
            regions: FlexibleRegions::of(molecules, options),
            ring_axis,
        })
    }

    /// The scene of two meshes, which shape alone scores.
    ///
    /// # Errors
    /// [`Error`] when another effect or sharp fits are requested.
    pub fn of_meshes(pair: &MeshPair, options: &DockOptions) -> Result<Self, Error> {
        if options.ranking.sharp == SharpChoice::On {
            return Err(no_sharp_fits("of meshes"));
        }
        let [receptor, ligand] = [0, 1].map(|part| pair.parts[part].knots.clone());
        Ok(Self {
            unit: LengthUnit::File,
            angstrom: pair.angstrom(),
            skin: pair.skin(),
            receptor,
            ligand,
            terms: Vec::new(),
            decisions: effect_decisions::of_meshes(options)?,
            labels: [LabelReport::default(), LabelReport::default()],
            active: Default::default(),
            restraints: Default::default(),
            polar: None,
            regions: Default::default(),
            ring_axis: None,
        })
    }

    /// The engine's plan for the scene.
    ///
    /// # Errors
    /// [`Error`] on knots or options that no engine can correlate.
    pub(crate) fn engine_plan(&self, options: &DockOptions) -> Result<Plan, Error> {
        self.plan_of(options.kernel.engine(), options.kernel.tolerance)
    }

    /// The plan for an engine's options, with the kernel of a tolerance: see [`Plan::with_effects`]. Of the product
    /// kernel volumes are in offsets cubed, and the offset of the engine is the depth of the skin.
    ///
    /// # Errors
    /// As [`Self::engine_plan`].
    pub(crate) fn plan_of(
        &self,
        engine: EngineOptions,
        kernel_tolerance: f64,
    ) -> Result<Plan, Error> {
        let (receptor, ligand) = (&self.receptor, &self.ligand);
        Ok(match self.skin {
            None => {
                let terms = self.terms.clone();
                Plan::with_effects(receptor, ligand, engine, kernel_tolerance, terms)
                    .map_err(unplanned)?
            }
            Some(skin) => {
                let unit = engine.kernel.offset;
                let mut engine = engine;
                engine.kernel.offset = skin;
                Plan::product_in(receptor, ligand, engine, Band::LowPass, unit)
                    .map_err(unplanned)?
            }
        })
    }

    /// The active site that the partner of a peptidase is assumed to bind, where one is.
    pub fn active_site(&self) -> Option<&AssumedSite> {
        self.active.assumed.as_ref()
    }

    /// The pose terms prepared for rescoring; `None` if no term acts.
    pub fn rescorer(&self, options: &DockOptions) -> Option<Rescorer> {
        let bodies = [&self.receptor, &self.ligand];
        let known = (&self.active, &self.restraints);
        Rescoring::new(bodies, known, &self.regions, options).rescorer()
    }
}

/// Whether sharp fits are looked for between two molecules: where they are requested, and by default where residue
/// contacts score as well, which the weights of the ranking were chosen with. Copies of a ring cannot move alone.
///
/// # Errors
/// [`Error`] when they are requested of a ring.
fn sharp_fits(options: &DockOptions, contacts: bool) -> Result<bool, Error> {
    let is_free = options.search.symmetry.is_none();
    match options.ranking.sharp {
        SharpChoice::Auto => Ok(is_free && contacts),
        SharpChoice::On if is_free => Ok(true),
        SharpChoice::On => Err(no_sharp_fits("with --symmetry")),
        SharpChoice::Off => Ok(false),
    }
}

/// Refusal of sharp fits where they cannot be had.
fn no_sharp_fits(of: &str) -> Error {
    refused("sharp", "on", &format!("auto or off {of}"))
}

/// Axis of a molecule that is a ring, where two such rings are docked.
///
/// # Errors
/// [`Error`] for a molecule that is no such ring.
pub fn ring_axis(molecule: &Molecule, options: &DockOptions) -> Result<Option<RingAxis>, Error> {
    let Some((symmetry, folds)) = options
        .search
        .symmetry
        .and_then(|of| Some((of, of.folds()?)))
    else {
        return Ok(None);
    };
    let no_ring = |reason: String| {
        Error::input(format!(
            "{symmetry} docks two rings, and this molecule is not such a ring: {reason}"
        ))
        .help(format!(
            "dock the single molecule with --symmetry C{folds} first and give a complex of that run, such as its \
             top/rank_0001.pdb: copies one after another, each with all its chains"
        ))
    };
    let copies = molecule.copies(folds);
    let copies = copies.map_err(|error| no_ring(error.to_string()))?;
    let axis = RingAxis::of(&copies).map_err(|error| no_ring(error.to_string()))?;
    Ok(Some(axis))
}

/// Points on the sphere of each atom that decide whether water reaches it.
const SURFACE_POINTS: usize = 64;

/// Weight in shape of each atom; empty if all weigh 1.
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

/// Numbers of a molecule's labelled atoms. Hydrogens, if they are kept, have no contact types.
fn label_counts(molecule: &Molecule, labels: &LabelReport) -> LabelCounts {
    let heavy = molecule.atoms.iter().filter(|atom| !atom.is_hydrogen());
    LabelCounts {
        atoms: heavy.count(),
        charged: labels.charged_atoms,
        typed: labels.typed_atoms,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::priors::residue_roles::tests::peptide;
    use knotdock_scoring::terms::effect::contact;
    use knotdock_scoring::terms::pose;
    use knotdock_structures::molecule::{CONTACT_TYPES, atom_kinds};

    /// The contacts of all active residues together earn the same, however many there are.
    #[test]
    fn active_residues_share_their_pull() {
        let molecule = peptide(4.0);
        let pull = |residues: &str| {
            let options = DockOptions::default().changed(|options| {
                options.terms.active_weight = 1000.0;
                options.restraints.active_ligand = Some(residues.parse().unwrap());
            });
            let scene = Scene::new(&molecule, &molecule, &options).unwrap();
            let is_restraint = |term: &&Term| term.effect == Effect::Restraint;
            let term = scene.terms.iter().find(is_restraint).unwrap();
            let (free, active) = (term.receptor[0].class, term.ligand[0].class);
            term.matrix[free][active]
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
