//! The ranking: clusters by the fast path's scores, and exact scores of the best.
//!
//! The fast path's error is measured in every run and is far below the differences between clusters. An exact sum
//! costs as much as a whole rotation of the search. So poses are merged, clustered and ordered by the fast path's values
//! (the grid's, or the receptor field's if a pose was refined). The best rows get exact scores, or all do; a list of
//! every pose is exact and ordered by exact scores.
//!
//! If poses are rescored, all this goes by the pose score: the sum of the score and the rescoring terms. For rings it
//! includes the score of copies beyond the neighbours.
//!
//! Clusters are ordered by their score, T ln sum exp(s / T) over their poses' pose scores s. This is the best pose's
//! score if that pose is alone. It is more if many good poses are near it, as they are near a native one. T is a tenth
//! of the best score of the run, sharp fits left out. On training pairs anything from a twentieth to a fifth
//! ranked better than the best pose alone (docs/research/defaults.md).
//!
//! Clusters of meshes are ordered by their best poses alone (T = 0). A flat face slides on another at nearly the same
//! score, so that such a cluster has many good poses; where a joint fits there is one place.

use crate::pose_space::PoseSpace;
use crate::progress::Progress;
use crate::rank::candidates::Candidate;
use crate::rank::sharp::SharpPose;
use knotdock_scoring::exact::ShapeParts;
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::{Rescorer, TermValues, Workspace};
use rayon::prelude::*;

/// Scorer of the table's rows.
#[derive(Clone, Copy)]
pub(crate) struct PoseScorer<'a> {
    /// The exact score.
    pub scorer: &'a ExactSum,
    /// Terms that rescore poses.
    pub rescorer: Option<&'a Rescorer>,
    /// Effects that are on.
    pub on: [bool; Effect::ALL.len()],
    /// The poses that are searched.
    pub space: &'a PoseSpace,
    /// T of the clusters' scores, as a share of the best score.
    pub cluster_temperature: f64,
    /// Whether rows have the values of the columns for diagnosis.
    pub diagnostics: bool,
}

/// One row of `poses.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct RankedPose {
    /// From the ligand's file frame to the receptor's.
    pub pose: Pose,
    /// The score that orders the rows: `cluster_score` if rows are clusters, else `pose_score`.
    pub score: f64,
    /// Exact f64 pair sum of the ranking kernel at `pose`; higher is better. `None` for rows beyond those that are exact.
    pub search_score: Option<f64>,
    /// 1-based cluster number, best cluster first.
    pub cluster: Option<usize>,
    /// Number of poses in that cluster.
    pub cluster_size: Option<usize>,
    /// Score of that cluster, by which clusters are ordered: T ln sum exp(s / T) over its poses' pose scores, at
    /// least the best pose's.
    pub cluster_score: Option<f64>,
    /// Whether refinement moved `pose` off the grid; not if the exact score did not confirm the ascent.
    pub refined: bool,
    /// Index in the rotation set of the grid pose that this row came from.
    pub rotation: usize,
    /// Score of that grid pose as the fast path computed it.
    pub score_grid: f64,
    /// Weighted terms at `pose` by effect (`Effect as usize`), which add up to `search_score`; `None` if the
    /// effect is off or the row is not exact.
    pub terms: [Option<f64>; Effect::ALL.len()],
    /// Slices and unfiltered score of shape at `pose`; `None` without `--diagnostics`.
    pub shape: Option<ShapeParts>,
    /// Weighted values of the pose terms at `pose`, by id.
    pub pose_terms: TermValues,
    /// Score between copies of a ring that are no neighbours, for each pair of neighbours; `None` if there are none.
    pub other_copies: Option<f64>,
    /// Its sharp fit; `None` if none was made.
    pub sharp: Option<SharpPose>,
    /// Exact score of the pose: `search_score`, the pose terms, `other_copies` and the score of the sharp fit; `None` if the
    /// row is not exact.
    pub pose_score: Option<f64>,
    /// Standard deviations of the pose's score above the mean of all kept poses; `None` if they do not differ.
    pub z_score: Option<f64>,
}

/// The ranked rows, and the order of the clusters.
pub(crate) struct Ranking {
    /// Best first.
    pub poses: Vec<RankedPose>,
    /// Places of the clusters among those given, best first.
    pub clusters: Vec<usize>,
}

/// Most rows that a thread takes at once: refined ones take longer and come first.
const ROWS_TOGETHER: usize = 8;

/// The rows of a table, and which of them are exact.
#[derive(Clone, Copy)]
pub(crate) enum RowChoice {
    /// Every distinct pose, exact, in the order of exact scores.
    EveryPose,
    /// The best pose of each cluster, exact, in the order of exact scores. The fast path may misjudge by `margin` which
    /// pose of a cluster is best, so all that come so near to its centre are scored.
    Clusters { margin: f64 },
    /// The best pose of each cluster by the fast path, in its order; the first ones are exact.
    BestExact(usize),
}

/// The rows: every distinct pose by its score, or the best of each cluster by the cluster's score.
///
/// Clusters are numbered by their scores. Ties stay in the order given.
pub(crate) fn report(
    pose_scorer: PoseScorer,
    candidates: &[Candidate],
    (clusters, distinct): (&[usize], &[bool]),
    choice: RowChoice,
    progress: &dyn Progress,
) -> Ranking {
    let every_pose = matches!(choice, RowChoice::EveryPose);
    let count = clusters.iter().max().map_or(0, |last| last + 1);
    let mut sizes = vec![0; count];
    let mut weights = vec![0.0; count];
    // Sharp fits reach several times the best soft score, by which poses of a cluster are alike.
    let soft = candidates.iter().map(Candidate::soft_score);
    let best = soft.reduce(f64::max).unwrap_or(0.0).abs();
    let temperature = (pose_scorer.cluster_temperature * best).max(f64::MIN_POSITIVE);
    let background = Background::of(candidates);
    let mut centres = vec![f64::NEG_INFINITY; count];
    let mut wanted: Vec<(&Candidate, usize)> = Vec::new();
    for ((candidate, &cluster), &is_distinct) in candidates.iter().zip(clusters).zip(distinct) {
        sizes[cluster] += 1;
        // The centre comes first, being the best by the fast path.
        centres[cluster] = centres[cluster].max(candidate.score);
        // Scores against the centre's, so that nothing overflows.
        weights[cluster] += ((candidate.score - centres[cluster]) / temperature).exp();
        let may_be_row = match choice {
            RowChoice::EveryPose => true,
            RowChoice::Clusters { margin } => candidate.score >= centres[cluster] - margin,
            RowChoice::BestExact(_) => sizes[cluster] == 1,
        };
        if is_distinct && may_be_row {
            wanted.push((candidate, cluster));
        }
    }
    let with_company = |score: f64, cluster: usize| score + temperature * weights[cluster].ln();
    let exact = match choice {
        RowChoice::BestExact(exact) => {
            let score = |&(candidate, cluster): &(&Candidate, usize)| {
                with_company(candidate.score, cluster)
            };
            wanted.sort_by(|a, b| score(b).total_cmp(&score(a)));
            Some(exact)
        }
        _ => None,
    };
    progress.stage("score", wanted.len() as u64);
    // Each row, its cluster, and the score that orders it.
    let mut rows: Vec<(RankedPose, usize, f64)> = Vec::new();
    let scored = |(place, (candidate, cluster)): (usize, (&Candidate, usize))| {
        // Exact scores decide whether a refined pose stands.
        let is_exact = exact.is_none_or(|exact| place < exact) || candidate.refined;
        let row = match is_exact {
            true => candidate.reported(pose_scorer),
            false => candidate.unscored(),
        };
        progress.advance(1);
        let by_exact = row.pose_score.filter(|_| exact.is_none());
        (row, cluster, by_exact.unwrap_or(candidate.score))
    };
    let wanted = wanted.into_par_iter().enumerate();
    let wanted = wanted.with_max_len(ROWS_TOGETHER);
    wanted.map(scored).collect_into_vec(&mut rows);
    rows.retain(|(_, _, score)| score.is_finite());
    rows.sort_by(|(_, _, a), (_, _, b)| b.total_cmp(a));
    // Rows come best first: the first of a cluster is its best.
    let mut order: Vec<(usize, f64)> = Vec::new();
    let mut seen = vec![false; count];
    for &(_, cluster, score) in &rows {
        if !std::mem::replace(&mut seen[cluster], true) {
            order.push((cluster, with_company(score, cluster)));
        }
    }
    order.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let mut places: Vec<Option<(usize, f64)>> = vec![None; count];
    for (place, &(cluster, score)) in order.iter().enumerate() {
        places[cluster] = Some((place, score));
    }
    let mut poses: Vec<RankedPose> = rows
        .into_iter()
        .filter_map(|(row, cluster, of_pose)| {
            let (place, score) = places[cluster]?;
            let first = std::mem::replace(&mut seen[cluster], false);
            (first || every_pose).then_some(RankedPose {
                cluster: Some(place + 1),
                cluster_size: Some(sizes[cluster]),
                cluster_score: Some(score),
                score: if every_pose { of_pose } else { score },
                z_score: background.z_score(of_pose),
                ..row
            })
        })
        .collect();
    if !every_pose {
        poses.sort_by_key(|row| row.cluster);
    }
    Ranking {
        poses,
        clusters: order.into_iter().map(|(cluster, _)| cluster).collect(),
    }
}

/// Mean and spread of the scores of all kept poses.
struct Background {
    mean: f64,
    /// `None` if scores differ by no more than the error of the fast path.
    deviation: Option<f64>,
}

/// Least spread of scores, as a share of the largest, that distinguishes poses.
const MIN_SPREAD: f64 = 1e-3;

impl Background {
    /// Mean and standard deviation of the candidates' pose scores by the fast path.
    fn of(candidates: &[Candidate]) -> Self {
        let count = candidates.len().max(1) as f64;
        let mean = candidates.iter().map(|c| c.score).sum::<f64>() / count;
        let squares = candidates.iter().map(|c| (c.score - mean).powi(2));
        let deviation = (squares.sum::<f64>() / count).sqrt();
        let largest = candidates.iter().map(|c| c.score.abs()).fold(0.0, f64::max);
        Self {
            mean,
            deviation: (deviation > MIN_SPREAD * largest).then_some(deviation),
        }
    }

    fn z_score(&self, pose_score: f64) -> Option<f64> {
        let z = (pose_score - self.mean) / self.deviation?;
        z.is_finite().then_some(z)
    }
}

impl Candidate {
    /// Its row of the table, exactly scored, not yet in a cluster.
    fn reported(&self, pose_scorer: PoseScorer) -> RankedPose {
        let PoseScorer {
            scorer,
            rescorer,
            on,
            space,
            cluster_temperature: _,
            diagnostics,
        } = pose_scorer;
        let others = |pose: &Pose| space.other_copies(scorer, pose);
        let at_start = || self.terms.unwrap_or_else(|| scorer.terms(&self.start));
        let (pose, terms, others, refined) = if self.refined {
            let (terms, beyond) = (scorer.terms(&self.pose), others(&self.pose));
            // An ascent on the fast path's values that the exact sum does not confirm is undone.
            let known = self.terms.as_ref().map(|terms| terms.score);
            let before = known.unwrap_or_else(|| scorer.score_only(&self.start));
            let start = others(&self.start);
            if terms.score + beyond.unwrap_or(0.0) >= before + start.unwrap_or(0.0) {
                (self.pose, terms, beyond, true)
            } else {
                (self.start, at_start(), start, false)
            }
        } else {
            (self.start, at_start(), others(&self.start), false)
        };
        let pose_terms = match rescorer {
            // An undone ascent leaves another pose than was rescored.
            Some(rescorer) if refined != self.refined => {
                rescorer.score(&pose, &mut Workspace::default())
            }
            _ => self.pose_terms,
        };
        let sharp = self.sharp.and_then(|sharp| sharp.score);
        RankedPose {
            pose,
            pose_terms,
            other_copies: others,
            pose_score: Some(
                terms.score + pose_terms.sum() + others.unwrap_or(0.0) + sharp.unwrap_or(0.0),
            ),
            search_score: Some(terms.score),
            refined: refined || self.is_settled(),
            terms: std::array::from_fn(|effect| on[effect].then_some(terms.terms[effect])),
            shape: diagnostics.then(|| scorer.shape(&pose)),
            ..self.unscored()
        }
    }

    /// Its row without exact scores, not yet in a cluster.
    fn unscored(&self) -> RankedPose {
        RankedPose {
            pose: self.pose,
            score: 0.0,
            search_score: None,
            cluster: None,
            cluster_size: None,
            cluster_score: None,
            refined: self.is_off_grid(),
            rotation: self.rotation,
            score_grid: self.score_grid,
            terms: [None; Effect::ALL.len()],
            shape: None,
            pose_terms: self.pose_terms,
            other_copies: None,
            sharp: self.sharp,
            pose_score: None,
            z_score: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dock::scene::LengthUnit;
    use crate::pose_space::refine::RefinedPose;
    use crate::progress::NoProgress;
    use crate::rank::candidates::candidates;
    use knotdock_scoring::exact::ExactScorer;
    use knotdock_scoring::kernel::{KernelOptions, RankingKernel, Trim};
    use knotdock_scoring::peaks::Peak;
    use knotdock_structures::Knots;
    use nalgebra::Vector3;

    fn scorer() -> ExactSum {
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
        ExactScorer::new(&kernel, &ball, &ball).unwrap().into()
    }

    /// A scorer of rows by shape alone.
    fn rows_by(scorer: &ExactSum) -> PoseScorer<'_> {
        PoseScorer {
            scorer,
            rescorer: None,
            on: [true, false, false, false],
            space: &PoseSpace::Free,
            cluster_temperature: LengthUnit::Angstrom.cluster_temperature(),
            diagnostics: false,
        }
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
            let placed = |peak: &Peak| RefinedPose::best_of((at(0.0), peak.score), None);
            let placed: Vec<RefinedPose> = peaks.iter().map(placed).collect();
            Background::of(&candidates(&peaks, &placed, &[], None))
        };
        let z = with(&[1.0, 2.0, 3.0, 4.0]).z_score(5.0).unwrap();
        assert!((z - 2.5 / 1.25f64.sqrt()).abs() < 1e-12);
        assert_eq!(with(&[2.0, 2.0]).z_score(2.0), None);
    }

    /// An ascent whose gain the fast path saw and the exact sum does not is undone, and the row says so; a true one
    /// stands.
    #[test]
    fn an_undone_ascent_is_reported_as_unrefined() {
        let scorer = scorer();
        let exact = |x: f64| scorer.score_only(&at(x));
        let (touching, overlapping) = (4.2, 0.5);
        assert!(exact(touching) > exact(overlapping));
        let ascent = |from: f64, to: f64| {
            let peak = Peak {
                score: exact(from),
                rotation: 0,
                voxel: 0,
            };
            // The fast path claims a gain of one.
            let refined = Some((at(to), peak.score + 1.0));
            let placed = RefinedPose::best_of((at(from), peak.score), refined);
            let candidates = candidates(&[peak], &[placed], &[], None);
            let (one, choice) = ((&[0][..], &[true][..]), RowChoice::EveryPose);
            report(rows_by(&scorer), &candidates, one, choice, &NoProgress).poses[0].clone()
        };
        let undone = ascent(touching, overlapping);
        assert!(!undone.refined && undone.pose == at(touching));
        let score = undone.search_score.unwrap();
        assert!((score - exact(touching)).abs() < 1e-9 * score.abs());
        let stands = ascent(overlapping, touching);
        assert!(stands.refined && stands.pose == at(touching));
        assert_eq!(stands.terms[1..], [None; 3]);
    }

    /// Clusters of one pose each, the fast path a little off: it orders all rows, and the best have exact scores.
    #[test]
    fn the_best_rows_are_exact_and_one_score_orders_all() {
        let scorer = scorer();
        let off = |x: f64| scorer.score_only(&at(x)) * (1.0 + 1e-3 * x.sin());
        let places: Vec<f64> = (0..12).map(|step| 3.0 + 0.2 * f64::from(step)).collect();
        let peak = |x: &f64| Peak {
            score: off(*x),
            rotation: 0,
            voxel: 0,
        };
        let peaks: Vec<Peak> = places.iter().map(peak).collect();
        let placed = |x: &f64| RefinedPose::best_of((at(*x), off(*x)), None);
        let placed: Vec<RefinedPose> = places.iter().map(placed).collect();
        let candidates = candidates(&peaks, &placed, &[], None);
        let clusters: Vec<usize> = (0..12).collect();
        let clusters = (&clusters[..], &[true; 12][..]);
        let choice = RowChoice::BestExact(5);
        let rows = report(rows_by(&scorer), &candidates, clusters, choice, &NoProgress).poses;
        assert_eq!(rows.len(), 12);
        for (place, row) in rows.iter().enumerate() {
            let x = row.pose.translation.x;
            assert_eq!(row.score, off(x));
            let exact = (place < 5).then(|| scorer.score_only(&at(x)));
            assert_eq!((row.search_score, row.pose_score), (exact, exact));
            assert!(place == 0 || rows[place - 1].score >= row.score);
        }
    }

    /// Found by a user: a flat face slides on another at nearly the same score. That cluster came before the joint
    /// that fits, whose one pose had the best score of the run by 19%.
    #[test]
    fn company_counts_among_molecules_and_not_among_meshes() {
        let scorer = scorer();
        let score = |x: f64| scorer.score_only(&at(x));
        // The best distance of the two atoms, and five larger distances that score nearly as much.
        let tenths = (30..60).map(|tenths| f64::from(tenths) / 10.0);
        let best = tenths
            .max_by(|a, b| score(*a).total_cmp(&score(*b)))
            .unwrap();
        let all: Vec<f64> = (0..1000)
            .map(|step| best + 1e-3 * f64::from(step))
            .collect();
        let near = all
            .iter()
            .find(|x| score(**x) < 0.97 * score(best))
            .unwrap();
        let poses: Vec<f64> = [best]
            .into_iter()
            .chain((0..5).map(|step| near + 1e-4 * f64::from(step)))
            .collect();
        assert!(poses.iter().all(|x| score(*x) > 0.9 * score(best)));
        let peak = |x: &f64| Peak {
            score: score(*x),
            rotation: 0,
            voxel: 0,
        };
        let peaks: Vec<Peak> = poses.iter().map(peak).collect();
        let placed = |x: &f64| RefinedPose::best_of((at(*x), score(*x)), None);
        let placed: Vec<RefinedPose> = poses.iter().map(placed).collect();
        let candidates = candidates(&peaks, &placed, &[], None);
        let first = |unit: LengthUnit| {
            let pose_scorer = PoseScorer {
                cluster_temperature: unit.cluster_temperature(),
                ..rows_by(&scorer)
            };
            let clusters = (&[0, 1, 1, 1, 1, 1][..], &[true; 6][..]);
            let choice = RowChoice::Clusters { margin: 0.0 };
            let ranking = report(pose_scorer, &candidates, clusters, choice, &NoProgress);
            let first = &ranking.poses[0];
            (first.cluster_size, first.cluster_score == first.pose_score)
        };
        assert_eq!(first(LengthUnit::Angstrom), (Some(5), false));
        assert_eq!(first(LengthUnit::File), (Some(1), true));
    }
}
