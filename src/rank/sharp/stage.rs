//! Optima of the best poses of a run, their evidence, and the poses moved into them.

use super::SharpPose;
use super::evidence::{Evidence, REQUESTED, SCORE_PER_RT, SharpFinding};
use crate::options::SharpChoice;
use crate::rank::candidates::Candidate;
use crate::rank::cluster::{RigidBody, greedy};
use crate::threads;
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::sharp::{Optimum, PairList, SharpFit};
use knotdock_scoring::terms::pose::{Rescorer, Workspace};
use knotdock_structures::{Knots, PolarAtom};
use rayon::prelude::*;

/// Poses that descend: the best of the run by the soft score.
const DESCENDING: usize = 250;
/// Places whose neighbourhood is tried, too: those of the best optima.
const MAX_TRIED: usize = 20;
/// Gain of the margin by that, at most but in rare cases, standard deviations (docs/research/defaults.md).
const MOST_GAIN: f64 = 0.8;
/// RMSD of the ligand in Å within which two optima are one place.
const PLACE: f64 = 2.5;

/// Two bodies as the sharp stage reads them.
#[derive(Clone, Copy)]
pub(crate) struct SharpInputs<'a> {
    /// Receptor and ligand.
    pub bodies: [&'a Knots; 2],
    /// The roles of their atoms in hydrogen bonds.
    pub polar: [&'a [PolarAtom]; 2],
}

/// Optima of a run's best poses.
pub(crate) struct Optima {
    /// The optimum of each of the first candidates; `None` if nothing touches.
    pub of_candidates: Vec<Option<Optimum>>,
    /// The best place against the others; `None` if there are too few.
    pub evidence: Option<Evidence>,
}

/// Lets the best candidates of a search of this many rotations descend, and searches about the places of the best optima
/// if that may make one stand out, or if sharp fits are requested.
pub(crate) fn optima(
    inputs: &SharpInputs,
    candidates: &[Candidate],
    body: &RigidBody,
    rotations: usize,
    choice: SharpChoice,
) -> Optima {
    let fit = SharpFit::new(inputs.bodies, inputs.polar);
    let best = candidates.get(..DESCENDING).unwrap_or(candidates);
    let descended = |index: usize, list: &mut PairList| fit.descend(&best[index].pose, list);
    let mut of_candidates = threads::each(best.len(), PairList::default, descended);
    let mut firsts = first_of_places(&of_candidates, body);
    let may_stand_out = evidence_of(&firsts, rotations)
        .is_some_and(|evidence| evidence.margin() > evidence.needed - MOST_GAIN);
    if !may_stand_out && choice != SharpChoice::On {
        firsts.clear();
    }
    firsts.truncate(MAX_TRIED);
    let tried = |place: usize, list: &mut PairList| {
        let first = firsts[place].1;
        let near = fit.best_near(&first.pose, list);
        let better = near.filter(|near| near.energy.total() < first.energy.total());
        better.unwrap_or(first)
    };
    let tried = threads::each(firsts.len(), PairList::default, tried);
    for ((index, _), optimum) in firsts.into_iter().zip(tried) {
        of_candidates[index] = Some(optimum);
    }
    Optima {
        evidence: evidence_of(&first_of_places(&of_candidates, body), rotations),
        of_candidates,
    }
}

/// Evidence by the optima of different places, best first.
fn evidence_of(firsts: &[(usize, Optimum)], rotations: usize) -> Option<Evidence> {
    let energies = firsts.iter().map(|(_, optimum)| optimum.energy.total());
    Evidence::of(&energies.collect::<Vec<f64>>(), rotations)
}

/// The best optimum of each place with the index of its candidate, best first; ties in the order of candidates.
fn first_of_places(optima: &[Option<Optimum>], body: &RigidBody) -> Vec<(usize, Optimum)> {
    let found = optima.iter().enumerate();
    let mut found: Vec<(usize, Optimum)> = found
        .filter_map(|(index, optimum)| Some((index, (*optimum)?)))
        .filter(|(_, optimum)| optimum.energy.total().is_finite())
        .collect();
    found.sort_by(|(_, a), (_, b)| a.energy.total().total_cmp(&b.energy.total()));
    let poses: Vec<_> = found.iter().map(|(_, optimum)| optimum.pose).collect();
    let places = greedy(body, &poses, PLACE);
    let mut next = 0;
    let firsts = found.into_iter().zip(places).filter(|&(_, place)| {
        let is_first = place == next;
        next += usize::from(is_first);
        is_first
    });
    firsts.map(|(found, _)| found).collect()
}

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
    let begins = optima.evidence.and_then(|evidence| match finding {
        _ if choice == SharpChoice::On => Some(evidence.at_margin(REQUESTED)),
        SharpFinding::ExactFit => Some(evidence.at_margin(evidence.needed)),
        _ => None,
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
