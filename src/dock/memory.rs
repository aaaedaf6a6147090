//! Memory of a run: what it takes, how many rotations fit at once, and the finest grid that would fit.

use crate::dock::scene::Scene;
use crate::error::SearchError;
use crate::options::{DockOptions, EngineChoice, KernelOptions, Precision};
use knotdock_scoring::engine::{CpuEngine, Plan};
use knotdock_scoring::peaks::Peak;
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::so3::{BYTES_RELAXED, MAX_RELAXED};

/// Components of the compressed lifted axis that the estimate allows for.
const EXPECTED_RANK: usize = 8;

/// Bytes that rotations in flight may take of a graphics processor's memory, which may be the computer's own.
const GRAPHICS_BYTES: u64 = 512 << 20;

/// Memory of a run, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct MemoryPlan {
    /// Everything but rotations in flight.
    pub fixed: u64,
    /// A rotation in flight.
    pub per_rotation: u64,
    /// Rotations in flight at once.
    pub in_flight: usize,
    /// Graphics memory that rotations in flight may take; 0 on the CPU.
    pub graphics: u64,
}

impl MemoryPlan {
    /// The memory of a run of `engine`, within the limit of the options.
    ///
    /// # Errors
    /// [`SearchError::Memory`] where not one rotation fits, with the finest grid that would.
    pub fn new(scene: &Scene, engine: &Plan, options: &DockOptions) -> Result<Self, SearchError> {
        let (fixed, per_rotation) = needs(scene, engine, options);
        let in_flight = most_in_flight(options, fixed, per_rotation).min(options.search.rotations);
        if let (0, Some(allowed)) = (in_flight, options.machine.memory) {
            let needed = fixed + per_rotation;
            return Err(too_little(scene, options, (needed, allowed)));
        }
        let graphics = match options.search.engine {
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
        Ok(Self {
            fixed,
            per_rotation,
            in_flight,
            graphics,
        })
    }
}

/// Bytes of everything but rotations in flight, and of one of them.
fn needs(scene: &Scene, engine: &Plan, options: &DockOptions) -> (u64, u64) {
    let (real_bytes, workspace_estimate): (u64, fn(&Plan, usize) -> usize) =
        match options.search.precision {
            Precision::Single => (4, CpuEngine::<f32>::workspace_estimate),
            Precision::Double => (8, CpuEngine::<f64>::workspace_estimate),
        };
    let functions = engine.functions();
    let rank = functions.min(EXPECTED_RANK);
    let per_rotation = workspace_estimate(engine, rank) as u64;
    // The functions, one in the making, and the compressed ones in either order of modes, packed.
    let fixed =
        2 * real_bytes * engine.modes().count as u64 * (functions + 1 + 5 * rank / 2) as u64
            + PotentialGrid::bytes(engine) as u64
            + 200 * (scene.receptor.len() + scene.ligand.len()) as u64
            + 64 * options.search.rotations as u64
            + fine_bytes(options)
            + BYTES_RELAXED * options.search.rotations.min(MAX_RELAXED) as u64
            + 400 * options.search.poses as u64
            + (16 << 20);
    (fixed, per_rotation)
}

/// The error of a run that does not fit, with the finest grid or resolution that would.
fn too_little(scene: &Scene, options: &DockOptions, (needed, allowed): (u64, u64)) -> SearchError {
    let fits = least_coarse(|step| {
        let coarser = coarser(options, step, scene.angstrom);
        let plan = scene.engine_plan(&coarser).ok()?;
        let spacing = rounded_up(plan.spacing(), scene.angstrom);
        let (fixed, per_rotation) = needs(scene, &plan.with_spacing(spacing).ok()?, options);
        (fixed + per_rotation <= allowed).then_some(KernelOptions {
            spacing: Some(spacing),
            ..coarser.kernel
        })
    });
    SearchError::Memory {
        needed,
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
    }
}

/// Number of rotations in flight: as many as threads, where memory has room for them.
pub(super) fn most_in_flight(options: &DockOptions, fixed: u64, per_rotation: u64) -> usize {
    let threads = options.machine.threads.count();
    let room = options.machine.memory.map_or(u64::MAX, |allowed| {
        allowed.saturating_sub(fixed) / per_rotation.max(1)
    });
    threads.min(usize::try_from(room).unwrap_or(usize::MAX))
}

/// Bytes of a finer search: its rotations with their cells, and the peaks found, as found and as sorted.
fn fine_bytes(options: &DockOptions) -> u64 {
    let finer = options.search.fine_rotations.unwrap_or(0);
    let searched = (options.search.fine_share * finer as f64).ceil() as u64;
    64 * finer as u64 + 3 * size_of::<Peak>() as u64 * searched * options.search.per_rotation as u64
}

/// The first of 60 ever coarser steps that fits, found by halving.
///
/// The coarse end is tried first: the time of a plan falls with the square of the resolution, so all plans together
/// take three times as long as the finest.
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

/// The options with the grid that their resolution needs and, from the second step on, a resolution coarser by a tenth
/// a step. A grid too coarse for its resolution would be small, too, but its scores would be wrong.
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

/// A spacing rounded up to hundredths of an Ångström, or of the power of ten below its counterpart.
fn rounded_up(spacing: f64, angstrom: f64) -> f64 {
    let per_unit = 10f64.powi(2 - angstrom.log10().floor() as i32);
    (spacing * per_unit).ceil() / per_unit
}

#[cfg(test)]
mod tests {
    use super::*;
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
