//! Damped Gauss-Newton steps over small rigid moves.
//!
//! A descent makes a fixed number of steps, each a continuous function of where it starts, and accepts all of them.
//! So where it ends depends continuously on the atoms and the pose. Trials would not do: one that is accepted here and
//! refused a hair beside parts two descents for good.

use crate::rigid_move::{Derivatives, Move};
use nalgebra::{Matrix3, Vector3, Vector6};

/// Longest steps in Å, one after the other; their sum bounds the whole move.
///
/// The length of a step is the root of the squares of the shift and of the arc at the interface's radius.
pub(super) const LONGEST: [f64; 6] = [0.7, 0.455, 0.296, 0.192, 0.125, 0.081];
/// Damping of a step in RT/Å²: a part for each contact and a constant. It stands for the curvature of the atom pair
/// potential, which has either sign.
const DAMPING: [f64; 2] = [0.05, 2.0];

/// Derivatives of the energy of a move, and its contacts.
pub(super) struct Slope {
    /// Derivatives; the curvature is that of the overlaps along the lines between their atoms: positive semidefinite.
    pub by_step: Derivatives,
    /// Number of contacts, by a smooth weight.
    pub contacts: f64,
}

impl Slope {
    /// Slope of nothing.
    pub fn zero() -> Self {
        Self {
            by_step: Derivatives::zero(),
            contacts: 0.0,
        }
    }

    /// Adds an atom at `arm`, with the gradient and curvature by its position.
    #[inline(always)]
    pub fn add(&mut self, arm: &Vector3<f64>, gradient: &Vector3<f64>, curvature: &Matrix3<f64>) {
        self.by_step.push(gradient, &arm.cross(gradient));
        self.by_step.curve(arm, curvature);
    }

    /// The move after a step downhill from `at`, shorter than `longest` (Å), at an interface of `radius` (Å).
    pub fn step(&self, at: &Move, radius: f64, longest: f64) -> Move {
        let arc = 1.0 / radius;
        let scale = Vector6::new(1.0, 1.0, 1.0, arc, arc, arc);
        let mut matrix = self
            .by_step
            .curvature
            .component_mul(&(scale * scale.transpose()));
        let damping = DAMPING[0] * self.contacts + DAMPING[1];
        for axis in 0..6 {
            matrix[(axis, axis)] += damping;
        }
        // Positive definite unless a number is not finite.
        let Some(factors) = matrix.cholesky() else {
            return *at;
        };
        let step = -factors.solve(&self.by_step.gradient.component_mul(&scale));
        let step = step / (1.0 + step.norm_squared() / (longest * longest)).sqrt();
        let step = step.component_mul(&scale);
        at.then_by_halves(
            step.fixed_rows::<3>(0).into(),
            step.fixed_rows::<3>(3).into(),
        )
    }
}
