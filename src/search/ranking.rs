//! The ranking: all poses by their exact score alone; those that are reported, with every term.
//!
//! Poses are ordered by [`ExactScorer::score_only`]; reported rows carry the score of [`ExactScorer::score`], the weighted sum of their
//! slices. The two differ by rounding, so rows are ordered once more by what they report, and clusters numbered after their
//! founders' places in that order.

use super::cluster::{RigidBody, greedy};
use super::outcome::RankedPose;
use super::peaks::Peak;
use super::run::Progress;
use knotdock_scoring::exact::{ExactScore, ExactScorer};
use knotdock_scoring::se3::Pose;
use rayon::prelude::*;

/// Grid poses over which the fast path's error is measured.
const ERROR_POSES: usize = 100;

/// A pose in the running.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pose: Pose,
    /// Exact score at `pose`.
    score: f64,
    /// All terms at `pose`, where they are known already.
    terms: Option<ExactScore>,
    /// Whether `pose` was moved off the grid.
    refined: bool,
    rotation: usize,
    score_grid: f64,
}

/// What is reported of the ranking.
pub(super) struct Ranking {
    /// Best first.
    pub poses: Vec<RankedPose>,
    pub clusters: usize,
}

/// The pose as its printed digits give it back: normalised, w not negative.
pub(super) fn printed(pose: &Pose) -> Pose {
    Pose::from_parts(pose.quaternion(), pose.translation.into())
}

/// Scores grid poses, and for the first of them what they were refined to; returns them best first, ties in the order given, and
/// all terms of the first grid poses, by which the fast path's error is measured.
pub(super) fn score_poses(
    scorer: &ExactScorer,
    peaks: &[Peak],
    grid_poses: &[Pose],
    refined: &[Pose],
    progress: &dyn Progress,
) -> (Vec<Candidate>, Vec<ExactScore>) {
    let at_grid: Vec<ExactScore> = grid_poses[..ERROR_POSES.min(grid_poses.len())]
        .par_iter()
        .map(|pose| scorer.score(pose))
        .collect();
    let mut candidates: Vec<Candidate> = peaks
        .par_iter()
        .zip(grid_poses)
        .enumerate()
        .map(|(index, (peak, grid_pose))| {
            let before = scorer.score_only(grid_pose);
            let climbed = refined
                .get(index)
                .map(|pose| (*pose, scorer.score_only(pose)));
            progress.advance(1);
            let candidate = Candidate {
                pose: *grid_pose,
                score: before,
                terms: at_grid.get(index).copied(),
                refined: false,
                rotation: peak.rotation as usize,
                score_grid: f64::from(peak.score),
            };
            match climbed {
                // A climb on the fast path's values that the exact sum does not confirm is undone.
                Some((pose, score)) if score >= before => Candidate {
                    pose,
                    score,
                    terms: None,
                    refined: true,
                    ..candidate
                },
                _ => candidate,
            }
        })
        .filter(|candidate| candidate.score.is_finite())
        .collect();
    // The list comes in the order of the grid's scores, which breaks ties.
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    (candidates, at_grid)
}

/// Drops refined poses that ended where a better one did.
pub(super) fn merge(candidates: &mut Vec<Candidate>, body: &RigidBody, distance: f64) {
    let poses: Vec<Pose> = candidates
        .iter()
        .filter(|candidate| candidate.refined)
        .map(|candidate| candidate.pose)
        .collect();
    let groups = greedy(body, &poses, distance);
    let (mut index, mut seen) = (0, 0);
    candidates.retain(|candidate| {
        if !candidate.refined {
            return true;
        }
        let founder = groups[index] == seen;
        index += 1;
        seen += usize::from(founder);
        founder
    });
}

/// Each candidate's cluster, numbered from 0 in the order of their founders.
pub(super) fn clusters_of(candidates: &[Candidate], body: &RigidBody, radius: f64) -> Vec<usize> {
    let poses: Vec<Pose> = candidates.iter().map(|candidate| candidate.pose).collect();
    greedy(body, &poses, radius)
}

/// All terms of the founders of clusters, or of every pose, ordered by the score that they report; ties in the order given.
pub(super) fn report(
    scorer: &ExactScorer,
    candidates: &[Candidate],
    clusters: &[usize],
    every_pose: bool,
) -> Ranking {
    let count = clusters.iter().max().map_or(0, |last| last + 1);
    let mut sizes = vec![0; count];
    let mut wanted: Vec<(&Candidate, usize, bool)> = Vec::new();
    for (candidate, &cluster) in candidates.iter().zip(clusters) {
        sizes[cluster] += 1;
        let founder = sizes[cluster] == 1;
        if founder || every_pose {
            wanted.push((candidate, cluster, founder));
        }
    }
    let mut rows: Vec<(RankedPose, usize, bool)> = wanted
        .into_par_iter()
        .map(|(candidate, cluster, founder)| {
            let terms = candidate
                .terms
                .unwrap_or_else(|| scorer.score(&candidate.pose));
            (candidate.reported(&terms), cluster, founder)
        })
        .filter(|(row, ..)| row.score.is_finite() && row.score_unfiltered.is_finite())
        .collect();
    rows.sort_by(|(a, ..), (b, ..)| b.score.total_cmp(&a.score));
    let mut numbers = vec![None; count];
    let mut found = 0;
    for &(_, cluster, founder) in &rows {
        if founder {
            found += 1;
            numbers[cluster] = Some(found);
        }
    }
    let poses = rows
        .into_iter()
        .filter_map(|(row, cluster, _)| {
            Some(RankedPose {
                cluster: Some(numbers[cluster]?),
                cluster_size: Some(sizes[cluster]),
                ..row
            })
        })
        .collect();
    Ranking {
        poses,
        clusters: found,
    }
}

impl Candidate {
    /// Its row of the table, not yet in a cluster.
    fn reported(&self, terms: &ExactScore) -> RankedPose {
        RankedPose {
            pose: self.pose,
            score: terms.score,
            cluster: None,
            cluster_size: None,
            refined: self.refined,
            rotation: self.rotation,
            score_grid: self.score_grid,
            score_unfiltered: terms.unfiltered,
            shape: terms.score,
            slices: terms.slices,
        }
    }
}
