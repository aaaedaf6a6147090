//! The pose terms that act in one docking.

use super::{POSE_TERMS, PoseTerm, TermInputs, TermValues, Workspace};
use crate::se3::Pose;

/// The pose terms that act between two bodies, prepared for scoring poses.
pub struct Rescorer {
    /// Each with its place in [`POSE_TERMS`].
    terms: Vec<(usize, Box<dyn PoseTerm>)>,
}

impl Rescorer {
    /// Prepares every term that has a positive weight and inputs to read; `None` if no term has.
    ///
    /// `weights` holds one weight for each of [`POSE_TERMS`].
    pub fn new(inputs: &TermInputs, weights: &[f64; POSE_TERMS.len()]) -> Option<Self> {
        let terms: Vec<_> = POSE_TERMS
            .iter()
            .zip(weights)
            .enumerate()
            .filter(|(_, (term, weight))| term.acts(inputs, **weight))
            .map(|(index, (term, weight))| (index, (term.build)(inputs, *weight)))
            .collect();
        (!terms.is_empty()).then_some(Self { terms })
    }

    /// Weighted values of the terms at a pose of the ligand. It allocates nothing once the workspace has grown.
    pub fn score(&self, pose: &Pose, workspace: &mut Workspace) -> TermValues {
        let mut values = TermValues::default();
        for (index, term) in &self.terms {
            values.set(*index, term.score(pose, workspace));
        }
        values
    }
}
