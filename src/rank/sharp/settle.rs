//! Poses put into their optima, where a run is ranked by sharp fits.

use super::SharpPose;
use super::evidence::SharpFinding;
use super::stage::Optima;
use crate::options::SharpChoice;
use crate::rank::candidates::Candidate;
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::terms::pose::{Rescorer, Workspace};
use rayon::prelude::*;

/// Notes the optimum of each candidate. Where an exact fit stands out, or sharp fits are requested, the candidates whose
/// fits score move into their optima, are scored there, and all are sorted anew.
pub(crate) fn settle(
    candidates: &mut [Candidate],
    optima: &Optima,
    choice: SharpChoice,
    (scorer, rescorer): (&ExactSum, Option<&Rescorer>),
) -> SharpFinding {
    let finding = match (&optima.evidence, choice) {
        (Some(evidence), _) if evidence.stands_out() => SharpFinding::ExactFit,
        (Some(_), SharpChoice::On) => SharpFinding::Requested,
        _ => SharpFinding::NoExactFit,
    };
    let evidence = optima
        .evidence
        .filter(|_| finding != SharpFinding::NoExactFit);
    candidates
        .par_iter_mut()
        .zip(&optima.of_candidates)
        .for_each_init(Workspace::default, |workspace, (candidate, optimum)| {
            let Some(optimum) = optimum else {
                return;
            };
            let energy = optimum.energy.total();
            let score = evidence.map(|evidence| evidence.score(energy));
            candidate.sharp = Some(SharpPose {
                energy,
                clashes: optimum.energy.clashes,
                score,
            });
            if let Some(score) = score.filter(|score| *score > 0.0) {
                candidate.pose = optimum.pose;
                candidate.start = optimum.pose;
                candidate.refined = false;
                rescore(candidate, score, (scorer, rescorer), workspace);
            }
        });
    if evidence.is_some() {
        candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    }
    finding
}

/// Scores a candidate at its pose by the exact sum, the pose terms and the score of its sharp fit.
fn rescore(
    candidate: &mut Candidate,
    sharp: f64,
    (scorer, rescorer): (&ExactSum, Option<&Rescorer>),
    workspace: &mut Workspace,
) {
    let terms = scorer.terms(&candidate.pose);
    candidate.pose_terms = rescorer
        .map(|rescorer| rescorer.score(&candidate.pose, workspace))
        .unwrap_or_default();
    candidate.score = terms.score + candidate.pose_terms.sum() + sharp;
    candidate.terms = Some(terms);
}
