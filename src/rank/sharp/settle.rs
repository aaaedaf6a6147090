//! Poses put into their optima, if a run is ranked by sharp fits.

use super::SharpPose;
use super::evidence::{REQUESTED, SCORE_PER_RT, SharpFinding};
use super::stage::Optima;
use crate::options::SharpChoice;
use crate::rank::candidates::Candidate;
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::sharp::Optimum;
use knotdock_scoring::terms::pose::{Rescorer, Workspace};
use rayon::prelude::*;

/// Records the optimum of each candidate. If an exact fit stands out, or sharp fits are requested, the candidates that score
/// more in their optima move there, and all are sorted anew.
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
    let begins = optima.evidence.and_then(|evidence| match choice {
        SharpChoice::On => Some(evidence.at_margin(REQUESTED)),
        _ => evidence
            .stands_out()
            .then(|| evidence.at_margin(evidence.needed)),
    });
    candidates
        .par_iter_mut()
        .zip(&optima.of_candidates)
        .for_each_init(Workspace::default, |workspace, (candidate, optimum)| {
            let Some(optimum) = optimum else {
                return;
            };
            let energy = optimum.energy.total();
            candidate.sharp = Some(SharpPose {
                energy,
                clashes: optimum.energy.clashes,
                score: begins.map(|_| 0.0),
            });
            let reward = begins.map_or(0.0, |begins| SCORE_PER_RT * (begins - energy));
            if reward > 0.0 {
                let settled = settled(candidate, optimum, reward, (scorer, rescorer), workspace);
                // The better of the two, so that the score grows without a step.
                if settled.score > candidate.score {
                    *candidate = settled;
                }
            }
        });
    if begins.is_some() {
        candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    }
    finding
}

/// A candidate moved into its optimum, scored there by the exact sum, the pose terms and the reward of its sharp fit.
fn settled(
    candidate: &Candidate,
    optimum: &Optimum,
    reward: f64,
    (scorer, rescorer): (&ExactSum, Option<&Rescorer>),
    workspace: &mut Workspace,
) -> Candidate {
    let terms = scorer.terms(&optimum.pose);
    let pose_terms = rescorer
        .map(|rescorer| rescorer.score(&optimum.pose, workspace))
        .unwrap_or_default();
    Candidate {
        pose: optimum.pose,
        start: optimum.pose,
        refined: false,
        score: terms.score + pose_terms.sum() + reward,
        pose_terms,
        terms: Some(terms),
        sharp: Some(SharpPose {
            energy: optimum.energy.total(),
            clashes: optimum.energy.clashes,
            score: Some(reward),
        }),
        ..*candidate
    }
}
