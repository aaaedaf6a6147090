//! The ranking: clusters by the fast path's scores, and every row that is reported by its exact score.
//!
//! The fast path's error is measured in every run and far below what sets clusters apart, while an exact sum costs as much as a whole
//! rotation of the search. So poses are merged and clustered by the fast path's values (the grid's, or the receptor field's where a
//! pose was refined); rows of the table carry exact scores.
//!
//! Where poses are rescored, all this goes by the score and the terms of rescoring together: the rank score; of rings with what copies beyond the
//! neighbours add to it.
//!
//! Clusters are ordered by their score, T ln sum exp(s / T) over their poses' rank scores: the best pose's where it stands alone, more where many
//! good poses lie about it, as about a native one they do. T is a tenth of the run's best score: on training pairs anything from a
//! twentieth to a fifth ranked better than the best pose alone (docs/defaults.md).

use super::cluster::{RigidBody, greedy, greedy_of_rings};
use super::outcome::RankedPose;
use super::peaks::Peak;
use super::ring::other_copies;
use super::run::Progress;
use knotdock_scoring::effect::Effect;
use knotdock_scoring::exact::{ExactScore, ExactScorer};
use knotdock_scoring::rescoring::{Rescored, Rescorer, Workspace};
use knotdock_scoring::se3::Pose;
use knotdock_scoring::symmetry::Cyclic;
use rayon::prelude::*;

/// A pose in the running.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pose: Pose,
    /// The fast path's score at `pose`, and what rescoring adds there.
    score: f64,
    /// What rescoring says of `pose`.
    rescored: Rescored,
    /// The pose that it was refined from.
    start: Pose,
    /// All terms at `start`, where they are known already.
    terms: Option<ExactScore>,
    /// Whether `pose` was moved off the grid.
    refined: bool,
    rotation: usize,
    score_grid: f64,
}

/// What rows of the table are scored by.
#[derive(Clone, Copy)]
pub(super) struct Judge<'a> {
    /// The exact score.
    pub scorer: &'a ExactScorer,
    /// What poses are rescored with.
    pub rescorer: Option<&'a Rescorer>,
    /// Which effects are on, by effect.
    pub on: [bool; Effect::ALL.len()],
    /// The symmetry of rings, where they are sought.
    pub symmetry: Option<Cyclic>,
}

/// Where a peak of the search led to.
#[derive(Clone, Copy)]
pub(super) struct Placed {
    /// The pose that it was refined from: the grid's, or of rings the one nearest to it.
    pub start: Pose,
    /// The pose that it was refined to.
    pub pose: Pose,
    /// The fast path's score at `pose`, of rings that of all copies.
    pub score: f64,
    /// Whether the two differ.
    pub refined: bool,
}

impl Placed {
    /// A grid pose, and what it was refined to where that is better.
    pub fn best_of(grid: (Pose, f64), refined: Option<(Pose, f64)>) -> Self {
        let (start, score) = grid;
        let unrefined = Self {
            start,
            pose: start,
            score,
            refined: false,
        };
        match refined {
            Some((pose, higher)) if higher > score => Self {
                pose,
                score: higher,
                refined: true,
                ..unrefined
            },
            _ => unrefined,
        }
    }
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

/// Peaks and where they led to, rescored, best first, ties in the order given. `at_start` holds all terms at the starts of the first.
pub(super) fn candidates(
    peaks: &[Peak],
    placed: &[Placed],
    at_start: &[ExactScore],
    rescorer: Option<&Rescorer>,
) -> Vec<Candidate> {
    let mut candidates: Vec<Candidate> = peaks
        .par_iter()
        .zip(placed)
        .enumerate()
        .map_init(Workspace::default, |workspace, (index, (peak, placed))| {
            let rescored = rescorer
                .map(|rescorer| rescorer.score(&placed.pose, workspace))
                .unwrap_or_default();
            Candidate {
                pose: placed.pose,
                score: placed.score + rescored.sum(),
                rescored,
                start: placed.start,
                terms: at_start.get(index).copied(),
                refined: placed.refined,
                rotation: peak.rotation as usize,
                score_grid: peak.score,
            }
        })
        .filter(|candidate| candidate.score.is_finite())
        .collect();
    // The list comes in the order of the grid's scores, which breaks ties.
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    candidates
}

/// Drops refined poses that ended where a better one did.
pub(super) fn merge(candidates: &mut Vec<Candidate>, body: &RigidBody, rings: bool, distance: f64) {
    let poses: Vec<Pose> = candidates
        .iter()
        .filter(|candidate| candidate.refined)
        .map(|candidate| candidate.pose)
        .collect();
    let groups = grouped(body, &poses, rings, distance);
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
pub(super) fn clusters_of(
    candidates: &[Candidate],
    body: &RigidBody,
    rings: bool,
    radius: f64,
) -> Vec<usize> {
    let poses: Vec<Pose> = candidates.iter().map(|candidate| candidate.pose).collect();
    grouped(body, &poses, rings, radius)
}

/// Greedy clusters of poses, or of rings.
fn grouped(body: &RigidBody, poses: &[Pose], rings: bool, radius: f64) -> Vec<usize> {
    let by = if rings { greedy_of_rings } else { greedy };
    by(body, poses, radius)
}

/// Which candidates may be rows: all but refined poses within `distance` of a better refined one of their cluster. What is left out here still counts
/// in its cluster: how many climbs end about a pose tells how broad its hill is, while a list of poses has use for one of them.
pub(super) fn listed(
    candidates: &[Candidate],
    clusters: &[usize],
    body: &RigidBody,
    rings: bool,
    distance: f64,
) -> Vec<bool> {
    let count = clusters.iter().max().map_or(0, |last| last + 1);
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (index, (candidate, &cluster)) in candidates.iter().zip(clusters).enumerate() {
        if candidate.refined {
            members[cluster].push(index);
        }
    }
    let mut listed = vec![true; candidates.len()];
    for members in members {
        let poses: Vec<Pose> = members
            .iter()
            .map(|&index| candidates[index].pose)
            .collect();
        let mut seen = 0;
        for (index, group) in members
            .into_iter()
            .zip(grouped(body, &poses, rings, distance))
        {
            listed[index] = group == seen;
            seen += usize::from(listed[index]);
        }
    }
    listed
}

/// T as a share of the run's best score.
const CLUSTER_TEMPERATURE: f64 = 0.1;

/// Exactly scored rows: every pose that is listed, ordered by their exact scores, or the best of each cluster, ordered by the clusters' scores, by which
/// clusters are numbered; ties in the order given.
///
/// The fast path may misjudge by `margin` which pose of a cluster is best, so all that come so near its founder are scored.
pub(super) fn report(
    judge: Judge,
    candidates: &[Candidate],
    clusters: (&[usize], &[bool]),
    every_pose: bool,
    margin: f64,
    progress: &dyn Progress,
) -> Ranking {
    let (clusters, listed) = clusters;
    let count = clusters.iter().max().map_or(0, |last| last + 1);
    let mut sizes = vec![0; count];
    let mut weights = vec![0.0; count];
    let best = candidates.first().map_or(0.0, |best| best.score.abs());
    let temperature = (CLUSTER_TEMPERATURE * best).max(f64::MIN_POSITIVE);
    let background = Background::of(candidates);
    let mut founders = vec![f64::NEG_INFINITY; count];
    let mut wanted: Vec<(&Candidate, usize)> = Vec::new();
    for ((candidate, &cluster), &listed) in candidates.iter().zip(clusters).zip(listed) {
        sizes[cluster] += 1;
        // The founder comes first, being the best by the fast path.
        founders[cluster] = founders[cluster].max(candidate.score);
        // Scores against the founder's, so that nothing overflows.
        weights[cluster] += ((candidate.score - founders[cluster]) / temperature).exp();
        if listed && (every_pose || candidate.score >= founders[cluster] - margin) {
            wanted.push((candidate, cluster));
        }
    }
    progress.stage("score", wanted.len() as u64);
    let mut rows: Vec<(RankedPose, usize)> = wanted
        .into_par_iter()
        .map(|(candidate, cluster)| {
            let row = candidate.reported(judge);
            progress.advance(1);
            (row, cluster)
        })
        .filter(|(row, _)| row.rank_score.is_finite() && row.score_unfiltered.is_finite())
        .collect();
    rows.sort_by(|(a, _), (b, _)| b.rank_score.total_cmp(&a.rank_score));
    // Rows come best first: the first of a cluster is its best.
    let mut order: Vec<(usize, f64)> = Vec::new();
    let mut seen = vec![false; count];
    for (row, cluster) in &rows {
        if !std::mem::replace(&mut seen[*cluster], true) {
            order.push((
                *cluster,
                row.rank_score + temperature * weights[*cluster].ln(),
            ));
        }
    }
    order.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let mut places: Vec<Option<(usize, f64)>> = vec![None; count];
    for (place, &(cluster, score)) in order.iter().enumerate() {
        places[cluster] = Some((place, score));
    }
    let mut poses: Vec<RankedPose> = rows
        .into_iter()
        .filter_map(|(row, cluster)| {
            let (place, score) = places[cluster]?;
            let first = std::mem::replace(&mut seen[cluster], false);
            (first || every_pose).then_some(RankedPose {
                cluster: Some(place + 1),
                cluster_size: Some(sizes[cluster]),
                cluster_score: Some(score),
                z_score: background.z_score(row.rank_score),
                ..row
            })
        })
        .collect();
    if !every_pose {
        poses.sort_by_key(|row| row.cluster);
    }
    Ranking {
        poses,
        clusters: order.len(),
    }
}

/// What the run's kept poses score on the whole.
struct Background {
    mean: f64,
    deviation: f64,
}

impl Background {
    /// Mean and standard deviation of the candidates' rank scores by the fast path.
    fn of(candidates: &[Candidate]) -> Self {
        let count = candidates.len().max(1) as f64;
        let mean = candidates.iter().map(|c| c.score).sum::<f64>() / count;
        let squares = candidates.iter().map(|c| (c.score - mean).powi(2));
        Self {
            mean,
            deviation: (squares.sum::<f64>() / count).sqrt(),
        }
    }

    fn z_score(&self, rank_score: f64) -> Option<f64> {
        let z = (rank_score - self.mean) / self.deviation;
        z.is_finite().then_some(z)
    }
}

impl Candidate {
    /// Its row of the table, exactly scored, not yet in a cluster.
    fn reported(&self, judge: Judge) -> RankedPose {
        let Judge {
            scorer,
            rescorer,
            on,
            symmetry,
        } = judge;
        let others = |pose: &Pose| {
            let others = symmetry.map(|symmetry| other_copies(symmetry, scorer, pose));
            others.flatten()
        };
        let at_start = || self.terms.unwrap_or_else(|| scorer.score(&self.start));
        let (pose, terms, others, refined) = if self.refined {
            let (terms, beyond) = (scorer.score(&self.pose), others(&self.pose));
            // A climb on the fast path's values that the exact sum does not confirm is undone.
            let before = match &self.terms {
                Some(terms) => terms.score,
                None => scorer.score_only(&self.start),
            };
            let start = others(&self.start);
            if terms.score + beyond.unwrap_or(0.0) >= before + start.unwrap_or(0.0) {
                (self.pose, terms, beyond, true)
            } else {
                (self.start, at_start(), start, false)
            }
        } else {
            (self.start, at_start(), others(&self.start), false)
        };
        let rescored = match rescorer {
            // An undone climb leaves another pose than was rescored.
            Some(rescorer) if refined != self.refined => {
                rescorer.score(&pose, &mut Workspace::default())
            }
            _ => self.rescored,
        };
        RankedPose {
            pose,
            fine_contact: rescored.fine_contact,
            atom_pair: rescored.atom_pair,
            relaxed: rescored.relaxed,
            attraction: rescored.attraction,
            other_copies: others,
            rank_score: terms.score + rescored.sum() + others.unwrap_or(0.0),
            z_score: None,
            score: terms.score,
            cluster: None,
            cluster_size: None,
            cluster_score: None,
            refined,
            rotation: self.rotation,
            score_grid: self.score_grid,
            score_unfiltered: terms.unfiltered,
            terms: std::array::from_fn(|effect| on[effect].then_some(terms.terms[effect])),
            slices: terms.slices,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_scoring::kernel::{KernelOptions, RankingKernel, Trim};
    use knotdock_structures::Knots;
    use nalgebra::Vector3;

    struct Silent;
    impl Progress for Silent {
        fn stage(&self, _: &str, _: u64) {}
        fn advance(&self, _: u64) {}
    }

    fn scorer() -> ExactScorer {
        let options = KernelOptions {
            lambda: 10.0,
            offset: 2.2,
            alpha: 2.0,
            resolution: 4.5,
            pass_length: 9.0,
            trim: Trim::FlatTop,
        };
        let ball = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
        let kernel = RankingKernel::new(options, 3.4, 3.4, 1.15).unwrap();
        ExactScorer::new(&kernel, &ball, &ball).unwrap()
    }

    fn at(x: f64) -> Pose {
        Pose {
            translation: Vector3::new(x, 0.0, 0.0),
            ..Pose::identity()
        }
    }

    /// Scores 1, 2, 3, 4 have mean 2.5 and variance 1.25; where all are alike nothing stands out.
    #[test]
    fn z_scores_are_against_the_kept_poses() {
        let with = |scores: &[f64]| {
            let peaks: Vec<Peak> = scores
                .iter()
                .map(|&score| Peak {
                    score,
                    rotation: 0,
                    voxel: 0,
                })
                .collect();
            let placed = |peak: &Peak| Placed::best_of((at(0.0), peak.score), None);
            let placed: Vec<Placed> = peaks.iter().map(placed).collect();
            Background::of(&candidates(&peaks, &placed, &[], None))
        };
        let z = with(&[1.0, 2.0, 3.0, 4.0]).z_score(5.0).unwrap();
        assert!((z - 2.5 / 1.25f64.sqrt()).abs() < 1e-12);
        assert_eq!(with(&[2.0, 2.0]).z_score(2.0), None);
    }

    /// Of refined poses near each other the best of each cluster is listed; grid poses always are.
    #[test]
    fn repeats_are_not_listed_within_their_cluster() {
        let body = RigidBody::new(&[[0.0; 3]]);
        let found = |x: f64, score: f64, refined: bool| {
            let peak = Peak {
                score: 0.0,
                rotation: 0,
                voxel: 0,
            };
            let grid = (at(x), if refined { 0.0 } else { score });
            let placed = Placed::best_of(grid, refined.then_some((at(x), score)));
            (peak, placed)
        };
        let (peaks, placed): (Vec<Peak>, Vec<Placed>) = [
            found(0.0, 9.0, true),
            found(1.0, 8.0, true),
            found(0.5, 7.0, false),
            found(3.0, 6.0, true),
            found(2.5, 5.0, true),
        ]
        .into_iter()
        .unzip();
        let candidates = candidates(&peaks, &placed, &[], None);
        let of = |clusters: &[usize]| listed(&candidates, clusters, &body, false, 2.0);
        assert_eq!(of(&[0, 0, 0, 0, 0]), [true, false, true, true, false]);
        assert_eq!(of(&[0, 1, 0, 1, 1]), [true, true, true, false, false]);
    }

    /// A climb whose gain the fast path saw and the exact sum does not is undone, and the row says so; a true one stands.
    #[test]
    fn an_undone_climb_is_reported_as_unrefined() {
        let scorer = scorer();
        let exact = |x: f64| scorer.score_only(&at(x));
        let (touching, overlapping) = (4.2, 0.5);
        assert!(exact(touching) > exact(overlapping));
        let climbed = |from: f64, to: f64| {
            let peak = Peak {
                score: exact(from),
                rotation: 0,
                voxel: 0,
            };
            // The fast path claims a gain of one.
            let refined = Some((at(to), peak.score + 1.0));
            let placed = Placed::best_of((at(from), peak.score), refined);
            let candidates = candidates(&[peak], &[placed], &[], None);
            let judge = Judge {
                scorer: &scorer,
                rescorer: None,
                on: [true, false, false, false],
                symmetry: None,
            };
            let ranking = report(judge, &candidates, (&[0], &[true]), true, 0.0, &Silent);
            ranking.poses[0].clone()
        };
        let undone = climbed(touching, overlapping);
        assert!(!undone.refined && undone.pose == at(touching));
        assert!((undone.score - exact(touching)).abs() < 1e-9 * undone.score.abs());
        let stands = climbed(overlapping, touching);
        assert!(stands.refined && stands.pose == at(touching));
        assert_eq!(stands.terms[1..], [None; 3]);
    }
}
