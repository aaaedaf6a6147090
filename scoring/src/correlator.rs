//! The front door: one pair of knot sets, correlated over all translations at one rotation at a time.
//!
//! [`Correlator::new`] plans the correlation, transforms the receptor, picks the rank of the lifted axis that the
//! tolerance needs, and allocates the buffers. It then measures the error against the exact sum. A score that cancels
//! between pairs (lambda near 1, thin skins, balls much larger than their skin) misses the tolerance on the usual plan,
//! and is planned anew for a finer one. [`Correlator::correlate`] allocates nothing. Programs that search
//! many rotations on many threads use the parts themselves: one [`CpuEngine`] and one [`Workspace`] a thread.
//!
//! # Conventions
//!
//! A pose takes a ligand knot at y to R y + t in the receptor's frame. Lengths are in Å, a higher score is better. The
//! grid is (nx, ny, nz) row-major; a voxel is one translation.

use crate::engine::{
    ChosenRank, CpuEngine, EngineOptions, Plan, PlanError, ReceptorSpectra, Workspace, choose_rank,
    measured_error,
};
use crate::exact::ExactScorer;
use crate::peaks::{Peak, PeakLimits, ScoreGrid};
use crate::potential_grid::PotentialGrid;
use crate::precision::Precision;
use crate::quantity::Quantity;
use crate::se3::Pose;
use crate::so3::rotation_set;
use crate::terms::effect::Term;
use knotdock_structures::Knots;
use nalgebra::UnitQuaternion;
use std::sync::Arc;

/// Rotations from which the choice of the rank takes its probes.
const PROBE_SET: usize = 60;
/// Largest tolerance of a plan.
const MAX_TOLERANCE: f64 = 0.1;
/// Plans that are tried for a tolerance.
const MAX_PLANS: usize = 3;
/// Most points of a finer plan's grid, in those of the first.
const MAX_GROWTH: usize = 32;
/// Largest departure of a rotation's norm from 1.
const NORM_TOLERANCE: f64 = 1e-6;

/// Why a pair cannot be correlated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CorrelatorError {
    /// No plan can be made of these knots and options.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The tolerance is below what the floating-point type resolves.
    #[error(
        "a tolerance of {tolerance:e} is finer than this precision allows; use {finest:e} or more, or Precision::Double in Rust"
    )]
    Precision {
        /// The tolerance.
        tolerance: f64,
        /// The finest one of this precision.
        finest: f64,
    },
    /// The error that was measured against the exact sum is above the tolerance.
    #[error(
        "the fast path is off by {reachable:.1e} of the best score, more than the tolerance of {tolerance:e}; {remedy}"
    )]
    Unreachable {
        /// The tolerance.
        tolerance: f64,
        /// The error, as a share of the best score.
        reachable: f64,
        /// Options that serve.
        remedy: String,
    },
    /// A rotation is no unit quaternion.
    #[error("a rotation has the norm {0}; it must be a unit quaternion")]
    Rotation(f64),
}

/// A pair of knot sets, ready to be correlated: receptor, ligand, plan, spectra, engine and workspace.
///
/// [`Self::new`] makes it in single precision, which serves tolerances down to 1e-4.
pub struct Correlator {
    ligand: Knots,
    plan: Arc<Plan>,
    spectra: ReceptorSpectra,
    engine: CpuEngine,
    exact: Arc<ExactScorer>,
    rank_error: f64,
    error: f64,
    workspace: Workspace,
}

/// A pose of the translation grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridPose {
    /// The pose.
    pub pose: Pose,
    /// Its score.
    pub score: f64,
    /// Its voxel, row-major.
    pub voxel: usize,
}

/// The correlation over all translations at one rotation.
pub struct Correlation<'a> {
    engine: &'a CpuEngine,
    rotation: UnitQuaternion<f64>,
    workspace: &'a mut Workspace,
}

impl Correlator {
    /// Prepares the correlation of two knot sets by shape, in single precision.
    ///
    /// # Errors
    /// [`CorrelatorError`] on knots or options that cannot be used.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        options: &EngineOptions,
    ) -> Result<Self, CorrelatorError> {
        Self::with_terms(receptor, ligand, options, Precision::Single, Vec::new())
    }

    /// Prepares the correlation of two knot sets by shape and further terms, in a precision.
    ///
    /// # Errors
    /// [`CorrelatorError`] on knots, options or terms that cannot be used.
    pub fn with_terms(
        receptor: &Knots,
        ligand: &Knots,
        &options: &EngineOptions,
        precision: Precision,
        terms: Vec<Term>,
    ) -> Result<Self, CorrelatorError> {
        let (tolerance, finest) = (options.tolerance, precision.finest_tolerance());
        if tolerance < finest {
            return Err(CorrelatorError::Precision { tolerance, finest });
        }
        let mut plan = Plan::with_effects(receptor, ligand, options, tolerance, terms.clone())?;
        let points = |plan: &Plan| plan.size().iter().product::<usize>();
        let most_points = MAX_GROWTH.saturating_mul(points(&plan));
        let is_coarse = is_coarse(&plan);
        let mut reachable = f64::INFINITY;
        for _ in 0..MAX_PLANS {
            let planned_for = plan.options().tolerance;
            let found = Self::planned([receptor, ligand], plan, precision)?;
            let error = found.error;
            if error <= tolerance {
                return Ok(found);
            }
            reachable = reachable.min(error);
            // Pairs do not show how far their sum cancels; the error does.
            let finer = (0.5 * planned_for * tolerance / error).max(finest);
            if is_coarse || !error.is_finite() || finer >= planned_for {
                break;
            }
            let options = EngineOptions {
                tolerance: finer,
                ..options
            };
            let next = Plan::with_effects(receptor, ligand, options, finer, terms.clone());
            match next {
                Ok(next) if points(&next) <= most_points => plan = next,
                _ => break,
            }
        }
        Err(CorrelatorError::Unreachable {
            tolerance,
            reachable,
            remedy: remedy(options, is_coarse, reachable),
        })
    }

    /// The correlator of a plan, with its measured error.
    fn planned(
        [receptor, ligand]: [&Knots; 2],
        plan: Plan,
        precision: Precision,
    ) -> Result<Self, CorrelatorError> {
        let plan = Arc::new(plan);
        let spectra = ReceptorSpectra::new(&plan, receptor, ligand, Quantity::Score, precision);
        let probes = rotation_set(PROBE_SET);
        let ChosenRank {
            engine,
            error: rank_error,
            ..
        } = choose_rank(&plan, &spectra, ligand, &probes);
        let exact = ExactScorer::with_effects(plan.kernel(), receptor, ligand, plan.effects())
            .map_err(PlanError::from)?;
        // Other terms and weights below zero reward as well.
        let mut weights = receptor.weights.iter().chain(&ligand.weights);
        let is_rewarded = plan.kernel().rewards()
            || !plan.effects().is_empty()
            || weights.any(|&weight| weight < 0.0);
        let error = measured_error(&engine, &exact, &probes, is_rewarded);
        Ok(Self {
            ligand: ligand.clone(),
            workspace: engine.workspace(),
            plan,
            spectra,
            engine,
            exact: Arc::new(exact),
            rank_error,
            error,
        })
    }

    /// Correlates over all translations at one rotation.
    ///
    /// # Errors
    /// [`CorrelatorError::Rotation`] on a quaternion that is not of norm 1.
    pub fn correlate(
        &mut self,
        rotation: &UnitQuaternion<f64>,
    ) -> Result<Correlation<'_>, CorrelatorError> {
        let norm = rotation.as_ref().norm();
        if norm.is_nan() || (norm - 1.0).abs() > NORM_TOLERANCE {
            return Err(CorrelatorError::Rotation(norm));
        }
        self.engine.correlate(rotation, &mut self.workspace);
        Ok(Correlation {
            engine: &self.engine,
            rotation: *rotation,
            workspace: &mut self.workspace,
        })
    }

    /// The plan: grid, modes and kernel. The tolerance among its options is finer than the requested one if the score
    /// cancels.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Components of the lifted axis and the terms that are in use.
    pub fn rank(&self) -> usize {
        self.engine.rank()
    }

    /// Error of that rank at the best voxels of a few rotations, relative to the best score there.
    pub fn rank_error(&self) -> f64 {
        self.rank_error
    }

    /// Largest error against the exact sum at about 750 voxels of three rotations, relative to the best score there (to
    /// the largest magnitude if the kernel rewards nothing). At most the tolerance; errors elsewhere may be larger.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// The exact pair sum of the same score.
    pub fn exact_scorer(&self) -> Arc<ExactScorer> {
        Arc::clone(&self.exact)
    }

    /// The receptor's sampled potentials, which give the score and its gradient between voxels.
    pub fn potential_grid(&self) -> PotentialGrid {
        PotentialGrid::new(&self.plan, &self.spectra, &self.ligand)
    }
}

impl Correlation<'_> {
    /// Voxels along x, y and z.
    pub fn size(&self) -> [usize; 3] {
        self.engine.plan().size()
    }

    /// Scores of all voxels, (nx, ny, nz) row-major.
    pub fn scores(&self) -> &ScoreGrid {
        &self.workspace.scores
    }

    /// The pose of a voxel.
    pub fn pose(&self, voxel: usize) -> Pose {
        let plan = self.engine.plan();
        let place = plan.receptor_center() + self.engine.position(voxel);
        Pose::about(self.rotation, plan.ligand_center(), place)
    }

    /// The voxel of the best score, the first of equals.
    pub fn best(&self) -> GridPose {
        let scores = self.scores().iter().enumerate();
        let start = (0, f64::NEG_INFINITY);
        let (voxel, score) = scores.fold(
            start,
            |best, next| if next.1 > best.1 { next } else { best },
        );
        self.grid_pose(voxel, score)
    }

    /// Up to `count` of the best voxels, best first, none a neighbour of another ([`crate::peaks`]).
    ///
    /// Takes the correlation, whose scores it overwrites.
    pub fn peaks(self, count: usize) -> Vec<GridPose> {
        let mut found: Vec<Peak> = Vec::new();
        let floor = f64::NEG_INFINITY;
        let scores = &mut self.workspace.scores;
        scores.find_peaks(0, PeakLimits { count, floor }, &mut found);
        let pose = |peak: &Peak| self.grid_pose(peak.voxel as usize, peak.score);
        found.iter().map(pose).collect()
    }

    fn grid_pose(&self, voxel: usize, score: f64) -> GridPose {
        let pose = self.pose(voxel);
        GridPose { pose, score, voxel }
    }
}

/// Whether the grid's spacing is above half of the resolution, which no tolerance fixes.
fn is_coarse(plan: &Plan) -> bool {
    plan.spacing() > 0.5 * plan.options().kernel.resolution * (1.0 + 1e-9)
}

/// Remedy if the fast path misses its tolerance by `error`.
fn remedy(options: EngineOptions, is_coarse: bool, error: f64) -> String {
    if is_coarse {
        let half = 0.5 * options.kernel.resolution;
        return format!("use a spacing of {half} or less, half of the resolution, or none");
    }
    // Twice the error, rounded up to one digit.
    let digit = 10f64.powf((2.0 * error).log10().floor());
    let tolerance = digit * (2.0 * error / digit).ceil();
    if tolerance <= MAX_TOLERANCE {
        format!("use a tolerance of {tolerance:.0e} or more")
    } else {
        "the score cancels to less than the transforms resolve; use a larger offset or another lambda".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Numbers;

    fn cloud(count: usize, spread: f64, seed: u64) -> Knots {
        let mut numbers = Numbers(seed);
        let mut center = || std::array::from_fn(|_| spread * (numbers.next() - 0.5));
        let centers = (0..count).map(|_| center()).collect();
        let radii = (0..count).map(|i| [1.5, 1.7, 1.9][i % 3]).collect();
        Knots::new(centers, radii).unwrap()
    }

    fn some_rotation() -> UnitQuaternion<f64> {
        Pose::from_parts([0.3, -0.2, 0.8, 0.4], [0.0; 3]).rotation
    }

    /// The score of a voxel is the exact sum at its pose.
    #[test]
    fn peaks_have_the_exact_scores_of_their_poses() {
        let (a, b) = (cloud(80, 14.0, 1), cloud(30, 8.0, 2));
        for tolerance in [1e-2, 1e-3] {
            let options = EngineOptions {
                tolerance,
                ..EngineOptions::default()
            };
            let mut correlator = Correlator::new(&a, &b, &options).unwrap();
            assert!(correlator.rank_error() <= tolerance / 3.0);
            let scorer = correlator.exact_scorer();
            let potentials = correlator.potential_grid();
            let correlation = correlator.correlate(&some_rotation()).unwrap();
            let best = correlation.best();
            let found = correlation.peaks(20);
            assert_eq!((found.len(), found[0]), (20, best));
            for peak in found {
                let exact = scorer.score_only(&peak.pose);
                assert!(
                    (exact - peak.score).abs() <= tolerance * best.score,
                    "{exact} {peak:?}"
                );
                let read = potentials.gradient(&peak.pose).0;
                assert!((exact - read).abs() <= 1e-2 * best.score, "{exact} {read}");
            }
        }
    }

    #[test]
    fn refuses_what_it_cannot_correlate() {
        let (a, b) = (cloud(8, 6.0, 3), cloud(5, 4.0, 4));
        let with = |tolerance| EngineOptions {
            tolerance,
            ..EngineOptions::default()
        };
        let single = Correlator::new(&a, &b, &with(1e-5)).err();
        assert!(matches!(single, Some(CorrelatorError::Precision { .. })));
        assert!(Correlator::with_terms(&a, &b, &with(1e-5), Precision::Double, Vec::new()).is_ok());
        let mut bad = b.clone();
        bad.radii[0] = f64::NAN;
        let plan = Correlator::new(&a, &bad, &with(1e-2)).err();
        assert!(matches!(
            plan,
            Some(CorrelatorError::Plan(PlanError::Knots(_)))
        ));
        let mut correlator = Correlator::new(&a, &b, &with(1e-2)).unwrap();
        for norm in [f64::NAN, 0.0, 2.0] {
            let rotation =
                UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(norm, 0.0, 0.0, 0.0));
            let refused = correlator.correlate(&rotation).err();
            assert!(
                matches!(refused, Some(CorrelatorError::Rotation(_))),
                "{norm}"
            );
        }
    }
}
