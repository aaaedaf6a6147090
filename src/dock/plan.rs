//! The plan of a docking run: engine plan, rotations, and the memory that it will take.

use crate::dock::effect_decisions::Decision;
use crate::dock::memory::MemoryPlan;
use crate::dock::scene::{LengthUnit, Scene};
use crate::error::unplanned;
use crate::options::{DockOptions, Precision, REFINED_BY_SHAPE};
use crate::pose_space::PoseSpace;
use crate::priors::active_residues::{ActiveResidues, AssumedSite};
use crate::priors::flexible_regions::FlexibleRegions;
use crate::priors::restrained::Restrained;
use crate::rank::ranking::RowChoice;
use crate::rank::rescoring::Rescoring;
use crate::rank::sharp::SharpInputs;
use crate::search::allowed::SearchRestraints;
use crate::search::plan::SearchPlan;
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::Rescorer;
use knotdock_structures::Error;
use knotdock_structures::molecule::{LabelReport, Molecule};
use knotdock_structures::{Knots, PolarAtom};
use serde::Serialize;
use std::sync::Arc;

/// A planned docking run.
#[derive(Clone, Debug, Serialize)]
pub struct DockPlan {
    /// The options it was made from.
    #[serde(skip)]
    pub options: DockOptions,
    /// Unit of all lengths.
    pub unit: LengthUnit,
    /// Number of rotations, of rings that of axes.
    pub rotations: usize,
    /// Name of the rotation set.
    pub rotation_set: &'static str,
    /// Measured covering radius of the set, of rings that of their axes, degrees.
    pub covering_radius_degrees: f64,
    /// Grid points per axis.
    pub grid: [usize; 3],
    /// Grid spacing, Å.
    pub spacing: f64,
    /// Fine grid of the nufft transforms, points per axis.
    pub fine_grid: [usize; 3],
    /// Width of the spreading window, fine cells.
    pub spreading_width: usize,
    /// Three-dimensional modes kept, conjugates not counted.
    pub modes: usize,
    /// Modes of the lifted axis, k = -K..K.
    pub lifted_modes: usize,
    /// Distance in Å at which the ranking kernel ends.
    pub kernel_reach: f64,
    /// Pass frequency of the low-pass, 1/Å.
    pub pass_frequency: f64,
    /// Stop frequency of the low-pass, 1/Å.
    pub stop_frequency: f64,
    /// Distinct radii of receptor and ligand.
    pub radii: [usize; 2],
    /// Length that stands for one Ångström, in `unit`.
    #[serde(skip)]
    pub(crate) angstrom: f64,
    /// Bytes that everything but rotations in flight takes, beside the program and the inputs.
    pub fixed_bytes: u64,
    /// Bytes that a rotation in flight takes.
    pub bytes_in_flight: u64,
    /// Memory by stage, within the limit.
    #[serde(skip)]
    pub(crate) memory: MemoryPlan,
    /// Effects that are on, and why.
    #[serde(skip)]
    pub decisions: Vec<Decision>,
    /// Residues that should be in contact.
    #[serde(skip)]
    pub(crate) active: ActiveResidues,
    /// Restraints on distances between receptor and ligand.
    #[serde(skip)]
    pub restraints: Restrained,
    /// What was assumed of charges and contact types, of receptor and ligand.
    pub labels: [LabelReport; 2],
    /// Unresolved segments and residues near termini, of receptor and ligand.
    #[serde(flatten)]
    pub regions: FlexibleRegions,
    /// Settings of the search.
    #[serde(skip)]
    pub search: SearchPlan,
    /// The parts of atoms in hydrogen bonds, if sharp fits are looked for.
    #[serde(skip)]
    pub(crate) polar: Option<[Vec<PolarAtom>; 2]>,
    #[serde(skip)]
    pub(crate) receptor: Knots,
    #[serde(skip)]
    pub(crate) ligand: Knots,
}

/// Plans the docking of two molecules.
///
/// # Errors
/// [`Error`] on options out of range, unusable knots, or too little memory for a single rotation.
pub fn plan(
    receptor: &Molecule,
    ligand: &Molecule,
    options: &DockOptions,
) -> Result<DockPlan, Error> {
    options.validate()?;
    plan_scene(Scene::new(receptor, ligand, options)?, options)
}

/// Plans the docking of a scene, whatever it was made from.
///
/// # Errors
/// As [`plan`].
pub fn plan_scene(scene: Scene, options: &DockOptions) -> Result<DockPlan, Error> {
    options.validate()?;
    let space = PoseSpace::new(options.search.symmetry, scene.ring_axis);
    let engine = space
        .grid_of(scene.engine_plan(options)?, &scene.receptor)
        .map_err(unplanned)?;
    let refined = refined(&space, &scene.decisions, options);
    let memory = MemoryPlan::new(&scene, &engine, options, (&space, refined))?;
    let limits = (memory.in_flight(), memory.graphics);
    let known = SearchRestraints {
        restraints: &scene.restraints.distances,
        membrane: scene.restraints.membrane.as_ref(),
        knots: [&scene.receptor, &scene.ligand],
    };
    let search = SearchPlan::new(Arc::new(engine), space, options, known, limits);
    let engine = &search.engine;
    let radii = [0, 1].map(|side| engine.basis().size(engine.axis(), side));
    Ok(DockPlan {
        unit: scene.unit,
        angstrom: scene.angstrom,
        rotations: options.search.rotations,
        rotation_set: search.rotations.name,
        covering_radius_degrees: search.rotations.covering_radius.to_degrees(),
        grid: engine.size(),
        spacing: engine.spacing(),
        fine_grid: engine.fine(),
        spreading_width: engine.width(),
        modes: engine.modes().count,
        lifted_modes: engine.axis().modes(),
        kernel_reach: engine.reach(),
        pass_frequency: 1.0 / engine.options().kernel.pass_length,
        stop_frequency: engine.kernel().stop(),
        radii,
        fixed_bytes: memory.fixed(),
        bytes_in_flight: memory.per_rotation(),
        memory,
        decisions: scene.decisions,
        active: scene.active,
        restraints: scene.restraints,
        labels: scene.labels,
        regions: scene.regions,
        polar: scene.polar,
        options: options.clone(),
        receptor: scene.receptor,
        ligand: scene.ligand,
        search,
    })
}

impl DockPlan {
    /// The rows of the table, with the error by which the fast path may misjudge a pose. Poses of rings score with copies
    /// beyond the neighbours, of which the search knows nothing, so their order needs exact scores.
    pub(crate) fn row_choice(&self, margin: f64) -> RowChoice {
        let ranking = &self.options.ranking;
        match ranking.exact {
            _ if ranking.no_cluster => RowChoice::EveryPose,
            Some(exact) if self.options.search.symmetry.is_none() => RowChoice::BestExact(exact),
            _ => RowChoice::Clusters { margin },
        }
    }

    /// The knots that are docked, of receptor and ligand.
    pub fn knots(&self) -> [&Knots; 2] {
        [&self.receptor, &self.ligand]
    }

    /// Whether sharp fits are looked for.
    pub fn sharp(&self) -> bool {
        self.polar.is_some()
    }

    /// The inputs of the sharp stage; `None` if it is off.
    pub(crate) fn sharp_inputs(&self) -> Option<SharpInputs<'_>> {
        let polar = self.polar.as_ref()?;
        Some(SharpInputs {
            bodies: [&self.receptor, &self.ligand],
            polar: polar.each_ref().map(Vec::as_slice),
        })
    }

    /// Rotations in flight at once.
    pub fn in_flight(&self) -> usize {
        self.search.in_flight
    }

    /// Balls of receptor and ligand that the resolution is too coarse to distinguish from points.
    pub fn unresolved(&self) -> [usize; 2] {
        [&self.receptor, &self.ligand].map(|knots| self.search.engine.unresolved(knots).len())
    }

    /// The exact sum that ranks.
    ///
    /// # Errors
    /// [`Error`] on knots that cannot be summed.
    pub fn exact_scorer(&self) -> Result<ExactSum, Error> {
        let engine = &self.search.engine;
        Ok(ExactSum::of(engine, &self.receptor, &self.ligand)?)
    }

    /// Number of poses to refine: all if none is on the grid, as of rings.
    pub fn refined(&self) -> usize {
        refined(&self.search.space, &self.decisions, &self.options)
    }

    /// The pose terms prepared for rescoring; `None` if no term acts.
    pub(crate) fn rescorer(&self) -> Option<Rescorer> {
        self.rescoring().rescorer()
    }

    /// The active site that the partner of a peptidase is assumed to bind, if any.
    pub fn active_site(&self) -> Option<&AssumedSite> {
        self.active.assumed.as_ref()
    }

    /// Inputs and weights of the pose terms.
    pub fn rescoring(&self) -> Rescoring<'_> {
        let bodies = [&self.receptor, &self.ligand];
        let known = (&self.active, &self.restraints);
        Rescoring::new(bodies, known, &self.regions, &self.options)
    }

    /// Rotations that would be in flight if there were more than enough of them.
    pub fn most_in_flight(&self) -> usize {
        self.memory.most_in_flight
    }

    /// Whether an effect is on.
    pub fn is_on(&self, effect: Effect) -> bool {
        self.decisions.iter().any(|d| d.effect == effect && d.on)
    }

    /// Seconds on the clock of the search of this number of rotations, an order of size: as timed on the threads of an idle
    /// two-core Intel Xeon at 2.50 GHz. A run with a deadline measures its own.
    pub fn search_seconds(&self, rotations: usize) -> f64 {
        let points = self.grid.iter().product::<usize>() as f64;
        let on = Effect::ALL.into_iter().filter(|effect| self.is_on(*effect));
        let components: f64 = on.map(|effect| effect.definition().components).sum();
        let precision = match self.options.search.precision {
            Precision::Single => 1.0,
            Precision::Double => 2.1,
        };
        let rotation = precision * points * points.log2() * (2.5e-10 + 4e-11 * components);
        rotations as f64 * rotation / self.memory.most_in_flight.min(rotations).max(1) as f64
    }

    /// Bytes that the run is expected to take at its peak.
    pub fn memory_bytes(&self) -> u64 {
        self.memory.bytes()
    }

    /// Counts the memory of another plan of the same run.
    pub fn count_beside(&mut self, other: &Self) {
        self.memory.count_beside(&other.memory);
    }

    /// The stage of the run that takes the most memory.
    pub fn largest_stage(&self) -> &'static str {
        self.memory.largest()
    }
}

/// Number of poses to refine: all if none is on the grid, as of rings.
fn refined(space: &PoseSpace, decisions: &[Decision], options: &DockOptions) -> usize {
    if !space.is_on_grid() {
        return options.search.poses;
    }
    let mut decisions = decisions.iter();
    let alone = decisions.all(|decision| decision.effect == Effect::Shape || !decision.on);
    let default = if alone { REFINED_BY_SHAPE } else { 0 };
    options.search.refine.unwrap_or(default)
}
