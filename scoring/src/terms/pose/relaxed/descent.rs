//! Damped Gauss-Newton steps over small rigid moves.
//!
//! A descent makes a fixed number of steps, each a continuous function of where it starts, and accepts all of them.
//! So where it ends depends continuously on the atoms and the pose. Trials would not do: one that is accepted here and
//! refused a hair beside parts two descents for good.

use nalgebra::{Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6};

/// Longest steps in Å, one after the other; their sum bounds the whole move.
///
/// The length of a step is the root of the squares of the shift and of the arc at the interface's radius.
pub(super) const LONGEST: [f64; 6] = [0.7, 0.455, 0.296, 0.192, 0.125, 0.081];
/// Damping of a step in RT/Å²: a part for each contact and a constant. It stands for the curvature of the atom pair
/// potential, which has either sign.
const DAMPING: [f64; 2] = [0.05, 2.0];

/// A rigid move of the ligand relative to the receptor: an atom at `a` from the interface's centre goes to
/// `turn a + shift`.
#[derive(Clone, Copy)]
pub(super) struct Move {
    pub turn: UnitQuaternion<f64>,
    pub shift: Vector3<f64>,
}

impl Move {
    /// No move.
    pub fn none() -> Self {
        Self {
            turn: UnitQuaternion::identity(),
            shift: Vector3::zeros(),
        }
    }

    /// The move after a further step: a shift (Å), then a rotation (radians), of which each body makes one half.
    ///
    /// Seen from the ligand the step is its own opposite, so the bodies may be exchanged.
    pub fn then(&self, shift: Vector3<f64>, turn: Vector3<f64>) -> Self {
        Self {
            turn: UnitQuaternion::new(turn) * self.turn,
            shift: UnitQuaternion::new(0.5 * turn) * (self.shift + shift),
        }
    }
}

/// Derivatives of the energy of a move (RT), by the shift (per Å) and rotation (per radian) of a further step.
pub(super) struct Slope {
    /// First derivatives: force, then torque.
    pub gradient: Vector6<f64>,
    /// Second derivatives of the overlaps along the lines between their atoms: positive semidefinite.
    pub curvature: Matrix6<f64>,
    /// Number of contacts, by a smooth weight.
    pub contacts: f64,
}

impl Slope {
    /// Slope of nothing.
    pub fn zero() -> Self {
        Self {
            gradient: Vector6::zeros(),
            curvature: Matrix6::zeros(),
            contacts: 0.0,
        }
    }

    /// Adds an atom at `arm`, with the gradient and curvature by its position.
    #[inline(always)]
    pub fn add(&mut self, arm: &Vector3<f64>, gradient: &Vector3<f64>, curvature: &Matrix3<f64>) {
        let torque = arm.cross(gradient);
        let cross = arm.cross_matrix();
        let mixed = cross * curvature;
        let turned = mixed * cross.transpose();
        for row in 0..3 {
            self.gradient[row] += gradient[row];
            self.gradient[row + 3] += torque[row];
            for column in 0..3 {
                self.curvature[(row, column)] += curvature[(row, column)];
                self.curvature[(row + 3, column)] += mixed[(row, column)];
                self.curvature[(column, row + 3)] += mixed[(row, column)];
                self.curvature[(row + 3, column + 3)] += turned[(row, column)];
            }
        }
    }

    /// The move after a step downhill from `at`, shorter than `longest` (Å), at an interface of `radius` (Å).
    pub fn step(&self, at: &Move, radius: f64, longest: f64) -> Move {
        let arc = 1.0 / radius;
        let scale = Vector6::new(1.0, 1.0, 1.0, arc, arc, arc);
        let mut matrix = self.curvature.component_mul(&(scale * scale.transpose()));
        let damping = DAMPING[0] * self.contacts + DAMPING[1];
        for axis in 0..6 {
            matrix[(axis, axis)] += damping;
        }
        // Positive definite unless a number is not finite.
        let Some(factors) = matrix.cholesky() else {
            return *at;
        };
        let step = -factors.solve(&self.gradient.component_mul(&scale));
        let step = step / (1.0 + step.norm_squared() / (longest * longest)).sqrt();
        let step = step.component_mul(&scale);
        at.then(
            step.fixed_rows::<3>(0).into(),
            step.fixed_rows::<3>(3).into(),
        )
    }
}
