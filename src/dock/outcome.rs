//! Outcome of a docking run: ranked poses, the plan it followed, the errors it measured and its cost.

use crate::options::Stopped;
use crate::rank::cluster::ClusterFigures;
use crate::rank::ranking::RankedPose;
use crate::rank::sharp::{Evidence, SharpFinding};
use crate::search::coarse_to_fine::FineSearched;
use crate::search::scan_engine::Adapter;
use knotdock_scoring::exact::ScoreTerms;
use knotdock_scoring::peaks::Peak;
use knotdock_scoring::terms::effect::Effect;
use serde::Serialize;

/// The fast path's error as measured in this run, relative to the best exact score; infinite if no pose scores
/// anything.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeasuredError {
    /// Grid poses over which it was measured.
    pub poses: usize,
    /// Root mean square of |fast - exact| / |best exact score|.
    pub rms: f64,
    /// Largest of the same.
    pub worst: f64,
    /// Mean share of the unfiltered shape score that the low-pass removed over the same poses, |G - G_unfiltered| /
    /// |best exact score|.
    pub low_pass_share: f64,
}

/// Scores below this are none: a pair of balls that touch earns about one.
const NOTHING: f64 = 1e-6;

/// What errors of scores are shares of: the best score, or the largest magnitude where nothing scores above zero by
/// more than `ringing` of that. Transforms ring about zero by their tolerance where no pose scores (lambda = 0, or no
/// skin); exact sums do not.
pub(crate) fn error_scale(scores: impl IntoIterator<Item = f64>, ringing: f64) -> f64 {
    let (best, largest) = scores
        .into_iter()
        .fold((0.0f64, 0.0f64), |(best, largest), score| {
            (best.max(score), largest.max(score.abs()))
        });
    if best > ringing * largest {
        best
    } else {
        largest
    }
}

impl MeasuredError {
    /// The error at the best grid poses, relative to the best exact score. Their exact scores and their unfiltered
    /// ones are given in the same order.
    pub(crate) fn over(
        peaks: &[Peak],
        (exact, unfiltered): (&[ScoreTerms], &[f64]),
        best: f64,
    ) -> Self {
        let poses = peaks.len().min(exact.len());
        if best < NOTHING {
            return Self {
                poses,
                rms: f64::INFINITY,
                worst: f64::INFINITY,
                low_pass_share: f64::INFINITY,
            };
        }
        let (mut squares, mut worst, mut removed) = (0.0, 0.0f64, 0.0);
        for ((peak, exact), unfiltered) in peaks.iter().zip(exact).zip(unfiltered) {
            let error = (peak.score - exact.score).abs() / best;
            squares += error * error;
            worst = worst.max(error);
            removed += (exact.terms[Effect::Shape as usize] - unfiltered).abs() / best;
        }
        Self {
            poses,
            rms: (squares / poses.max(1) as f64).sqrt(),
            worst,
            low_pass_share: removed / poses.max(1) as f64,
        }
    }
}

/// Cost of one term of the score.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectCost {
    /// The term.
    pub effect: Effect,
    /// Whether it was on.
    pub on: bool,
    /// Why it was on or off.
    pub reason: String,
    /// Its part of the compressed functions; the parts of all effects add up to the run's rank.
    pub functions: f64,
    /// Its part of the milliseconds of a rotation, by its functions: of processor time, or on the clock where a graphics
    /// processor searched.
    #[serde(skip)]
    pub milliseconds_per_rotation: f64,
}

/// Time of one stage of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StageTime {
    /// Name of the stage.
    pub name: &'static str,
    /// Wall-clock seconds.
    pub wall_seconds: f64,
    /// CPU seconds of the whole process, where the system reports them.
    pub cpu_seconds: Option<f64>,
}

/// What the sharp stage saw.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SharpOutcome {
    /// Whether an exact fit is far ahead, by which the run is then ranked.
    pub finding: SharpFinding,
    /// The best place against the others; `None` if there are too few places.
    pub evidence: Option<Evidence>,
    /// Standard deviations that the best place lies below the others.
    pub margin: Option<f64>,
    /// Poses that descended to an optimum.
    pub poses: usize,
}

/// All that a docking run found.
#[derive(Clone, Debug)]
pub struct DockOutcome {
    /// Rows of the ranking, best first: one per cluster, or every pose if the options ask for it.
    pub poses: Vec<RankedPose>,
    /// Poses kept before clustering.
    pub poses_kept: usize,
    /// Figures of the clusters by the scores of the fast path, in the order of their numbers.
    pub clusters: Vec<ClusterFigures>,
    /// Rotations of the set that were searched.
    pub searched: usize,
    /// Place where the run, or one that it repeats, stopped for a deadline; `None` if it went to its end.
    pub stopped: Option<Stopped>,
    /// The fast path's error as measured.
    pub error: MeasuredError,
    /// Rank of the compressed functions in use.
    pub rank: usize,
    /// Error of the compressed functions at the probe rotations, relative to their best score.
    pub rank_error: f64,
    /// Cost of each term.
    pub effects: Vec<EffectCost>,
    /// Findings of the sharp stage; `None` if it was off.
    pub sharp: Option<SharpOutcome>,
    /// Coverage of a finer search about the best rotations, if one was requested.
    pub fine: Option<FineSearched>,
    /// Time by stage.
    pub timing: Vec<StageTime>,
    /// The graphics processor that correlated, if one did.
    pub adapter: Option<Adapter>,
    /// Why no graphics processor did, if one was to be taken if it could.
    pub adapter_failure: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reported pose deep in overlap, of -20,000, once set the scale of the errors of a run whose best pose scored
    /// 100: they looked 200 times smaller.
    #[test]
    fn errors_are_shares_of_the_best_score_and_of_magnitudes_only_where_nothing_scores() {
        assert_eq!(error_scale([100.0, 30.0, -20_000.0], 0.0), 100.0);
        assert_eq!(error_scale([-30.0, -20_000.0], 0.0), 20_000.0);
        assert_eq!(error_scale([-3.0, 1e-9, -20_000.0], 1e-2), 20_000.0);
        assert_eq!(error_scale([], 1e-2), 0.0);
    }
}
