//! Memory of a run: what it takes, how many rotations fit at once, and the finest grid that would fit.

pub mod process;
pub mod stages;

use crate::dock::scene::Scene;
use crate::memory_size::named;
use crate::memory_size::{as_size, in_words};
use crate::options::{DockOptions, EngineChoice, KernelOptions};
use crate::pose_space::PoseSpace;
use knotdock_scoring::engine::Plan;
use knotdock_structures::Error;
use stages::Sizes;

/// Bytes that rotations in flight may take of a graphics processor's memory, which may be the computer's own.
const GRAPHICS_BYTES: u64 = 512 << 20;

/// Rotations that are ever in flight: more threads than any machine has.
const MAX_IN_FLIGHT: usize = 1 << 16;

/// Memory of a run, in bytes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MemoryPlan {
    sizes: Sizes,
    in_flight: usize,
    allowed: Option<u64>,
    /// Rotations that would be in flight if there were more than enough of them.
    pub most_in_flight: usize,
    /// Graphics memory that rotations in flight may take; 0 on the CPU.
    pub graphics: u64,
    /// The part of it that the run is sure to take.
    taken: u64,
    /// Largest stage of another search of the same run, and its bytes.
    beside: (&'static str, u64),
}

impl MemoryPlan {
    /// The memory of a run of `engine`, within the limit of the options, of which `refined` poses are refined.
    ///
    /// # Errors
    /// [`Error`] where not one rotation fits, with the finest grid that would.
    pub fn new(
        scene: &Scene,
        engine: &Plan,
        options: &DockOptions,
        (space, refined): (&PoseSpace, usize),
    ) -> Result<Self, Error> {
        let sizes = Sizes::new(scene, engine, options, (space, refined));
        let allowed = options.machine.memory;
        let needed = sizes.peak(1);
        if let Some(allowed) = allowed.filter(|&allowed| needed > allowed) {
            let limits = (named(needed), allowed);
            return Err(too_little(scene, options, (space, refined), limits));
        }
        let left = |needed| {
            let left = allowed.map(|allowed| allowed.saturating_sub(needed));
            left.unwrap_or(u64::MAX).min(GRAPHICS_BYTES)
        };
        let engine = options.engine();
        // A card that searches takes its memory first: the cores prepare and rescore, and fewer rotations in flight on them
        // cost little. One that may be there gets what the cores leave.
        let taken = match engine {
            EngineChoice::Gpu => left(needed),
            EngineChoice::Cpu | EngineChoice::Auto => 0,
        };
        let fits = |rotations| {
            let needed = taken + sizes.peak(rotations);
            allowed.is_none_or(|allowed| needed <= allowed)
        };
        let threads = options.machine.thread_count().min(MAX_IN_FLIGHT);
        let most_in_flight = most(threads, fits);
        let graphics = match engine {
            EngineChoice::Auto => left(sizes.peak(most_in_flight)),
            EngineChoice::Cpu | EngineChoice::Gpu => taken,
        };
        Ok(Self {
            sizes,
            in_flight: most_in_flight.min(options.search.rotations),
            allowed,
            most_in_flight,
            graphics,
            taken,
            beside: ("", 0),
        })
    }

    /// Bytes that all but rotations in flight take beyond those held before.
    pub fn fixed(&self) -> u64 {
        self.sizes.fixed()
    }

    /// Bytes of a rotation in flight.
    pub fn per_rotation(&self) -> u64 {
        self.sizes.expected_in_flight()
    }

    /// Rotations in flight at once.
    pub fn in_flight(&self) -> usize {
        self.in_flight
    }

    /// Rotations in flight at the rank that the engine turned out to have, at least one.
    pub fn in_flight_at(&self, rank: usize) -> usize {
        most(self.in_flight(), |count| {
            let needed = self.taken + self.sizes.search_peak(count, rank);
            self.allowed.is_none_or(|allowed| needed <= allowed)
        })
    }

    /// Bytes that the run takes at its peak.
    pub fn bytes(&self) -> u64 {
        self.own_bytes().max(self.beside.1)
    }

    fn own_bytes(&self) -> u64 {
        self.sizes.peak(self.in_flight) + self.taken
    }

    /// The stage that takes the most.
    pub fn largest(&self) -> &'static str {
        match self.beside.1 > self.own_bytes() {
            true => self.beside.0,
            false => self.sizes.largest(self.in_flight).0,
        }
    }

    /// Counts another search of the same run.
    pub fn count_beside(&mut self, other: &Self) {
        self.beside = (other.largest(), other.bytes());
    }
}

/// The largest number from 1 to `limit` that fits, where all below one that fits do; 1 where none does.
fn most(limit: usize, fits: impl Fn(usize) -> bool) -> usize {
    let (mut fitting, mut end) = (1, limit.max(1) + 1);
    while fitting + 1 < end {
        let middle = fitting.midpoint(end);
        if fits(middle) {
            fitting = middle;
        } else {
            end = middle;
        }
    }
    fitting
}

/// The error of a run that does not fit, with the finest grid or resolution that would.
fn too_little(
    scene: &Scene,
    options: &DockOptions,
    refining: (&PoseSpace, usize),
    (needed, allowed): (u64, u64),
) -> Error {
    let fits = least_coarse(|step| {
        let coarser = coarser(options, step, scene.angstrom);
        let plan = scene.engine_plan(&coarser).ok()?;
        let spacing = rounded_up(plan.spacing(), scene.angstrom);
        let plan = plan.with_spacing(spacing).ok()?;
        let sizes = Sizes::new(scene, &plan, &coarser, refining);
        (named(sizes.peak(1)) <= allowed).then_some(KernelOptions {
            spacing: Some(spacing),
            ..coarser.kernel
        })
    });
    let needed_size = as_size(needed);
    let far = "check for atoms or parts far from the rest";
    let remedy = match fits {
        None => format!("allow more with --memory {needed_size}, or {far}"),
        Some(coarser) => {
            let kernel = &options.kernel;
            let mut words = format!("--spacing {}", coarser.spacing.unwrap_or_default());
            if coarser.resolution > kernel.resolution {
                words += &format!(" --resolution {}", coarser.resolution);
            }
            if let Some(length) = coarser.pass_length
                && Some(length) > kernel.pass_length
            {
                words += &format!(" --pass-length {length}");
            }
            if coarser.resolution > 3.0 * kernel.resolution {
                format!(
                    "allow more with --memory {needed_size}, or {far}; {words} would fit, but shows little"
                )
            } else {
                format!("use {words}, allow more with --memory {needed_size}, or {far}")
            }
        }
    };
    Error::input(format!(
        "the run needs {} of memory, and {} are allowed",
        in_words(needed),
        in_words(allowed)
    ))
    .help(remedy)
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

    #[test]
    fn the_most_that_fits_is_found_by_halving() {
        for limit in [1, 2, 3, 17, 1000] {
            for room in [0, 1, 2, 5, 16, 17, 18, 5000] {
                assert_eq!(most(limit, |count| count <= room), room.clamp(1, limit));
            }
        }
    }

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
