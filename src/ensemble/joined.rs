//! Clusters across the members of an ensemble.
//!
//! The rows of all members, best pose first, are clustered as a single run clusters its poses: by the RMSD of the
//! first ligand, each row joining the first cluster whose best pose is near. A row of a member represents a cluster of
//! that member, with the cluster's score S. The score of the joined cluster is T ln sum exp(S / T), so that with
//! one temperature T it is the score that all the poses would have in one run. T is a tenth of the best score of any
//! member, as in a single run (`rank/ranking.rs`).

use knotdock_scoring::se3::Pose;

use crate::dock::scene::LengthUnit;
use crate::rank::cluster::{RigidBody, greedy};

/// A row of a member's table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemberRow {
    /// From the frame of the first ligand to that of the first receptor.
    pub pose: Pose,
    /// Score of the row in its member: of its cluster, or of the pose if the table lists every pose.
    pub score: f64,
    /// Score of the pose.
    pub pose_score: f64,
    /// The part of it that the sharp fit adds.
    pub sharp: f64,
    /// Poses that it represents.
    pub size: usize,
}

/// A row of the joint table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JoinedRow {
    /// Place of the row among those that were given.
    pub row: usize,
    /// Number of its cluster, from 1, best first.
    pub cluster: usize,
    /// Poses of the cluster.
    pub size: usize,
    /// The score that orders the rows.
    pub score: f64,
}

/// Clusters rows within `radius` (Å RMSD of `body`, the first ligand). The first pose of each cluster, ordered by the
/// clusters' scores; or, if `every_pose`, all rows, ordered by the poses' scores. Ties stay in the order given.
pub fn join(rows: &[MemberRow], body: &RigidBody, radius: f64, every_pose: bool) -> Vec<JoinedRow> {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|&a, &b| rows[b].pose_score.total_cmp(&rows[a].pose_score));
    let poses: Vec<Pose> = order.iter().map(|&row| rows[row].pose).collect();
    let clusters = greedy(body, &poses, radius);
    let soft = rows.iter().map(|row| row.pose_score - row.sharp);
    let best = soft.reduce(f64::max).unwrap_or(0.0).abs();
    let share = LengthUnit::Angstrom.cluster_temperature();
    let temperature = (share * best).max(f64::MIN_POSITIVE);
    let count = clusters.iter().max().map_or(0, |last| last + 1);
    let mut scores = vec![Vec::new(); count];
    let mut sizes = vec![0; count];
    for (&row, &cluster) in order.iter().zip(&clusters) {
        scores[cluster].push(rows[row].score);
        sizes[cluster] += rows[row].size;
    }
    let scores = scores.iter().map(|all| soft_sum(all, temperature));
    let scores: Vec<f64> = scores.collect();
    let mut by_score: Vec<usize> = (0..count).collect();
    by_score.sort_by(|&a, &b| scores[b].total_cmp(&scores[a]));
    let mut places = vec![0; count];
    for (place, &cluster) in by_score.iter().enumerate() {
        places[cluster] = place;
    }
    let mut seen = vec![false; count];
    let mut joined: Vec<JoinedRow> = order
        .iter()
        .zip(&clusters)
        .filter(|&(_, &cluster)| !std::mem::replace(&mut seen[cluster], true) || every_pose)
        .map(|(&row, &cluster)| JoinedRow {
            row,
            cluster: places[cluster] + 1,
            size: sizes[cluster],
            score: if every_pose {
                rows[row].pose_score
            } else {
                scores[cluster]
            },
        })
        .collect();
    if !every_pose {
        joined.sort_by_key(|row| row.cluster);
    }
    joined
}

/// T ln sum exp(s / T), about the largest score so that nothing overflows.
fn soft_sum(scores: &[f64], temperature: f64) -> f64 {
    let largest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let scaled = scores.iter().map(|score| (score - largest) / temperature);
    let weights = scaled.map(f64::exp);
    largest + temperature * weights.sum::<f64>().ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(x: f64, score: f64) -> MemberRow {
        MemberRow {
            pose: Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]),
            score,
            pose_score: score,
            sharp: 0.0,
            size: 1,
        }
    }

    fn body() -> RigidBody {
        RigidBody::new(&[[0.0; 3], [4.0, 0.0, 0.0]])
    }

    /// The members' clusters add up as the poses of one run would: n poses of one score are T ln n above it.
    #[test]
    fn equal_clusters_of_n_members_score_t_ln_n_more() {
        for members in [1u32, 2, 7] {
            let mut rows: Vec<MemberRow> = (0..members).map(|_| row(0.0, 100.0)).collect();
            rows.push(row(50.0, 80.0));
            let joined = join(&rows, &body(), 5.0, false);
            let expected = 100.0 + 10.0 * f64::from(members).ln();
            assert_eq!(joined.len(), 2);
            assert!((joined[0].score - expected).abs() < 1e-12);
            assert_eq!(joined[0].size, members as usize);
            assert!((joined[1].score - 80.0).abs() < 1e-12);
        }
    }

    /// What two members find may come before what one of them likes best. The row shown is the best pose's.
    #[test]
    fn agreement_counts() {
        let rows = [row(0.0, 100.0), row(50.0, 97.0), row(52.0, 98.0)];
        let joined = join(&rows, &body(), 5.0, false);
        let shown: Vec<usize> = joined.iter().map(|row| row.row).collect();
        assert_eq!(shown, [2, 0]);
        let all = join(&rows, &body(), 5.0, true);
        let shown: Vec<_> = all.iter().map(|row| (row.row, row.cluster)).collect();
        assert_eq!(shown, [(0, 2), (2, 1), (1, 1)]);
        assert_eq!(all[0].score, 100.0);
    }

    /// An exact fit reaches several times the score of any other pose: T is of the others.
    #[test]
    fn sharp_fits_leave_the_temperature() {
        let sharp = MemberRow {
            sharp: 900.0,
            ..row(0.0, 1000.0)
        };
        let rows = [sharp, row(50.0, 100.0), row(50.0, 100.0)];
        let joined = join(&rows, &body(), 5.0, false);
        assert!((joined[1].score - (100.0 + 10.0 * 2f64.ln())).abs() < 1e-12);
    }

    #[test]
    fn nothing_joins_to_nothing() {
        assert!(join(&[], &body(), 5.0, false).is_empty());
    }
}
