//! The plan of a docking run: engine plan, rotations, and the memory that it will take.

use crate::dock::loose::Loose;
use crate::dock::scene::{Decision, LengthUnit, Scene};
use crate::error::SearchError;
use crate::options::{DockOptions, EngineChoice, KernelOptions, Precision, REFINED_BY_SHAPE};
use crate::pose_space::ring::Rings;
use crate::priors::active_residues::{ActiveResidues, AssumedSite};
use crate::rank::rescoring::Asked;
use crate::search::peaks::Peak;
use crate::search::rotations::{
    BYTES_RELAXED, MAX_RELAXED, covering_radius, rotation_set, set_name, spiral_set,
};
use knotdock_scoring::effect::Effect;
use knotdock_scoring::engine::{CpuEngine, Plan};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::rescoring::Rescorer;
use knotdock_scoring::se3::HalfTurn;
use knotdock_structures::Knots;
use knotdock_structures::molecule::{LabelReport, Molecule};
use nalgebra::UnitQuaternion;
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
    /// What plays the part of an Ångström, in `unit`.
    #[serde(skip)]
    pub(crate) angstrom: f64,
    /// Rotations in flight at once.
    #[serde(skip)]
    pub in_flight: usize,
    /// Bytes that everything but rotations in flight takes.
    pub fixed_bytes: u64,
    /// Bytes that a rotation in flight takes.
    pub bytes_in_flight: u64,
    /// Bytes of the graphics processor's memory that rotations in flight there may take; 0 on the CPU.
    #[serde(skip)]
    pub graphics_bytes: u64,
    /// Which effects are on, and why.
    #[serde(skip)]
    pub decisions: Vec<Decision>,
    /// What poses should touch.
    #[serde(skip)]
    pub(crate) attracted: ActiveResidues,
    /// What was assumed of charges and contact types, of receptor and ligand.
    pub labels: [LabelReport; 2],
    /// Residues that are missing, and those near ends of chains, of receptor and ligand.
    #[serde(flatten)]
    pub loose: Loose,
    /// The rings that are sought, if any are.
    #[serde(skip)]
    pub(crate) rings: Option<Rings>,
    #[serde(skip)]
    pub(crate) engine: Arc<Plan>,
    #[serde(skip)]
    pub(crate) receptor: Knots,
    #[serde(skip)]
    pub(crate) ligand: Knots,
    #[serde(skip)]
    pub(crate) set: Vec<UnitQuaternion<f64>>,
    /// The finer set; empty without a finer search.
    #[serde(skip)]
    pub(crate) fine_set: Vec<UnitQuaternion<f64>>,
}

/// Most fields that the compressed lifted axis is expected to need, for the memory estimate.
const EXPECTED_RANK: usize = 8;

/// Most bytes that rotations in flight take of a graphics processor's memory, which may be the computer's own.
const GRAPHICS_BYTES: u64 = 512 << 20;

/// Plans the docking of two molecules.
///
/// # Errors
/// [`SearchError`] on options out of range, unusable knots, or too little memory for a single rotation.
pub fn plan(
    receptor: &Molecule,
    ligand: &Molecule,
    options: &DockOptions,
) -> Result<DockPlan, SearchError> {
    options.check()?;
    plan_scene(Scene::new(receptor, ligand, options)?, options)
}

/// Plans the docking of a scene, whatever it was made from.
///
/// # Errors
/// As [`plan`].
pub fn plan_scene(scene: Scene, options: &DockOptions) -> Result<DockPlan, SearchError> {
    options.check()?;
    let Scene {
        unit,
        angstrom,
        receptor,
        ligand,
        terms,
        decisions,
        labels,
        attracted,
        loose,
        ring_axis,
    } = scene;
    let planned = |options: &DockOptions| {
        Plan::with_effects(
            &receptor,
            &ligand,
            options.kernel.engine(),
            options.kernel.tolerance,
            terms.clone(),
        )
    };
    let engine = planned(options)?;
    let (real_bytes, workspace_estimate): (u64, fn(&Plan, usize) -> usize) =
        match options.search.precision {
            Precision::Single => (4, CpuEngine::<f32>::workspace_estimate),
            Precision::Double => (8, CpuEngine::<f64>::workspace_estimate),
        };
    let needs = |engine: &Plan| {
        let functions = engine.functions();
        let rank = functions.min(EXPECTED_RANK);
        let per_rotation = workspace_estimate(engine, rank) as u64;
        // The functions, one in the making, and the compressed ones in either order of modes, packed.
        let fixed =
            2 * real_bytes * engine.modes.count as u64 * (functions + 1 + 5 * rank / 2) as u64
                + PotentialGrid::bytes(engine) as u64
                + 200 * (receptor.len() + ligand.len()) as u64
                + 64 * options.search.rotations as u64
                + fine_bytes(options)
                + BYTES_RELAXED * options.search.rotations.min(MAX_RELAXED) as u64
                + 400 * options.search.poses as u64
                + (16 << 20);
        (fixed, per_rotation)
    };
    let (fixed, per_rotation) = needs(&engine);
    let in_flight = most_in_flight(options, fixed, per_rotation).min(options.search.rotations);
    if let (0, Some(allowed)) = (in_flight, options.machine.memory) {
        let fits = least_coarse(|step| {
            let coarser = coarser(options, step, angstrom);
            let plan = planned(&coarser).ok()?;
            let spacing = rounded_up(plan.spacing, angstrom);
            let (fixed, per_rotation) = needs(&plan.with_spacing(spacing).ok()?);
            (fixed + per_rotation <= allowed).then_some(KernelOptions {
                spacing: Some(spacing),
                ..coarser.kernel
            })
        });
        return Err(SearchError::Memory {
            needed: fixed + per_rotation,
            allowed,
            spacing: fits.as_ref().and_then(|coarser| coarser.spacing),
            shows_little: fits
                .as_ref()
                .is_some_and(|coarser| coarser.resolution > 3.0 * options.kernel.resolution),
            resolution: fits
                .as_ref()
                .map(|coarser| coarser.resolution)
                .filter(|&resolution| resolution > options.kernel.resolution),
            pass_length: fits
                .and_then(|coarser| coarser.pass_length)
                .filter(|&length| Some(length) > options.kernel.pass_length),
        });
    }
    let graphics_bytes = match options.search.engine {
        EngineChoice::Cpu => 0,
        EngineChoice::Gpu => {
            let taken = fixed + in_flight as u64 * per_rotation;
            let left = options
                .machine
                .memory
                .map(|allowed| allowed.saturating_sub(taken));
            left.unwrap_or(u64::MAX).min(GRAPHICS_BYTES)
        }
    };
    let rings = options.search.symmetry.map(|symmetry| Rings {
        symmetry,
        axis: ring_axis,
    });
    let (set, set_name, covering_radius) = match &rings {
        Some(rings) => {
            let (axes, radius) = rings.axes(options.search.rotations);
            let rotation = |axis| rings.symmetry.rotation(axis);
            let name = match rings.axis {
                Some(_) => "axes across the ring's own",
                None => "axes over a half sphere",
            };
            (axes.iter().map(rotation).collect(), name, radius)
        }
        None => {
            let set = rotation_set(options.search.rotations);
            let radius = covering_radius(&set);
            (set, set_name(options.search.rotations), radius)
        }
    };
    let fine_set = options
        .search
        .fine_rotations
        .map_or_else(Vec::new, spiral_set);
    let (a, b) = match &engine.basis {
        knotdock_scoring::lifted_axis::RadiusBasis::Classes { receptor, ligand } => {
            (receptor.len(), ligand.len())
        }
        _ => engine.basis.sizes(&engine.axis),
    };
    Ok(DockPlan {
        unit,
        angstrom,
        rotations: options.search.rotations,
        rotation_set: set_name,
        covering_radius_degrees: covering_radius.to_degrees(),
        grid: engine.size(),
        spacing: engine.spacing,
        fine_grid: engine.fine,
        spreading_width: engine.width,
        modes: engine.modes.count,
        lifted_modes: engine.axis.modes(),
        kernel_reach: engine.kernel.reach(),
        pass_frequency: 1.0 / engine.options.kernel.pass_length,
        stop_frequency: engine.kernel.stop(),
        radii: [a, b],
        in_flight,
        fixed_bytes: fixed,
        bytes_in_flight: per_rotation,
        graphics_bytes,
        decisions,
        attracted,
        labels,
        loose,
        rings,
        engine: Arc::new(engine),
        options: options.clone(),
        receptor,
        ligand,
        set,
        fine_set,
    })
}

/// Bytes of a finer search: its rotations with their cells, and the peaks of those searched, as found and as sorted.
fn fine_bytes(options: &DockOptions) -> u64 {
    let finer = options.search.fine_rotations.unwrap_or(0);
    let searched = (options.search.fine_share * finer as f64).ceil() as u64;
    64 * finer as u64 + 3 * size_of::<Peak>() as u64 * searched * options.search.per_rotation as u64
}

/// What fits at the least of 60 ever coarser steps, found by halving. From the coarse end, where a plan takes least: its time falls with the square of the resolution,
/// so that all plans together take three times what the finest does.
fn least_coarse<T>(at: impl Fn(i32) -> Option<T>) -> Option<T> {
    let (mut least, mut last) = (0, 59);
    let mut fits = at(last)?;
    while least < last {
        let middle = (least + last) / 2;
        match at(middle) {
            Some(coarse) => (fits, last) = (coarse, middle),
            None => least = middle + 1,
        }
    }
    Some(fits)
}

/// The options with the grid that their resolution calls for and, from the second step on, a resolution coarser by a tenth each: a grid
/// too coarse for the resolution is small as well, but its scores are wrong.
fn coarser(options: &DockOptions, step: i32, angstrom: f64) -> DockOptions {
    let resolution = match step {
        0 => options.kernel.resolution,
        _ => rounded_up(options.kernel.resolution * 1.1f64.powi(step), angstrom),
    };
    let scale = resolution / options.kernel.resolution;
    options.changed(|options| {
        options.kernel.resolution = resolution;
        if step > 0 {
            let length = &mut options.kernel.pass_length;
            *length = length.map(|length| rounded_up(scale * length, angstrom));
        }
        options.kernel.spacing = None;
    })
}

/// A spacing rounded up to hundredths of an Ångström, or of the power of ten below what plays its part.
fn rounded_up(spacing: f64, angstrom: f64) -> f64 {
    let per_unit = 10f64.powi(2 - angstrom.log10().floor() as i32);
    (spacing * per_unit).ceil() / per_unit
}

impl DockPlan {
    /// The knots that are docked, of receptor and ligand.
    pub fn knots(&self) -> [&Knots; 2] {
        [&self.receptor, &self.ligand]
    }

    /// A rotation by its index, those of the finer set after those of the coarse one, and which half-turn of the first of its four it is.
    pub(crate) fn rotation(&self, index: usize) -> (UnitQuaternion<f64>, HalfTurn) {
        if self.options.search.symmetry.is_some() {
            return (self.set[index], HalfTurn::None);
        }
        match index.checked_sub(self.set.len()) {
            None => (self.set[index], HalfTurn::ALL[index % 4]),
            Some(fine) => (self.fine_set[fine], HalfTurn::ALL[fine % 4]),
        }
    }

    /// Balls of receptor and ligand that the resolution is too coarse to tell from points.
    pub fn unresolved(&self) -> [usize; 2] {
        [&self.receptor, &self.ligand].map(|knots| self.engine.unresolved(knots).len())
    }

    /// The exact sum of what is ranked.
    ///
    /// # Errors
    /// [`SearchError::Knots`] on knots that cannot be summed.
    pub fn exact_scorer(&self) -> Result<ExactScorer, SearchError> {
        Ok(ExactScorer::with_effects(
            &self.engine.kernel,
            &self.receptor,
            &self.ligand,
            &self.engine.effects,
        )?)
    }

    /// Number of poses to refine: of rings all, for none lies on the grid.
    pub fn refined(&self) -> usize {
        if self.options.search.symmetry.is_some() {
            return self.options.search.poses;
        }
        let alone = self
            .decisions
            .iter()
            .all(|decision| decision.effect == Effect::Shape || !decision.on);
        self.options
            .search
            .refine
            .unwrap_or(if alone { REFINED_BY_SHAPE } else { 0 })
    }

    /// What poses are rescored with; `None` where there is nothing to ask.
    pub(crate) fn rescorer(&self) -> Option<Rescorer> {
        let bodies = [&self.receptor, &self.ligand];
        self.asked()
            .rescorer(bodies, &self.attracted, &self.loose, &self.options)
    }

    /// The active site that the partner of a peptidase is assumed to bind, where one is.
    pub fn active_site(&self) -> Option<&AssumedSite> {
        self.attracted.assumed.as_ref()
    }

    /// What poses are asked beside their score.
    pub(crate) fn asked(&self) -> Asked {
        Asked::of(&self.decisions, &self.attracted, &self.loose, &self.options)
    }

    /// Rotations that would be in flight if there were more than enough of them.
    pub(crate) fn most_in_flight(&self) -> usize {
        most_in_flight(&self.options, self.fixed_bytes, self.bytes_in_flight)
    }

    /// Whether an effect is on.
    pub fn is_on(&self, effect: Effect) -> bool {
        self.decisions.iter().any(|d| d.effect == effect && d.on)
    }

    /// Bytes that the run is expected to take at its peak.
    pub fn memory_bytes(&self) -> u64 {
        self.fixed_bytes + self.in_flight as u64 * self.bytes_in_flight + self.graphics_bytes
    }
}

/// Rotations in flight: as many as threads, where memory has room for them.
fn most_in_flight(options: &DockOptions, fixed: u64, per_rotation: u64) -> usize {
    let threads = options.machine.threads.count();
    let room = options.machine.memory.map_or(u64::MAX, |allowed| {
        allowed.saturating_sub(fixed) / per_rotation.max(1)
    });
    threads.min(usize::try_from(room).unwrap_or(usize::MAX))
}

impl std::fmt::Display for DockPlan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Three significant digits or so, two decimals of an Ångström.
        let below = -self.angstrom.log10().floor() as i32;
        let (digits, finer) = ((2 + below).max(0) as usize, (3 - below).max(0) as usize);
        let rotations = match self.options.search.symmetry {
            Some(symmetry) => format!("axes of {symmetry}"),
            None if self.rotations == 1 => "rotation".to_owned(),
            None => "rotations".to_owned(),
        };
        write!(
            f,
            "{} {rotations} ({:.1} degrees covering radius), grid {} x {} x {} at {:.digits$} {unit}, {} modes below {:.finer$} per {unit}, \
             window of {} on {} x {} x {}, lifted axis -{K}..{K}; about {:.0} MB with {} in flight",
            self.rotations,
            self.covering_radius_degrees,
            self.grid[0],
            self.grid[1],
            self.grid[2],
            self.spacing,
            self.modes,
            self.engine.modes.cut,
            self.spreading_width,
            self.fine_grid[0],
            self.fine_grid[1],
            self.fine_grid[2],
            self.memory_bytes() as f64 / 1e6,
            self.in_flight,
            K = self.lifted_modes,
            unit = self.unit,
            digits = digits,
            finer = finer,
        )?;
        if self.options.search.precision == Precision::Double {
            write!(f, "; in double precision")?;
        }
        if self.options.search.engine == EngineChoice::Gpu {
            write!(f, "; on a graphics processor")?;
        }
        if let Some(finer) = self.options.search.fine_rotations {
            write!(
                f,
                "; then about {:.0}% of {finer} finer rotations, about the best",
                100.0 * self.options.search.fine_share
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::dock::plan::*;
    use std::cell::Cell;

    /// Each step was planned twice, from the finest on: refusing --resolution 0.1 took half a minute.
    #[test]
    fn the_least_coarse_step_that_fits_is_found_with_few_plans() {
        for first in [0, 1, 17, 59] {
            let plans = Cell::new(0);
            let found = least_coarse(|step| {
                plans.set(plans.get() + 1);
                (step >= first).then_some(step)
            });
            assert_eq!(found, Some(first));
            assert!(plans.get() <= 7, "{}", plans.get());
        }
        assert_eq!(least_coarse(|_| None::<i32>), None);
    }
}
