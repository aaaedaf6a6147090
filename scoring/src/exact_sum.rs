//! The exact sum of a plan's kernel over all pairs, whichever of the two kernels that is.

use crate::engine::{PairKernel, Plan};
use crate::exact::{ExactScore, ExactScorer, PoseGradient, ScoreTerms, ShapeParts};
use crate::kernel::ProductScorer;
use crate::se3::Pose;
use crate::terms::effect::Effect;
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;

/// A pair of knot sets prepared for exact scoring.
pub enum ExactSum {
    /// By the ranking kernel of the lifted axis, with further terms.
    Lifted(Box<ExactScorer>),
    /// By the product kernel: shape alone.
    Product(Box<ProductScorer>),
}

impl ExactSum {
    /// The exact sum of a plan's correlation.
    ///
    /// # Errors
    /// [`KnotsError`] on knots that cannot be summed.
    pub fn of(plan: &Plan, receptor: &Knots, ligand: &Knots) -> Result<Self, KnotsError> {
        Ok(match plan.pair() {
            PairKernel::Lifted => {
                let (kernel, terms) = (plan.kernel(), plan.effects());
                let scorer = ExactScorer::with_effects(kernel, receptor, ligand, terms)?;
                Self::Lifted(Box::new(scorer))
            }
            PairKernel::Product(kernel) => {
                Self::Product(Box::new(ProductScorer::new(kernel, receptor, ligand)?))
            }
        })
    }

    /// The score of one pose and nothing else.
    pub fn score_only(&self, pose: &Pose) -> f64 {
        self.terms(pose).score
    }

    /// Score of one pose by term.
    pub fn terms(&self, pose: &Pose) -> ScoreTerms {
        match self {
            Self::Lifted(scorer) => scorer.terms(pose),
            Self::Product(scorer) => {
                let score = scorer.score_only(pose);
                let mut terms = [0.0; Effect::ALL.len()];
                terms[Effect::Shape as usize] = score;
                ScoreTerms { score, terms }
            }
        }
    }

    /// The parts of shape's term at one pose: its slices, and the unfiltered score.
    pub fn shape(&self, pose: &Pose) -> ShapeParts {
        match self {
            Self::Lifted(scorer) => scorer.shape(pose),
            Self::Product(scorer) => {
                let found = scorer.score(pose);
                ShapeParts {
                    slices: found.slices,
                    unfiltered: found.unfiltered,
                }
            }
        }
    }

    /// Shape's score at one pose without the low-pass.
    pub fn unfiltered(&self, pose: &Pose) -> f64 {
        match self {
            Self::Lifted(scorer) => scorer.unfiltered(pose),
            Self::Product(scorer) => scorer.unfiltered(pose),
        }
    }

    /// Score and terms of one pose with the parts of shape.
    pub fn score(&self, pose: &Pose) -> ExactScore {
        match self {
            Self::Lifted(scorer) => scorer.score(pose),
            Self::Product(_) => ExactScore::of(self.terms(pose), self.shape(pose)),
        }
    }

    /// Score of one pose and its gradient over translation (Å) and rotation (radians) about the ligand's centre.
    pub fn gradient(&self, pose: &Pose) -> (f64, PoseGradient) {
        match self {
            Self::Lifted(scorer) => scorer.gradient(pose),
            Self::Product(scorer) => scorer.gradient(pose),
        }
    }
}

impl From<ExactScorer> for ExactSum {
    fn from(scorer: ExactScorer) -> Self {
        Self::Lifted(Box::new(scorer))
    }
}
