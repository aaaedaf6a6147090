//! Candidates: the poses that the search's peaks were refined to, scored by the fast path, merged and clustered.

use crate::pose_space::refine::RefinedPose;
use crate::rank::cluster::{PlacedBody, RigidBody, greedy};
use crate::rank::sharp::SharpPose;
use crate::threads;
use knotdock_scoring::exact::ScoreTerms;
use knotdock_scoring::peaks::Peak;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::pose::{Rescorer, TermValues, Workspace};

/// A pose that may become a row.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// The pose.
    pub pose: Pose,
    /// The fast path's score at `pose` plus the pose terms there.
    pub score: f64,
    /// Values of the pose terms at `pose`.
    pub pose_terms: TermValues,
    /// The pose that it was refined from.
    pub start: Pose,
    /// All terms at `start`, if they are known already.
    pub terms: Option<ScoreTerms>,
    /// Whether `pose` was moved off the grid.
    pub refined: bool,
    /// Its sharp fit, if one was made.
    pub sharp: Option<SharpPose>,
    /// Index of the rotation that it came from.
    pub rotation: usize,
    /// The grid's score where it came from.
    pub score_grid: f64,
}

/// Peaks with their refined poses as rescored candidates, best first, ties in the order given. `at_start` holds all terms
/// at the starts of the first.
pub(crate) fn candidates(
    peaks: &[Peak],
    placed: &[RefinedPose],
    at_start: &[ScoreTerms],
    rescorer: Option<&Rescorer>,
) -> Vec<Candidate> {
    let candidate = |index: usize, workspace: &mut Workspace| {
        let (peak, placed) = (&peaks[index], &placed[index]);
        let pose_terms = rescorer
            .map(|rescorer| rescorer.score(&placed.pose, workspace))
            .unwrap_or_default();
        Candidate {
            pose: placed.pose,
            score: placed.score + pose_terms.sum(),
            pose_terms,
            start: placed.start,
            terms: at_start.get(index).copied(),
            refined: placed.refined,
            sharp: None,
            rotation: peak.rotation as usize,
            score_grid: peak.score,
        }
    };
    let mut candidates = threads::each(peaks.len(), Workspace::default, candidate);
    candidates.retain(|candidate| candidate.score.is_finite());
    // The list comes in the order of the grid's scores, which breaks ties.
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    candidates
}

impl Candidate {
    /// The score without what a sharp fit adds.
    pub fn soft_score(&self) -> f64 {
        let sharp = self.sharp.and_then(|sharp| sharp.score);
        self.score - sharp.unwrap_or(0.0)
    }

    /// Whether it was moved into the optimum of its sharp fit, as all whose fits score.
    pub fn is_settled(&self) -> bool {
        self.sharp.is_some_and(SharpPose::is_rewarded)
    }

    /// Whether the pose has left the grid of the search.
    pub fn is_off_grid(&self) -> bool {
        self.refined || self.is_settled()
    }
}

/// Drops poses off the grid that are near a better one.
pub(crate) fn merge(candidates: &mut Vec<Candidate>, body: &RigidBody, distance: f64) {
    let off_grid = candidates
        .iter()
        .filter(|candidate| candidate.is_off_grid());
    let poses: Vec<Pose> = off_grid.map(|candidate| candidate.pose).collect();
    let mut groups = greedy(body, &poses, distance).into_iter();
    let mut seen = 0;
    candidates.retain(|candidate| {
        let is_best = !candidate.is_off_grid() || groups.next() == Some(seen);
        seen += usize::from(is_best && candidate.is_off_grid());
        is_best
    });
}

/// Each candidate's cluster, numbered from 0 in the order of their centres.
pub(crate) fn clusters_of(candidates: &[Candidate], body: &RigidBody, radius: f64) -> Vec<usize> {
    let poses: Vec<Pose> = candidates.iter().map(|candidate| candidate.pose).collect();
    greedy(body, &poses, radius)
}

/// Whether each candidate, best first, may be a row: all but those within `step` (Å) of a better refined one of their
/// cluster.
///
/// A refined pose has left the samples of the search and represents those about it. They still count in its cluster,
/// whose size shows how broad the maximum is; a list of poses needs only one of them.
pub(crate) fn deduplicated(
    candidates: &[Candidate],
    clusters: &[usize],
    body: &RigidBody,
    step: f64,
) -> Vec<bool> {
    let count = clusters.iter().max().map_or(0, |last| last + 1);
    let mut kept: Vec<Vec<PlacedBody>> = vec![Vec::new(); count];
    let is_distinct = |(candidate, &cluster): (&Candidate, &usize)| {
        let near = body.first_within(&kept[cluster], &candidate.pose, step);
        if near.is_none() && candidate.is_off_grid() {
            kept[cluster].push(body.place(&candidate.pose));
        }
        near.is_none()
    };
    candidates.iter().zip(clusters).map(is_distinct).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// A refined pose stands for all of its cluster about it; a grid pose for none, and of two clusters neither for
    /// the other.
    #[test]
    fn a_cluster_has_no_repeats() {
        let body = RigidBody::new(&[[0.0; 3]]);
        let at = |x: f64| Pose {
            translation: Vector3::new(x, 0.0, 0.0),
            ..Pose::identity()
        };
        let found = |x: f64, score: f64, refined: bool| {
            let peak = Peak {
                score: 0.0,
                rotation: 0,
                voxel: 0,
            };
            let grid = (at(x), if refined { 0.0 } else { score });
            let placed = RefinedPose::best_of(grid, refined.then_some((at(x), score)));
            (peak, placed)
        };
        let (peaks, placed): (Vec<Peak>, Vec<RefinedPose>) = [
            found(0.0, 9.0, true),
            found(1.0, 8.0, true),
            found(0.5, 7.0, false),
            found(3.5, 6.0, false),
            found(3.0, 5.0, true),
            found(2.5, 4.0, true),
        ]
        .into_iter()
        .unzip();
        let candidates = candidates(&peaks, &placed, &[], None);
        let of = |clusters: &[usize]| deduplicated(&candidates, clusters, &body, 2.0);
        assert_eq!(of(&[0; 6]), [true, false, false, true, true, false]);
        // The second cluster's best pose, and what lies beyond it.
        let seconds = [0, 1, 0, 1, 1, 1];
        assert_eq!(of(&seconds), [true, true, false, true, false, false]);
    }
}
