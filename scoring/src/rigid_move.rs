//! Small rigid moves of one body against another, and derivatives of an energy by them.

use knotdock_structures::Knots;
use nalgebra::{Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6};

/// Gradient of a score: per Å of translation, and per radian of rotation about the ligand's centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseGradient {
    /// dG / dt.
    pub force: Vector3<f64>,
    /// dG / d omega, for R -> `exp([omega]x)` R about the ligand's centre.
    pub torque: Vector3<f64>,
}

/// Middle of the bounding box, in Å: exact under scaling by powers of two, and within a rounding error under shifts.
pub fn center(knots: &Knots) -> Vector3<f64> {
    let (low, high) = knots.bounds();
    Vector3::from([0, 1, 2].map(|axis| low[axis] + 0.5 * (high[axis] - low[axis])))
}

/// Largest radius in Å of a hydrogen, whose bond holds it inside another atom.
const HYDROGEN: f64 = 1.15;

/// Index, position relative to `middle` (Å) and radius (Å) of each knot but hydrogens.
pub(crate) fn heavy_atoms(
    knots: &Knots,
    middle: Vector3<f64>,
) -> impl Iterator<Item = (usize, Vector3<f64>, f64)> {
    let atoms = knots.centers.iter().zip(&knots.radii).enumerate();
    let atoms = atoms.filter(|(_, (_, radius))| **radius > HYDROGEN);
    atoms.map(move |(index, (&x, &radius))| (index, Vector3::from(x) - middle, radius))
}

/// A rigid move of the ligand relative to the receptor: an atom at `a` from the interface's centre goes to
/// `turn a + shift`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Move {
    /// The rotation.
    pub turn: UnitQuaternion<f64>,
    /// The shift, Å.
    pub shift: Vector3<f64>,
}

impl Move {
    /// The move after a further step: a shift (Å), then a rotation vector (radians) about the ligand's own place.
    pub fn then(&self, step: &Vector6<f64>) -> Self {
        let shift: Vector3<f64> = step.fixed_rows::<3>(0).into();
        let turn: Vector3<f64> = step.fixed_rows::<3>(3).into();
        Self {
            turn: UnitQuaternion::new(turn) * self.turn,
            shift: self.shift + shift,
        }
    }

    /// The move after a further step: a shift (Å), then a rotation (radians), of which each body makes one half.
    ///
    /// Seen from the ligand the step is its own opposite, so the bodies may be exchanged.
    pub fn then_by_halves(&self, shift: Vector3<f64>, turn: Vector3<f64>) -> Self {
        Self {
            turn: UnitQuaternion::new(turn) * self.turn,
            shift: UnitQuaternion::new(0.5 * turn) * (self.shift + shift),
        }
    }
}

/// First and second derivatives of an energy (RT) by the shift (per Å) and rotation (per radian) of a further step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Derivatives {
    /// First derivatives: force, then torque.
    pub gradient: Vector6<f64>,
    /// Second derivatives.
    pub curvature: Matrix6<f64>,
}

impl Derivatives {
    /// Adds a force with its torque.
    #[inline(always)]
    pub fn push(&mut self, force: &Vector3<f64>, torque: &Vector3<f64>) {
        for row in 0..3 {
            self.gradient[row] += force[row];
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
