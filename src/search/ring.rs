//! Poses of rings off the grid: what the search's peaks become, and their climb among rings.

use super::refine::{ClimbLimits, climb};
use knotdock_scoring::exact::{ExactScorer, PoseGradient};
use knotdock_scoring::field::ReceptorField;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::symmetry::{Cyclic, conjugated, conjugated_gradient};
use nalgebra::Vector3;

/// The ring that climbs highest from `pose`, which the grid found, and its score with that of copies beyond the neighbours, by the fast path.
pub(super) fn climb_ring(
    symmetry: Cyclic,
    field: &ReceptorField,
    center: Vector3<f64>,
    pose: &Pose,
    limits: &ClimbLimits,
) -> (Pose, f64) {
    let (top, score) = climb(
        symmetry.nearest(pose),
        center,
        limits,
        |pose| whole(symmetry, field, center, pose),
        |pose, turn, shift| conjugated(pose, center, turn, shift),
    );
    // Rounding adds up over the steps.
    (symmetry.nearest(&top), score)
}

/// Score of a ring for each pair of neighbours, with its gradient by moves of the molecule under the axis.
fn whole(
    symmetry: Cyclic,
    field: &ReceptorField,
    center: Vector3<f64>,
    pose: &Pose,
) -> (f64, PoseGradient) {
    let of = |pose: &Pose| {
        let (score, gradient) = field.gradient(pose);
        (score, conjugated_gradient(pose, center, &gradient))
    };
    symmetry
        .beyond(pose)
        .fold(of(pose), |(score, gradient), (other, pairs)| {
            let (more, slope) = of(&other);
            let gradient = PoseGradient {
                force: gradient.force + pairs * slope.force,
                torque: gradient.torque + pairs * slope.torque,
            };
            (score + pairs * more, gradient)
        })
}

/// Exact score between copies that are no neighbours, for each pair of neighbours; `None` where all are.
pub(super) fn other_copies(symmetry: Cyclic, scorer: &ExactScorer, pose: &Pose) -> Option<f64> {
    let score = |(pose, pairs): (Pose, f64)| pairs * scorer.score_only(&pose);
    symmetry
        .has_beyond()
        .then(|| symmetry.beyond(pose).map(score).sum())
}
