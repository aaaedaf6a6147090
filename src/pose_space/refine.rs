//! Refinement of a pose off the grid, over translation and rotation together (BFGS).
//!
//! The ascent follows the potential grid: the fast path's values, read between its grid points. The exact pair sum at
//! the pose reached is reported afterwards. The caller undoes an ascent that the exact sum does not confirm.

use knotdock_scoring::exact::PoseGradient;
use knotdock_scoring::se3::Pose;
use nalgebra::{Matrix6, UnitQuaternion, Vector3, Vector6};

/// Bounds of an ascent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AscentLimits {
    /// Score evaluations at most.
    pub evaluations: usize,
    /// Farthest the ligand's centre may move, Å.
    pub distance: f64,
    /// Farthest it may turn, radians.
    pub angle: f64,
    /// Radius of gyration of the ligand, Å: an angle times this is a length, so that both kinds of step compare.
    pub gyration: f64,
    /// Length in place of one Ångström: no step is longer, the first is a quarter of it, and the last a thousandth.
    pub angstrom: f64,
}

/// A peak of the search, and the pose that it was refined to.
#[derive(Clone, Copy)]
pub(crate) struct RefinedPose {
    /// The pose before refinement: the grid's, or the ring nearest to it.
    pub start: Pose,
    /// The pose after refinement.
    pub pose: Pose,
    /// The fast path's score at `pose`, of all copies of a ring.
    pub score: f64,
    /// Whether refinement found a better pose.
    pub refined: bool,
}

impl RefinedPose {
    /// A grid pose, and the refined one if that is better.
    pub fn best_of(grid: (Pose, f64), refined: Option<(Pose, f64)>) -> Self {
        let (start, score) = grid;
        let better = refined.filter(|(_, higher)| *higher > score);
        let (pose, score) = better.unwrap_or(grid);
        Self {
            start,
            pose,
            score,
            refined: better.is_some(),
        }
    }
}

/// The pose that its printed digits give back: normalised, w not negative.
pub(crate) fn printed(pose: &Pose) -> Pose {
    Pose::from_parts(pose.quaternion(), pose.translation.into())
}

/// Maximizes a score from `start`. Returned are the best pose found and its score.
///
/// `score` gives value and gradient (per Å, per radian). `moved` applies a rotation and a shift to a pose: to the
/// ligand about its centre ([`rigid_body`]), or to the two bodies of a ring together.
pub fn maximize(
    start: Pose,
    ligand_center: Vector3<f64>,
    limits: &AscentLimits,
    score: impl Fn(&Pose) -> (f64, PoseGradient),
    moved: impl Fn(&Pose, UnitQuaternion<f64>, Vector3<f64>) -> Pose,
) -> (Pose, f64) {
    // Variables: translation in Å and rotation times the radius of gyration, about the ligand's centre.
    let radius = limits.gyration.max(f64::MIN_POSITIVE);
    let slope = |gradient: &PoseGradient| {
        let (f, t) = (gradient.force, gradient.torque / radius);
        Vector6::new(f[0], f[1], f[2], t[0], t[1], t[2])
    };
    let moved = |pose: &Pose, step: &Vector6<f64>| {
        let turn = UnitQuaternion::new(step.fixed_rows::<3>(3) / radius);
        moved(pose, turn, step.fixed_rows::<3>(0).into())
    };
    let within = |pose: &Pose| {
        let from = start.rotation * ligand_center + start.translation;
        let to = pose.rotation * ligand_center + pose.translation;
        (to - from).norm() <= limits.distance && pose.angle_to(&start) <= limits.angle
    };
    let mut pose = start;
    let (mut value, gradient) = score(&pose);
    let mut gradient = slope(&gradient);
    let first_length = 0.25 * limits.angstrom;
    let scaled = |gradient: &Vector6<f64>| {
        Matrix6::identity() * (first_length / gradient.norm().max(f64::MIN_POSITIVE))
    };
    let mut inverse = scaled(&gradient);
    let mut fresh = true;
    let mut evaluations = 1;
    while evaluations < limits.evaluations {
        let mut step = inverse * gradient;
        if step.dot(&gradient) <= 0.0 {
            inverse = scaled(&gradient);
            step = inverse * gradient;
        }
        let length = step.norm();
        if !length.is_finite() || length < 1e-3 * limits.angstrom {
            break;
        }
        step *= (limits.angstrom / length).min(1.0);
        // Halve until the score rises enough (Armijo).
        let mut next = None;
        while evaluations < limits.evaluations && step.norm() > 1e-4 * limits.angstrom {
            let trial = moved(&pose, &step);
            if within(&trial) {
                let (trial_value, trial_gradient) = score(&trial);
                evaluations += 1;
                if trial_value > value + 1e-4 * step.dot(&gradient) {
                    next = Some((trial, trial_value, slope(&trial_gradient)));
                    break;
                }
            }
            step *= 0.4;
        }
        let Some((next_pose, next_value, next_gradient)) = next else {
            break;
        };
        // BFGS on -score: y is the fall of the gradient.
        let y = gradient - next_gradient;
        let curvature = step.dot(&y);
        if curvature > 1e-10 * step.norm() * y.norm() {
            if fresh {
                inverse = Matrix6::identity() * (curvature / y.norm_squared());
                fresh = false;
            }
            let rho = 1.0 / curvature;
            let left = Matrix6::identity() - rho * step * y.transpose();
            inverse = left * inverse * left.transpose() + rho * step * step.transpose();
        }
        let gain = next_value - value;
        (pose, value, gradient) = (next_pose, next_value, next_gradient);
        if gain < 1e-4 * value.abs() {
            break;
        }
    }
    (pose, value)
}

/// Rotates the ligand about its centre, and shifts it.
pub fn rigid_body(
    ligand_center: Vector3<f64>,
) -> impl Fn(&Pose, UnitQuaternion<f64>, Vector3<f64>) -> Pose {
    move |pose, turn, shift| {
        let center = pose.rotation * ligand_center + pose.translation;
        Pose::about(turn * pose.rotation, ligand_center, center + shift)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A paraboloid in position and angle has one top; the ascent must find it to its stopping length.
    #[test]
    fn finds_the_top_of_a_paraboloid() {
        let top = Pose::from_parts([0.99, 0.05, -0.04, 0.06], [1.0, -0.7, 0.4]);
        let score = |pose: &Pose| {
            let d = top.translation - pose.translation;
            let turn = (top.rotation * pose.rotation.inverse()).scaled_axis();
            let value = 100.0 - 3.0 * d.norm_squared() - 200.0 * turn.norm_squared();
            let gradient = PoseGradient {
                force: 6.0 * d,
                torque: 400.0 * turn,
            };
            (value, gradient)
        };
        let limits = AscentLimits {
            evaluations: 60,
            distance: 5.0,
            angle: 1.0,
            gyration: 10.0,
            angstrom: 1.0,
        };
        let (found, _) = maximize(
            Pose::identity(),
            Vector3::zeros(),
            &limits,
            score,
            rigid_body(Vector3::zeros()),
        );
        assert!((found.translation - top.translation).norm() < 0.01);
        assert!(found.angle_to(&top) < 0.002);
    }

    #[test]
    fn stays_within_its_limits_and_never_falls() {
        let score = |pose: &Pose| {
            let gradient = PoseGradient {
                force: Vector3::new(1.0, 0.0, 0.0),
                torque: Vector3::zeros(),
            };
            (pose.translation[0], gradient)
        };
        let limits = AscentLimits {
            evaluations: 100,
            distance: 2.0,
            angle: 0.2,
            gyration: 10.0,
            angstrom: 1.0,
        };
        let (found, _) = maximize(
            Pose::identity(),
            Vector3::zeros(),
            &limits,
            score,
            rigid_body(Vector3::zeros()),
        );
        assert!(found.translation[0] > 1.5 && found.translation.norm() <= 2.0);
    }
}
