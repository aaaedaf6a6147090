//! Levenberg-Marquardt descents over rigid moves, several of them about a pose, and quasi-Newton steps to the minimum.

use super::energy::{Energy, STIFFNESS, Slope};
use super::{PairList, SharpFit};
use crate::rigid_move::Move;
use crate::se3::Pose;
use nalgebra::{Matrix6, Vector3, Vector6};

/// Rounds of a descent: stiffness in RT/Å², and most steps. The last has the stiffness of the energy.
const ROUNDS: [(f64, usize); 3] = [(0.2, 10), (1.2, 10), (STIFFNESS, 25)];
/// Longest step, Å: the root of the squares of the shift and of the arc at the interface's radius.
const MAX_STEP: f64 = 0.8;
/// Damping of a first step in RT/Å²: a part for each contact and a constant, for the curvature of contacts, which has
/// either sign.
const DAMPING: [f64; 2] = [0.02, 2.0];
/// Divisor of the damping after a step downhill, and factor after one uphill.
const EASED: f64 = 3.0;
const RAISED: f64 = 5.0;
/// A round ends with a step downhill of less than this, in RT and Å.
const SETTLED: (f64, f64) = (0.01, 0.02);
/// A round ends with a step uphill that is shorter than this, Å.
const MIN_STEP: f64 = 0.005;
/// Most quasi-Newton steps to the minimum, and halvings of a step.
const POLISHING: usize = 40;
const HALVINGS: usize = 6;
/// Least gain of a step, as a share of that at first order.
const SUFFICIENT: f64 = 1e-4;
/// Gain at first order, RT, below which a step is not worth making: the energy of the list is in f32.
const CONVERGED: f64 = 1e-3;
/// Distance of the other starts about a pose, Å: about what a search's rotations and grid leave open.
const AROUND: f64 = 1.5;

/// The end of a descent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimum {
    /// The pose.
    pub pose: Pose,
    /// Its energy.
    pub energy: Energy,
}

impl SharpFit {
    /// The optimum that a pose descends to; `None` if the bodies do not touch.
    pub fn descend(&self, pose: &Pose, list: &mut PairList) -> Option<Optimum> {
        let touches = list.begin(self, pose);
        touches.then(|| {
            let at = self.rest(&Move::default(), list);
            self.optimum(pose, &at, list)
        })
    }

    /// The best of the optima that a pose and twelve places about it descend to: 1.5 Å to either side along the
    /// interface's principal axes, and by rotations about them. `None` if the bodies do not touch.
    pub fn best_near(&self, pose: &Pose, list: &mut PairList) -> Option<Optimum> {
        if !list.begin(self, pose) {
            return None;
        }
        let first = self.rest(&Move::default(), list);
        let mut best = first;
        let mut least = list.slope(self, STIFFNESS, &best).energy.total();
        let axes = list.axes;
        let arc = AROUND / list.radius;
        for axis in axes.column_iter() {
            let axis: Vector3<f64> = axis.into();
            for sign in [-1.0, 1.0] {
                for (shift, turn) in [(AROUND, 0.0), (0.0, arc)] {
                    let mut step = Vector6::zeros();
                    step.fixed_rows_mut::<3>(0)
                        .copy_from(&(sign * shift * axis));
                    step.fixed_rows_mut::<3>(3).copy_from(&(sign * turn * axis));
                    let other = self.rest(&Move::default().then(&step), list);
                    let energy = list.slope(self, STIFFNESS, &other).energy.total();
                    if energy < least {
                        (best, least) = (other, energy);
                    }
                }
            }
        }
        let [first, best] = [first, best].map(|near| self.optimum(pose, &near, list));
        Some(if best.energy.total() < first.energy.total() {
            best
        } else {
            first
        })
    }

    /// Descends from a move of a pose to near an optimum; the list is made for where it ends.
    fn rest(&self, from: &Move, list: &mut PairList) -> Move {
        let mut at = *from;
        for (stiffness, steps) in ROUNDS {
            at = self.round(&at, stiffness, steps, list);
        }
        list.renew(self, &at);
        at
    }

    /// The optimum near a move of a pose.
    fn optimum(&self, pose: &Pose, near: &Move, list: &mut PairList) -> Optimum {
        let at = self.converged(near, list);
        let moved = self.moved(pose, &at, list);
        // At its printed digits, which give back the energy.
        let pose = Pose::from_parts(moved.quaternion(), moved.translation.into());
        Optimum {
            pose,
            energy: self.energy(&pose),
        }
    }

    /// One round at a stiffness: steps downhill from a move.
    fn round(&self, from: &Move, stiffness: f64, steps: usize, list: &mut PairList) -> Move {
        let mut at = *from;
        list.renew(self, &at);
        let mut here = list.slope(self, stiffness, &at);
        let mut value = here.energy.at(stiffness);
        let arc = 1.0 / list.radius;
        let scale = Vector6::new(1.0, 1.0, 1.0, arc, arc, arc);
        let mut damping = 1.0;
        for _ in 0..steps {
            let Some(step) = here.step(&scale, damping) else {
                break;
            };
            let length = step.norm();
            let next = at.then(&step.component_mul(&scale));
            list.renew(self, &next);
            let there = list.slope(self, stiffness, &next);
            let reached = there.energy.at(stiffness);
            let gain = value - reached;
            if gain > 0.0 {
                (at, here, value) = (next, there, reached);
                damping /= EASED;
                if gain < SETTLED.0 && length < SETTLED.1 {
                    break;
                }
            } else {
                damping *= RAISED;
                if length < MIN_STEP {
                    break;
                }
            }
        }
        at
    }

    /// The minimum near a move: quasi-Newton steps (Broyden, Fletcher, Goldfarb and Shanno; Nocedal & Wright,
    /// Numerical Optimization, 2nd ed., eq. 6.17), each halved until it goes downhill.
    fn converged(&self, from: &Move, list: &mut PairList) -> Move {
        let mut at = *from;
        list.renew(self, &at);
        let arc = 1.0 / list.radius;
        let scale = Vector6::new(1.0, 1.0, 1.0, arc, arc, arc);
        let mut here = list.slope(self, STIFFNESS, &at);
        let Some(mut inverse) = here.damped(&scale, 1.0).try_inverse() else {
            return at;
        };
        let mut gradient = here.by_step.gradient.component_mul(&scale);
        for _ in 0..POLISHING {
            let mut step = -inverse * gradient;
            step /= (1.0 + (step.norm() / MAX_STEP).powi(2)).sqrt();
            let value = here.energy.total();
            let expected = -gradient.dot(&step);
            if expected.is_nan() || expected < CONVERGED {
                break;
            }
            let mut next = None;
            for _ in 0..HALVINGS {
                let moved = at.then(&step.component_mul(&scale));
                list.renew(self, &moved);
                let there = list.slope(self, STIFFNESS, &moved);
                if there.energy.total() < value + SUFFICIENT * gradient.dot(&step) {
                    next = Some((moved, there));
                    break;
                }
                step *= 0.5;
            }
            let Some((moved, there)) = next else {
                break;
            };
            let risen = there.by_step.gradient.component_mul(&scale);
            let change = risen - gradient;
            let along = change.dot(&step);
            if along > 0.0 {
                let rate = 1.0 / along;
                let left = Matrix6::identity() - rate * step * change.transpose();
                inverse = left * inverse * left.transpose() + rate * step * step.transpose();
            }
            (at, here, gradient) = (moved, there, risen);
        }
        at
    }

    /// The pose that a move about an interface leads to from another.
    pub(super) fn moved(&self, pose: &Pose, at: &Move, list: &PairList) -> Pose {
        let about = list.middle + self.receptor_center;
        Pose {
            rotation: at.turn * pose.rotation,
            translation: at.turn * (pose.translation - about) + about + at.shift,
        }
    }
}

impl Slope {
    /// A step downhill of at most [`MAX_STEP`], its rotation as an arc in Å; `None` if a number is not finite.
    fn step(&self, scale: &Vector6<f64>, damping: f64) -> Option<Vector6<f64>> {
        let step = -self
            .damped(scale, damping)
            .cholesky()?
            .solve(&self.by_step.gradient.component_mul(scale));
        let length = step.norm();
        Some(step / (1.0 + (length / MAX_STEP).powi(2)).sqrt())
    }

    /// The curvature with its damping, rotations as arcs in Å.
    fn damped(&self, scale: &Vector6<f64>, damping: f64) -> Matrix6<f64> {
        let mut matrix: Matrix6<f64> = self
            .by_step
            .curvature
            .component_mul(&(scale * scale.transpose()));
        for axis in 0..6 {
            matrix[(axis, axis)] += damping * (DAMPING[0] * self.energy.contacts + DAMPING[1]);
        }
        matrix
    }
}
