//! Steepest descent over small rigid moves, with a step that grows while it helps.

use nalgebra::{UnitQuaternion, Vector3};

/// Largest move of the ligand in Å: the shift of its interface plus the arc of its rotation at the interface's root
/// mean square radius.
pub(super) const FARTHEST: f64 = 2.0;
/// Largest number of evaluations of energy and gradient.
const EVALUATIONS: usize = 40;
/// First, longest and shortest step in Å.
const STEPS: [f64; 3] = [0.3, 0.6, 0.005];
/// Factors of the step after one that lowered the energy, one that did not, and one that would leave the bounds.
const GROWTH: [f64; 3] = [1.25, 0.45, 0.4];

/// Energy of a move in RT, and its gradient: per Å, and per radian about the interface's centre, which moves along.
pub(super) struct Slope {
    pub energy: f64,
    pub force: Vector3<f64>,
    pub torque: Vector3<f64>,
}

/// Rotation and translation at the end of a steepest descent from the identity. Rotations are measured by their arc
/// at `radius` (Å).
pub(super) fn descend(
    radius: f64,
    mut slope: impl FnMut(&UnitQuaternion<f64>, &Vector3<f64>) -> Slope,
) -> (UnitQuaternion<f64>, Vector3<f64>) {
    let [first, longest, shortest] = STEPS;
    let [grown, failed, outside] = GROWTH;
    let (mut turn, mut shift) = (UnitQuaternion::identity(), Vector3::zeros());
    let mut here = slope(&turn, &shift);
    let mut step = first;
    for _ in 1..EVALUATIONS {
        let torque = here.torque / radius;
        let steepness = (here.force.norm_squared() + torque.norm_squared()).sqrt();
        if !steepness.is_finite() || steepness <= 1e-9 || step < shortest {
            break;
        }
        let by = step / steepness;
        let next_turn = UnitQuaternion::new(-by / radius * torque) * turn;
        let next_shift = shift - by * here.force;
        if next_shift.norm() + next_turn.angle() * radius > FARTHEST {
            step *= outside;
            continue;
        }
        let next = slope(&next_turn, &next_shift);
        if next.energy < here.energy {
            (turn, shift, here) = (next_turn, next_shift, next);
            step = (step * grown).min(longest);
        } else {
            step *= failed;
        }
    }
    (turn, shift)
}
