//! The score of two molecules in place, without a search.

use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::{TermValues, Workspace};
use knotdock_structures::molecule::Molecule;

use crate::dock::plan::plan;
use crate::options::DockOptions;
use knotdock_structures::Error;

/// The terms of a score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedScore {
    /// The exact correlation: the sum of the effects.
    pub search_score: f64,
    /// Weighted effects (`Effect as usize`); `None` where one is off.
    pub effects: [Option<f64>; Effect::ALL.len()],
    /// Weighted values of the pose terms.
    pub pose_terms: TermValues,
}

impl PlacedScore {
    /// Their sum, by which a run ranks such a pose, sharp fits left out.
    pub fn pose_score(&self) -> f64 {
        self.search_score + self.pose_terms.sum()
    }
}

/// Scores a complex as `dock` scores a pose.
///
/// # Errors
/// [`Error`] on options out of range and molecules that cannot be scored.
pub fn score_in_place(
    [receptor, ligand]: [&Molecule; 2],
    options: &DockOptions,
) -> Result<PlacedScore, Error> {
    // Nothing is searched: the fewest rotations are planned fastest.
    let options = options.changed(|options| {
        options.search.rotations = 4;
        options.search.fine_rotations = None;
    });
    let plan = plan(receptor, ligand, &options)?;
    let pose = Pose::identity();
    let terms = plan.exact_scorer()?.terms(&pose);
    let mut effects = [None; Effect::ALL.len()];
    for decision in plan.decisions.iter().filter(|decision| decision.on) {
        effects[decision.effect as usize] = Some(terms.terms[decision.effect as usize]);
    }
    let rescorer = plan.rescoring().rescorer();
    let pose_terms = rescorer.map(|rescorer| rescorer.score(&pose, &mut Workspace::default()));
    Ok(PlacedScore {
        search_score: terms.score,
        effects,
        pose_terms: pose_terms.unwrap_or_default(),
    })
}
