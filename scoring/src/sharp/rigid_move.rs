//! Small rigid moves, and the slope of the energy over them.

use super::energy::Energy;
use nalgebra::{Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6};

/// A rigid move of the ligand: an atom at `a` from the centre of the interface goes to `turn a + shift`.
#[derive(Clone, Copy, Debug)]
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

    /// The move after a further step: a shift (Å), then a rotation vector (radians) about the ligand's own place.
    pub fn then(&self, step: &Vector6<f64>) -> Self {
        let shift: Vector3<f64> = step.fixed_rows::<3>(0).into();
        let turn: Vector3<f64> = step.fixed_rows::<3>(3).into();
        Self {
            turn: UnitQuaternion::new(turn) * self.turn,
            shift: self.shift + shift,
        }
    }
}

/// Energy of a move with its first derivatives by a further step, and the curvature that overlaps give it.
pub(super) struct Slope {
    pub energy: Energy,
    /// By the shift (RT/Å), then by the rotation (RT per radian).
    pub gradient: Vector6<f64>,
    /// Second derivatives of the overlaps along the lines between their atoms: positive semidefinite.
    pub curvature: Matrix6<f64>,
}

impl Slope {
    /// Slope of nothing.
    pub fn zero() -> Self {
        Self {
            energy: Energy::default(),
            gradient: Vector6::zeros(),
            curvature: Matrix6::zeros(),
        }
    }

    /// Adds a force with its torque.
    #[inline(always)]
    pub fn push(&mut self, gradient: &Vector3<f64>, torque: &Vector3<f64>) {
        for row in 0..3 {
            self.gradient[row] += gradient[row];
            self.gradient[row + 3] += torque[row];
        }
    }

    /// Adds the curvature of an atom at `arm` by its position (RT/Å²).
    #[inline(always)]
    pub fn curve(&mut self, arm: &Vector3<f64>, curvature: &Matrix3<f64>) {
        let cross = arm.cross_matrix();
        let mixed = cross * curvature;
        let turned = mixed * cross.transpose();
        for row in 0..3 {
            for column in 0..3 {
                self.curvature[(row, column)] += curvature[(row, column)];
                self.curvature[(row + 3, column)] += mixed[(row, column)];
                self.curvature[(column, row + 3)] += mixed[(row, column)];
                self.curvature[(row + 3, column + 3)] += turned[(row, column)];
            }
        }
    }
}
