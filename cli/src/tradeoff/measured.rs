//! Measurements of each setting of a sweep.
//!
//! - **Time** by stage, on the clock and of all processors.
//! - **Error** of the fast path: against the setting's own exact sum, over its 100 best grid poses, as every docking
//!   run measures it.
//! - **Definition**: some settings change what is summed. The *reference score* is the exact sum at the default's
//!   resolution and sampling and at the finest tolerance, whose kernel is cut off last. A setting's exact sum is set
//!   against it at the poses that the reference ranks first.
//! - **Agreement**: the share of the reference's first 100 rows that have one of the setting's first 100 rows within
//!   the radius of clusters.
//! - **Ranks** of near poses, where a known complex is given.

use serde::Serialize;

use crate::tradeoff::settings::{Refused, Setting};
use knotdock::dock::outcome::{MeasuredError, StageTime};
use knotdock::options::DockOptions;
use knotdock::rank::cluster::RigidBody;
use knotdock_scoring::se3::Pose;

/// Rows whose agreement is measured.
pub const FIRST: usize = 100;

/// Ranks of poses near the known complex, by rows of its table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NativeRanks {
    /// Rank of the first acceptable pose ([`Criterion`](knotdock::evaluate::Criterion)).
    pub first_acceptable: Option<usize>,
    pub first_near_native: Option<usize>,
    /// Acceptable poses among the first 100.
    pub acceptable: usize,
    pub near_native: usize,
}

/// Measured cost and quality of a setting.
#[derive(Clone, Debug)]
pub struct Measured {
    pub setting: Setting,
    /// Grid points per axis.
    pub grid: [usize; 3],
    pub spacing: f64,
    /// Modes kept in three dimensions, conjugates not counted.
    pub modes: usize,
    /// Rank of the lifted axis.
    pub rank: usize,
    /// Width of the spreading window.
    pub spreading_width: usize,
    pub refined: usize,
    /// Time by stage; the search's own stages after sampling and planning.
    pub timing: Vec<StageTime>,
    /// The fast path's error against the exact sum.
    pub error: MeasuredError,
    /// Root mean square of the exact sum against the reference score, as a share of its best.
    pub definition_rms: f64,
    /// Correlation of the two; `None` where either does not vary.
    pub definition_correlation: Option<f64>,
    /// Share of the reference's first rows found again.
    pub agreement: f64,
    pub native: Option<NativeRanks>,
    /// Whether no other setting with the default's score has a smaller error in less time.
    pub front_error: bool,
    /// Whether no other setting finds more of the reference's rows in less time.
    pub front_agreement: bool,
}

impl Measured {
    /// Seconds of all stages: on the clock.
    pub fn wall_seconds(&self) -> f64 {
        self.timing.iter().map(|stage| stage.wall_seconds).sum()
    }

    /// Seconds of all stages and processors, where the system reports them.
    pub fn cpu_seconds(&self) -> Option<f64> {
        self.timing.iter().map(|stage| stage.cpu_seconds).sum()
    }

    /// Cost of a setting: processor seconds, which other programs disturb little, or else seconds on the clock.
    pub fn cost(&self) -> f64 {
        self.cpu_seconds().unwrap_or_else(|| self.wall_seconds())
    }

    /// Whether it ranks by the default's score: the same resolution and sampling.
    pub fn same_score(&self, default: &DockOptions) -> bool {
        let options = &self.setting.options;
        (
            options.kernel.resolution,
            options.kernel.pass_length,
            options.sampling.sample_grid,
        ) == (
            default.kernel.resolution,
            default.kernel.pass_length,
            default.sampling.sample_grid,
        )
    }
}

#[derive(Clone, Debug)]
pub struct Tradeoff {
    /// The settings that ran: the default, the reference, then in the order of [`super::settings::settings`].
    pub measured: Vec<Measured>,
    /// Those that did not.
    pub refused: Vec<Refused>,
    /// Radius of agreement, in the unit of lengths.
    pub radius: f64,
    /// Whether a known complex was given.
    pub with_native: bool,
}

/// Share of `reference` poses with one of `found` within an RMSD of `radius`; 1 if there are none.
pub fn agreement(body: &RigidBody, reference: &[Pose], found: &[Pose], radius: f64) -> f64 {
    if reference.is_empty() {
        return 1.0;
    }
    let found: Vec<_> = found.iter().map(|pose| body.place(pose)).collect();
    let hits = reference.iter().filter(|pose| {
        let placed = body.place(pose);
        found
            .iter()
            .any(|other| body.mean_square(&placed, other) <= radius * radius)
    });
    hits.count() as f64 / reference.len() as f64
}

/// Comparison of two scores over the same poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Root mean square of the difference, as a share of the second's largest magnitude.
    pub rms: f64,
    /// Pearson's correlation; `None` where either does not vary.
    pub correlation: Option<f64>,
}

/// Compares `scores` with `reference`, pose by pose.
pub fn compare(scores: &[f64], reference: &[f64]) -> Comparison {
    let count = scores.len().min(reference.len()).max(1) as f64;
    let pairs = || scores.iter().zip(reference);
    let largest = reference
        .iter()
        .fold(f64::MIN_POSITIVE, |a, b| a.max(b.abs()));
    let squares: f64 = pairs().map(|(a, b)| ((a - b) / largest).powi(2)).sum();
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / count;
    let means = [
        mean(&mut pairs().map(|(a, _)| *a)),
        mean(&mut pairs().map(|(_, b)| *b)),
    ];
    let (mut both, mut first, mut second) = (0.0, 0.0, 0.0);
    for (a, b) in pairs() {
        let (a, b) = ((a - means[0]) / largest, (b - means[1]) / largest);
        both += a * b;
        first += a * a;
        second += b * b;
    }
    let correlation = both / (first * second).sqrt();
    Comparison {
        rms: (squares / count).sqrt(),
        correlation: correlation
            .is_finite()
            .then_some(correlation.clamp(-1.0, 1.0)),
    }
}

/// Whether each (cost, loss) pair is on the front: no other is at most as large in both and smaller in one. Pairs
/// without a finite loss are never on it and beat nothing.
pub fn front(pairs: &[(f64, Option<f64>)]) -> Vec<bool> {
    let finite = |&(cost, loss): &(f64, Option<f64>)| {
        let loss = loss.filter(|loss| loss.is_finite())?;
        cost.is_finite().then_some((cost, loss))
    };
    let known: Vec<(f64, f64)> = pairs.iter().filter_map(finite).collect();
    pairs
        .iter()
        .map(|pair| {
            finite(pair).is_some_and(|(cost, loss)| {
                !known.iter().any(|&(other_cost, other_loss)| {
                    other_cost <= cost
                        && other_loss <= loss
                        && (other_cost < cost || other_loss < loss)
                })
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn agreement_is_the_share_that_has_a_neighbour() {
        let body = RigidBody::new(&[[0.0; 3], [1.0, 0.0, 0.0]]);
        let at = |x: f64| Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
        let reference = [at(0.0), at(10.0), at(20.0), at(30.0)];
        let found = [at(1.0), at(12.5), at(20.0)];
        assert_eq!(agreement(&body, &reference, &found, 2.0), 0.5);
        assert_eq!(agreement(&body, &reference, &found, 2.6), 0.75);
        assert_eq!(agreement(&body, &reference, &reference, 0.0), 1.0);
        assert_eq!(agreement(&body, &reference, &[], 5.0), 0.0);
        assert_eq!(agreement(&body, &[], &[], 5.0), 1.0);
    }

    #[test]
    fn a_scaled_score_correlates_fully_and_differs_all_the_same() {
        let compared = compare(&[2.0, 4.0, 8.0], &[1.0, 2.0, 4.0]);
        assert!((compared.correlation.unwrap() - 1.0).abs() < 1e-12);
        assert!((compared.rms - (21.0f64 / 3.0).sqrt() / 4.0).abs() < 1e-12);
        assert_eq!(compare(&[1.0, 1.0], &[1.0, 2.0]).correlation, None);
        assert_eq!(compare(&[3.0, 1.0], &[3.0, 1.0]).rms, 0.0);
    }

    #[test]
    fn what_is_beaten_is_off_and_what_is_unknown_too() {
        let pairs = [
            (1.0, Some(9.0)),
            (2.0, Some(9.0)),
            (2.0, Some(3.0)),
            (3.0, Some(1.0)),
            (0.5, None),
            (0.5, Some(f64::NAN)),
        ];
        assert_eq!(front(&pairs), [true, false, true, true, false, false]);
        // Equals do not beat each other.
        assert_eq!(front(&[(1.0, Some(1.0)); 2]), [true, true]);
    }

    proptest! {
        /// Nothing beats a pair on the front, and every pair off it is beaten by one on it.
        #[test]
        fn the_front_is_what_nothing_beats(pairs in prop::collection::vec((0..9, 0..9), 1..20)) {
            let pairs: Vec<(f64, Option<f64>)> =
                pairs.into_iter().map(|(cost, loss)| (f64::from(cost), Some(f64::from(loss)))).collect();
            let on = front(&pairs);
            let beats = |a: &(f64, Option<f64>), b: &(f64, Option<f64>)| a.0 <= b.0 && a.1 <= b.1 && a != b;
            for (pair, on_front) in pairs.iter().zip(&on) {
                let beaten = pairs.iter().any(|other| beats(other, pair));
                prop_assert_eq!(*on_front, !beaten);
                let by_front = pairs.iter().zip(&on).any(|(other, on)| *on && beats(other, pair));
                prop_assert_eq!(beaten, by_front);
            }
        }
    }
}
