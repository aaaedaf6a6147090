//! Number of poses that can be rescored and scored before a deadline.
//!
//! The search leaves time for all, as far as that can be foreseen from a few poses. The time of a pose is measured again
//! once the search is done, and the poses that scored least are left out if time is short.

use crate::options::DockOptions;
use crate::pose_space::refine::RefinedPose;
use crate::rank::candidates::{candidates, clusters_of};
use crate::rank::cluster::RigidBody;
use knotdock_scoring::peaks::Peak;
use knotdock_scoring::terms::pose::Rescorer;
use std::time::Instant;

/// Fewest poses that are kept, whatever the time: this many are scored already, for the error of the fast path.
pub(crate) const FEWEST: usize = 100;
/// Poses that are rescored to see how long one takes.
const PROBES: usize = 48;

/// The number of poses that are kept, best first, with these seconds left. `scoring` is the seconds that the exact score
/// of one takes.
pub(crate) fn poses_in_time(
    left: f64,
    (peaks, placed): (&[Peak], &[RefinedPose]),
    rescorer: Option<&Rescorer>,
    scoring: f64,
    body: &RigidBody,
    options: &DockOptions,
) -> usize {
    let count = peaks.len();
    if count <= FEWEST {
        return count;
    }
    let rescoring = rescoring_seconds((peaks, placed), rescorer);
    // Rows are exactly scored: the best, of about as many clusters as there are by the search's own scores, or all.
    let scored = if options.ranking.no_cluster {
        1.0
    } else {
        let unscored = candidates(peaks, placed, &[], None);
        let clusters = clusters_of(&unscored, body, options.ranking.cluster_radius);
        let count = clusters.iter().max().map_or(0, |last| last + 1);
        let exact = options
            .ranking
            .exact
            .map_or(count, |exact| exact.min(count));
        exact as f64 / unscored.len().max(1) as f64
    };
    within(left, rescoring + scored * scoring, count)
}

/// Seconds that rescoring a pose takes, by some of those given.
pub(crate) fn rescoring_seconds(
    (peaks, placed): (&[Peak], &[RefinedPose]),
    rescorer: Option<&Rescorer>,
) -> f64 {
    let Some(rescorer) = rescorer else {
        return 0.0;
    };
    let step = peaks.len().div_ceil(PROBES).max(1);
    let peaks: Vec<Peak> = peaks.iter().step_by(step).copied().collect();
    let placed: Vec<RefinedPose> = placed.iter().step_by(step).copied().collect();
    let started = Instant::now();
    let probed = candidates(&peaks, &placed, &[], Some(rescorer)).len();
    started.elapsed().as_secs_f64() / probed.max(1) as f64
}

/// The number of `count` poses that fit into the seconds left, [`FEWEST`] at least.
fn within(left: f64, each: f64, count: usize) -> usize {
    // Rounding down; infinite if poses take no time.
    let fit = left / each;
    if fit >= count as f64 {
        return count;
    }
    (fit as usize).clamp(FEWEST.min(count), count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_poses_are_kept_as_fit() {
        assert_eq!(within(10.0, 0.001, 2000), 2000);
        assert_eq!(within(1.0, 0.001, 2000), 1000);
        assert_eq!(within(0.0, 0.001, 2000), FEWEST);
        assert_eq!(within(1.0, 0.0, 2000), 2000);
        assert_eq!(within(0.0, 0.0, 2000), FEWEST);
        assert_eq!(within(0.0, 0.001, 7), 7);
    }
}
