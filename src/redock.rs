//! A predicted pose docked again: whether a global search finds it, and how well it scores beside the poses found.
//!
//! The ligand is in its predicted pose in the file, so that this pose is the identity. The search knows nothing of it:
//! its rotations are those of any run. Afterwards the predicted pose is *relaxed*: it ascends the exact score from its
//! place, within the radius of a cluster, and goes into the sharp fit nearby if sharp fits score. The
//! first clusters are relaxed in the same way, because a pose that was searched is on a grid and scores below its optimum.

use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::peaks::Peak;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::sharp::{PairList, SharpFit};
use knotdock_scoring::terms::pose::Rescorer;
use knotdock_structures::Error;
use nalgebra::Vector3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::dock::outcome::{DockOutcome, SharpOutcome};
use crate::dock::plan::DockPlan;
use crate::error::no_pose;
use crate::evaluate::{Criterion, PoseQuality};
use crate::options::SharpChoice;
use crate::pose_space::refine::{AscentLimits, RefinedPose, maximize, printed, rigid_body};
use crate::rank::candidates::{Candidate, candidates};
use crate::rank::cluster::RigidBody;
use crate::rank::sharp::{Evidence, Optima, SharpFinding, settle};
use crate::threads;

/// Clusters among which a pose near the predicted one counts as agreement, and which are relaxed.
pub const FIRST_CLUSTERS: usize = 10;
/// Score evaluations of an ascent at most.
const EVALUATIONS: usize = 40;

/// Whether a global search finds a predicted pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Agreement {
    /// A pose near it is among the first [`FIRST_CLUSTERS`] clusters.
    Agrees,
    /// The first pose near it is of a later cluster.
    FoundLower,
    /// No row is near it.
    DoesNotAgree,
}

/// A row of the run near the predicted pose: acceptable by the rules of CAPRI or better.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NearRow {
    /// Its place among the rows, from 1.
    pub rank: usize,
    /// Its cluster.
    pub cluster: Option<usize>,
    /// Its DockQ against the predicted complex.
    pub dockq: f64,
    /// Its share of the predicted contacts.
    pub fnat: f64,
    /// Its ligand RMSD from the predicted complex, in Å.
    pub lrmsd: f64,
}

/// The predicted pose at its optimum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RelaxedPose {
    /// Rotation of the ligand from its predicted pose: w, x, y, z.
    pub quaternion: [f64; 4],
    /// Translation of the ligand, in Å.
    pub translation: [f64; 3],
    /// RMSD in Å by which it moved, over the points whose RMSD makes clusters.
    pub rmsd_moved: f64,
    /// Pose score.
    pub pose_score: f64,
}

/// The best of the first clusters that are not near the predicted pose, relaxed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OtherPose {
    /// Rank of its row.
    pub rank: usize,
    /// Pose score after it was relaxed.
    pub pose_score: f64,
}

/// A predicted pose beside those that a global search found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Redocking {
    /// The answer.
    pub agreement: Agreement,
    /// The first row near the predicted pose.
    pub near: Option<NearRow>,
    /// Pose score of the predicted pose where it is, sharp fits left out.
    pub predicted_score: f64,
    /// The predicted pose, relaxed.
    pub relaxed: RelaxedPose,
    /// The best of the first clusters elsewhere.
    pub best_elsewhere: Option<OtherPose>,
    /// Clusters elsewhere, of the first [`FIRST_CLUSTERS`], that score above the relaxed predicted pose.
    pub clusters_above: usize,
    /// Angle in degrees from the predicted orientation to the nearest one of the set, finer ones left out.
    pub nearest_rotation_degrees: f64,
}

/// Compares the rows of a run with the predicted pose of the ligand, that of its file. `qualities` are those of the rows
/// against the predicted complex, and `points` those of the docking.
///
/// # Errors
/// [`Error`] if threads cannot be had, on knots that cannot be summed, and if a pose has no finite score.
pub fn redock(
    plan: &DockPlan,
    points: &[[f64; 3]],
    outcome: &DockOutcome,
    qualities: &[PoseQuality],
) -> Result<Redocking, Error> {
    let rows = outcome.poses.iter().zip(qualities).enumerate();
    let is_near = |quality: &PoseQuality| Criterion::Acceptable.is_met(quality);
    let near = rows.clone().filter(|(_, (_, quality))| is_near(quality));
    let near = near.min_by_key(|(_, (row, _))| row.cluster);
    let near = near.map(|(place, (row, quality))| NearRow {
        rank: place + 1,
        cluster: row.cluster,
        dockq: quality.dockq,
        fnat: quality.fnat,
        lrmsd: quality.lrmsd,
    });
    // The first row of each of the first clusters, with its place.
    let mut firsts = [None; FIRST_CLUSTERS];
    for (place, (row, quality)) in rows {
        let cluster = row
            .cluster
            .and_then(|cluster| firsts.get_mut(cluster.checked_sub(1)?));
        if let Some(first @ None) = cluster {
            *first = Some((place, row.pose, is_near(quality)));
        }
    }
    let elsewhere = firsts.iter().flatten().filter(|(_, _, is_near)| !is_near);
    let elsewhere: Vec<(usize, Pose)> = elsewhere.map(|&(place, pose, _)| (place, pose)).collect();
    let relaxer = Relaxer::new(plan, points, outcome)?;
    let predicted = Pose::identity();
    let (predicted_score, relaxed, others) = threads::on(plan.in_flight(), || {
        let others = elsewhere.par_iter().with_max_len(1);
        let others = others.map(|(place, pose)| (place + 1, relaxer.relaxed(pose)));
        let others: Vec<(usize, Option<Candidate>)> = others.collect();
        let unmoved = relaxer.candidate(&predicted);
        (unmoved, relaxer.relaxed(&predicted), others)
    })?;
    let (Some(predicted_score), Some(relaxed)) = (predicted_score, relaxed) else {
        return Err(no_pose());
    };
    let others = others.into_iter();
    let others = others.filter_map(|(rank, pose)| Some((rank, pose?.score)));
    let others: Vec<(usize, f64)> = others.collect();
    let best = others.iter().max_by(|(_, a), (_, b)| a.total_cmp(b));
    let rotations = plan.search.rotations.coarse.iter();
    let angles = rotations.map(|rotation| rotation.angle_to(&predicted.rotation));
    Ok(Redocking {
        agreement: match near {
            Some(NearRow {
                cluster: Some(..=FIRST_CLUSTERS),
                ..
            }) => Agreement::Agrees,
            Some(_) => Agreement::FoundLower,
            None => Agreement::DoesNotAgree,
        },
        near,
        predicted_score: predicted_score.score,
        relaxed: RelaxedPose {
            quaternion: relaxed.pose.quaternion(),
            translation: relaxed.pose.translation.into(),
            rmsd_moved: relaxer
                .body
                .rmsd(&relaxer.body.place(&predicted), &relaxed.pose),
            pose_score: relaxed.score,
        },
        best_elsewhere: best.map(|&(rank, pose_score)| OtherPose { rank, pose_score }),
        clusters_above: others
            .iter()
            .filter(|(_, score)| *score > relaxed.score)
            .count(),
        nearest_rotation_degrees: angles.fold(f64::INFINITY, f64::min).to_degrees(),
    })
}

/// What relaxes poses of a run.
struct Relaxer {
    scorer: ExactSum,
    rescorer: Option<Rescorer>,
    /// The ligand's centre, in its file's frame.
    center: Vector3<f64>,
    body: RigidBody,
    limits: AscentLimits,
    /// The sharp fit, if sharp fits score.
    sharp: Option<SharpFit>,
    /// Their background.
    evidence: Option<Evidence>,
    choice: SharpChoice,
}

impl Relaxer {
    fn new(plan: &DockPlan, points: &[[f64; 3]], outcome: &DockOutcome) -> Result<Self, Error> {
        let body = RigidBody::new(points);
        let gyration = body.gyration().max(1.0);
        let distance = plan.options.ranking.cluster_radius;
        let rewards = |sharp: &&SharpOutcome| sharp.finding != SharpFinding::NoExactFit;
        let rewarded = outcome.sharp.as_ref().filter(rewards);
        let inputs = rewarded.and_then(|_| plan.sharp_inputs());
        Ok(Self {
            scorer: plan.exact_scorer()?,
            rescorer: plan.rescorer(),
            center: plan.search.engine.ligand_center(),
            limits: AscentLimits {
                evaluations: EVALUATIONS,
                distance,
                angle: distance / gyration,
                gyration,
                angstrom: plan.angstrom,
            },
            body,
            sharp: inputs.map(|inputs| SharpFit::new(inputs.bodies, inputs.polar)),
            evidence: rewarded.and_then(|sharp| sharp.evidence),
            choice: plan.options.ranking.sharp,
        })
    }

    /// A pose with its exact score; `None` if that is not finite.
    fn candidate(&self, pose: &Pose) -> Option<Candidate> {
        let pose = printed(pose);
        let terms = self.scorer.terms(&pose);
        let peak = Peak {
            score: terms.score,
            rotation: 0,
            voxel: 0,
        };
        let placed = RefinedPose::best_of((pose, terms.score), None);
        candidates(&[peak], &[placed], &[terms], self.rescorer.as_ref()).pop()
    }

    /// A pose at the optimum near it.
    fn relaxed(&self, pose: &Pose) -> Option<Candidate> {
        let score = |pose: &Pose| self.scorer.gradient(pose);
        let moved = rigid_body(self.center);
        let (optimum, _) = maximize(*pose, self.center, &self.limits, score, moved);
        let mut best = self.candidate(&optimum)?;
        if let Some(fit) = &self.sharp {
            let optima = Optima {
                of_candidates: vec![fit.best_near(pose, &mut PairList::default())],
                evidence: self.evidence,
            };
            let scorers = (&self.scorer, self.rescorer.as_ref());
            settle(
                std::slice::from_mut(&mut best),
                &optima,
                self.choice,
                scorers,
            );
        }
        Some(best)
    }
}
