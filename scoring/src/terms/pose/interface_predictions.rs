//! Pose term `interface_predictions`: whether the residues in contact are those that a predictor expects there.
//!
//! A predictor gives each residue i a probability p(i) to be in the interface. For independent residues the logarithm
//! of the probability of a pose's interface S, against one in which all residues are equally likely, is up to a
//! constant
//!
//! sum over i in S of logit p(i) - logit p,
//!
//! with the mean probability p of the side. So a residue that is no likelier than the mean counts nothing, and neither
//! large nor small interfaces are preferred.
//!
//! On training pairs a nat of independent evidence is worth 276 of score (scripts/potentials/score_odds.py). The errors
//! of predictors are not independent: they come in patches as large as an interface, and the hydrophobic patches that a
//! predictor sees are those that the contact potentials see. So the default weight is one that does no harm with a real
//! predictor (docs/guides/known_residues.md, "Predictions").

use super::bodies::{Sides, positions};
use super::{PoseTerm, TermDefinition, UNRELAXED};
use knotdock_structures::Knots;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "interface_predictions",
    label: "interface predictions",
    unit: "score per nat",
    time_share: UNRELAXED,
    is_shown_always: false,
    reads: "residues with a prediction",
    count: |inputs| inputs.predicted.map(<[_]>::len),
    applies: |inputs| inputs.predicted.iter().any(|side| !side.is_empty()),
    build: |inputs, weight| term(inputs.bodies, inputs.predicted, weight),
};

/// A residue with a predicted probability to be in the interface.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedResidue {
    /// Indices of its knots.
    pub atoms: Vec<usize>,
    /// Its log-odds less those of the mean probability, in nats.
    pub log_odds: f64,
}

/// Weight (the score of a nat) times the log-odds of all residues in contact.
fn term(
    [receptor, ligand]: [&Knots; 2],
    predicted: [&[PredictedResidue]; 2],
    weight: f64,
) -> PoseTerm {
    let of = |knots: &Knots, side: &[PredictedResidue]| -> Vec<(Vec<[f64; 3]>, f64)> {
        let counting = side.iter().filter(|residue| residue.log_odds != 0.0);
        counting
            .map(|residue| (positions(knots, &residue.atoms), residue.log_odds))
            .collect()
    };
    let residues = [of(receptor, predicted[0]), of(ligand, predicted[1])];
    let sides = Sides::new(receptor, ligand);
    Box::new(move |pose, _| {
        let odds = sides.sum_in_contact(&residues, pose, |(atoms, _)| atoms, |(_, odds)| *odds);
        // Without residues the score is 0, not -0.
        0.0 + weight * odds
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::se3::Pose;
    use crate::terms::pose::Workspace;

    /// Atoms at 10, 20, 30 and 40 Å on both sides; the receptor's third residue has two atoms.
    #[test]
    fn log_odds_of_residues_in_contact_are_summed() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let residue = |atoms: &[usize], log_odds| PredictedResidue {
            atoms: atoms.to_vec(),
            log_odds,
        };
        let receptor = [
            residue(&[0], 2.0),
            residue(&[1], 0.0),
            residue(&[2, 3], -0.5),
        ];
        let ligand = [residue(&[3], 4.0)];
        let term = term([&knots, &knots], [&receptor, &ligand], 10.0);
        let at = |x: f64, y: f64| {
            let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, y, 0.0]);
            term(&pose, &mut Workspace::default())
        };
        assert_eq!(at(0.0, 4.9), 55.0);
        let none = at(0.0, 5.1);
        assert!(none == 0.0 && none.is_sign_positive());
        // The ligand's first two atoms lie over the receptor's last two, which are one residue.
        assert_eq!(at(20.0, 3.0), -5.0);
        // Its last lies over the receptor's first.
        assert_eq!(at(-30.0, 3.0), 60.0);
    }
}
