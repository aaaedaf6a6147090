//! Scores of one pose: exactly, and from ever more modes with the error and the time of each.

use crate::dock::outcome::error_scale;
use crate::dock::scene::Scene;
use crate::error::{COARSER, no_pose};
use crate::memory_size::in_words;
use knotdock_scoring::Precision;
use knotdock_scoring::engine::{CpuEngine, EngineOptions, Plan, ReceptorSpectra};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::transform::truncation::{ModeOrder, Selection, rms_left_out, total};
use knotdock_scoring::truncated::TruncatedCorrelation;
use knotdock_structures::Error;
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// Modes of the row that every ladder has: the number that B&I's Fig. 9 is about.
pub const STATED_MODES: usize = 4096;
/// Modes of the first row.
const FIRST_MODES: usize = 256;
/// Error, as a share of the exact value or of the scale, at which a ladder ends.
pub const LADDER_ERROR: f64 = 1e-3;
/// Tolerance of the modes: half of the error at which a ladder ends.
const MODE_TOLERANCE: f64 = 5e-4;
/// Step of the finite differences over radii, as a share of the ligand's smallest radius.
const RADIUS_STEP: f64 = 1e-3;

/// Options of scoring a pose.
#[derive(Clone, Copy, Debug)]
pub struct ScoreOptions {
    /// Kernel and grid; the tolerance is that of the run whose kernel is meant.
    pub engine: EngineOptions,
    /// A number of modes that the ladder is to contain.
    pub modes: Option<usize>,
    /// Which modes come first.
    pub order: ModeOrder,
    /// Bytes that all modes may take; nothing for any number.
    pub memory: Option<u64>,
}

/// Bytes of a mode, conjugates counted once, besides those of each function: within a tenth of the measured value.
const BYTES_PER_MODE: u64 = 1040;
/// Bytes that a mode takes for each function of the ligand.
const BYTES_PER_FUNCTION: u64 = 71;

/// One row of the ladder.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Rung {
    /// Modes allowed, conjugates counted.
    pub modes: usize,
    /// Modes kept: they come in groups of up to four.
    pub modes_kept: usize,
    /// The score from these modes.
    pub value: f64,
    /// |value - exact|.
    pub error: f64,
    /// Root mean square over all translations of the score of the modes left out, at this rotation.
    pub rms: f64,
    /// Seconds of a new translation with its gradient, the rotation prepared.
    pub seconds: f64,
    /// Seconds to prepare a rotation.
    pub seconds_prepare: f64,
    /// Seconds of a new rotation with the gradient over rotation and translation.
    pub seconds_new_rotation: f64,
}

/// Derivatives by rho: how score and slices change with all radius sums, per Å. On B&I's r axis they are minus those
/// by r.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OffsetSensitivity {
    /// Derivative of the score, all three slices moved together.
    pub score: f64,
    /// Derivatives of the slices at 0, r0, 2 r0.
    pub slices: [f64; 3],
    /// Derivative of the score by finite differences of the exact sum.
    pub exact_score: f64,
    /// Derivatives of the slices by finite differences.
    pub exact_slices: [f64; 3],
}

/// Gradient of the exact score: per Å, and per radian about the ligand's centre.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Gradient {
    /// Over the translation.
    pub force: [f64; 3],
    /// Over the rotation.
    pub torque: [f64; 3],
}

/// Scores of one pose.
#[derive(Clone, Debug, Serialize)]
pub struct PoseScore {
    /// The exact sum over all pairs, of all effects that are on.
    pub exact: f64,
    /// Its weighted terms by the effect's name.
    pub terms: BTreeMap<&'static str, f64>,
    /// The largest score over all translations of the grid at this rotation, from all modes; if nothing scores above
    /// zero, the largest magnitude instead.
    pub scale: f64,
    /// The ladder, by rising number of modes.
    pub rows: Vec<Rung>,
    /// Whether the last row's error is below [`LADDER_ERROR`] of exact value or scale.
    pub reached: bool,
    /// All modes of the correlation, conjugates counted.
    pub modes_total: usize,
    /// Exact unweighted sums at offsets 0, r0, 2 r0.
    pub slices: [f64; 3],
    /// B&I's own sum of shape, without the low-pass.
    pub unfiltered: f64,
    /// Exact gradient.
    pub gradient: Gradient,
    /// The same from all modes.
    pub gradient_modes: Gradient,
    /// Sensitivity to the offset; `None` for the product kernel, which has no lifted axis.
    pub offset_sensitivity: Option<OffsetSensitivity>,
}

/// Scores one pose.
///
/// # Errors
/// [`Error`] on knots or options that cannot be used.
pub fn score(scene: &Scene, pose: &Pose, options: &ScoreOptions) -> Result<PoseScore, Error> {
    let (receptor, ligand) = (&scene.receptor, &scene.ligand);
    let plan = plan(scene, options)?;
    let scorer = ExactSum::of(&plan, receptor, ligand)?;
    let exact = scorer.score(pose);
    let whole = correlations(&plan, receptor, ligand);
    let [(spectra, first), by_offset @ ..] = whole.as_slice() else {
        return Err(no_pose());
    };
    let mut work = first.workspace();
    let magnitudes = first
        .prepare(&pose.rotation, &mut work)
        .magnitudes(plan.modes().count);
    let scale = scale(&plan, spectra, ligand, pose);
    let ladder = Ladder {
        plan: &plan,
        spectra,
        ligand,
        magnitudes: &magnitudes,
        exact: exact.score,
        limit: LADDER_ERROR * exact.score.abs().max(scale),
    };
    let rows = ladder.rows(pose, options);
    let reached = rows.last().is_some_and(|row| row.error < ladder.limit);
    let mut slices = [0.0; 3];
    for (slice, (_, correlation)) in slices.iter_mut().zip(by_offset) {
        *slice = correlation.gradient(pose, &mut work).0;
    }
    let gradient = |(_, gradient): (f64, knotdock_scoring::exact::PoseGradient)| Gradient {
        force: gradient.force.into(),
        torque: gradient.torque.into(),
    };
    let mut offset_sensitivity = None;
    if scene.skin.is_none() {
        let (exact_score, exact_slices) = exact_sensitivity(&plan, receptor, ligand, pose)?;
        let weighted = slices.iter().zip(plan.options().kernel.slice_weights());
        offset_sensitivity = Some(OffsetSensitivity {
            score: weighted.map(|(s, weight)| s * weight).sum(),
            slices,
            exact_score,
            exact_slices,
        });
    }
    let on = scene.decisions.iter().filter(|decision| decision.on);
    let effects = on.map(|decision| decision.effect);
    let terms = effects.map(|effect| (effect.name(), exact.terms[effect as usize]));
    Ok(PoseScore {
        exact: exact.score,
        terms: terms.collect(),
        scale,
        rows,
        reached,
        modes_total: total(plan.modes()),
        slices: exact.slices,
        unfiltered: exact.unfiltered,
        gradient: gradient(scorer.gradient(pose)),
        gradient_modes: gradient(first.gradient(pose, &mut work)),
        offset_sensitivity,
    })
}

/// Spectra and correlations, from all modes, of the score and of the slices by offset.
fn correlations(
    plan: &Plan,
    receptor: &Knots,
    ligand: &Knots,
) -> Vec<(ReceptorSpectra, TruncatedCorrelation)> {
    let all = Selection::all(plan.modes());
    let correlated = |quantity: Quantity| {
        let spectra = ReceptorSpectra::new(plan, receptor, ligand, quantity, Precision::Double);
        let correlation = TruncatedCorrelation::new(plan, &spectra, ligand, &all);
        (spectra, correlation)
    };
    let quantities = [
        Quantity::Score,
        Quantity::SliceByOffset(0),
        Quantity::SliceByOffset(1),
        Quantity::SliceByOffset(2),
    ];
    quantities.into_par_iter().map(correlated).collect()
}

/// The plan whose modes are accurate enough for a ladder.
///
/// # Errors
/// [`Error`] on knots or options that cannot be used, and when all modes take more memory than is allowed.
fn plan(scene: &Scene, options: &ScoreOptions) -> Result<Arc<Plan>, Error> {
    let kernel_tolerance = options.engine.tolerance;
    let fine = EngineOptions {
        tolerance: kernel_tolerance.min(MODE_TOLERANCE),
        ..options.engine
    };
    let plan = scene.plan_of(fine, kernel_tolerance)?;
    let bytes_per_mode = BYTES_PER_MODE + BYTES_PER_FUNCTION * plan.functions() as u64;
    let count = plan.modes().count;
    let needed = bytes_per_mode * count as u64;
    match options.memory.filter(|&allowed| needed > allowed) {
        Some(allowed) => {
            let [needed, allowed] = [needed, allowed].map(in_words);
            let message =
                format!("{count} modes need {needed} of memory, and {allowed} are allowed");
            Err(Error::input(message).help(COARSER))
        }
        None => Ok(Arc::new(plan)),
    }
}

/// Inputs of a ladder of modes.
struct Ladder<'a> {
    plan: &'a Plan,
    spectra: &'a ReceptorSpectra,
    ligand: &'a Knots,
    /// Magnitudes of all modes at the pose's rotation.
    magnitudes: &'a [f64],
    /// The exact score.
    exact: f64,
    /// Error at which the ladder ends.
    limit: f64,
}

impl Ladder<'_> {
    /// Rows by rising number of modes, up to the first with a small enough error that contains the requested numbers.
    fn rows(&self, pose: &Pose, options: &ScoreOptions) -> Vec<Rung> {
        let modes = self.plan.modes();
        let last_requested = STATED_MODES.max(options.modes.unwrap_or(0));
        let mut rows = Vec::new();
        for most in rungs(total(modes), options.modes) {
            let selection = match options.order {
                ModeOrder::LowFrequency => Selection::low_frequency(modes, most),
                ModeOrder::Magnitude => Selection::by_magnitude(modes, self.magnitudes, most),
            };
            let row = self.row(most, &selection, pose);
            rows.push(row);
            if row.error < self.limit && most >= last_requested {
                break;
            }
        }
        rows
    }

    /// The row of the chosen modes, `most` allowed.
    fn row(&self, most: usize, selection: &Selection, pose: &Pose) -> Rung {
        let few = TruncatedCorrelation::new(self.plan, self.spectra, self.ligand, selection);
        let mut work = few.workspace();
        let prepared = few.prepare(&pose.rotation, &mut work);
        let (value, _) = prepared.gradient(&pose.translation, &mut work);
        Rung {
            modes: most,
            modes_kept: few.modes(),
            value,
            error: (value - self.exact).abs(),
            rms: rms_left_out(self.plan.modes(), selection, self.magnitudes),
            seconds: seconds(|| prepared.gradient(&pose.translation, &mut work).0),
            seconds_prepare: seconds(|| few.prepare(&pose.rotation, &mut work).modes() as f64),
            seconds_new_rotation: seconds(|| few.gradient(pose, &mut work).0),
        }
    }
}

/// Numbers of modes: doubling from `FIRST_MODES`, with the stated number, the requested one, and all.
fn rungs(total: usize, requested: Option<usize>) -> Vec<usize> {
    let doubled = std::iter::successors(Some(FIRST_MODES), |modes| modes.checked_mul(2));
    let doubled = doubled.take_while(|&modes| modes < total);
    let mut rungs: Vec<usize> = doubled
        .chain([STATED_MODES, total])
        .chain(requested)
        .collect();
    rungs.sort_unstable();
    rungs.dedup();
    rungs
}

/// Largest score of the grid at the pose's rotation.
fn scale(plan: &Arc<Plan>, spectra: &ReceptorSpectra, ligand: &Knots, pose: &Pose) -> f64 {
    let engine = CpuEngine::new(Arc::clone(plan), spectra, ligand, spectra.full_rank());
    let mut work = engine.workspace();
    engine.correlate(&pose.rotation, &mut work);
    error_scale(work.scores.iter(), plan.options().tolerance)
}

/// Derivatives of score and slices by rho, by central differences of the exact sum.
///
/// Growing the ligand's radii by h moves every radius sum as an offset of h does.
fn exact_sensitivity(
    plan: &Plan,
    receptor: &Knots,
    ligand: &Knots,
    pose: &Pose,
) -> Result<(f64, [f64; 3]), KnotsError> {
    let smallest = ligand.radii.iter().copied().fold(f64::INFINITY, f64::min);
    let h = RADIUS_STEP * smallest;
    let grown = |by: f64| {
        let mut ligand = ligand.clone();
        for radius in &mut ligand.radii {
            *radius += by;
        }
        ExactScorer::new(plan.kernel(), receptor, &ligand).map(|scorer| scorer.score(pose))
    };
    let (more, less) = (grown(h)?, grown(-h)?);
    let slope = |a: f64, b: f64| (a - b) / (2.0 * h);
    let slices = [0, 1, 2].map(|i| slope(more.slices[i], less.slices[i]));
    // Shape alone: no other term depends on radii.
    Ok((slope(more.score, less.score), slices))
}

/// Median seconds of a call over as many as fit into some hundredths of a second, at least three.
fn seconds(mut call: impl FnMut() -> f64) -> f64 {
    let mut time = || {
        let start = Instant::now();
        std::hint::black_box(call());
        start.elapsed().as_secs_f64()
    };
    let first = time();
    let count = (0.02 / first.max(1e-9)).clamp(3.0, 301.0) as usize;
    let mut times: Vec<f64> = (0..count).map(|_| time()).collect();
    times.sort_by(f64::total_cmp);
    times.get(count / 2).copied().unwrap_or(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ladders_contain_what_they_must() {
        assert_eq!(rungs(3000, None), [256, 512, 1024, 2048, 3000, 4096]);
        assert_eq!(
            rungs(9000, Some(77)),
            [77, 256, 512, 1024, 2048, 4096, 8192, 9000]
        );
        assert_eq!(rungs(10, Some(4096)), [10, 4096]);
    }
}
