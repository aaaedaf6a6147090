//! Donors and acceptors near each other: their energy with its slope.

use super::energy::{BOND, BOND_LENGTH, BOND_RANGE, angle_weight, well};
use super::slope::Slope;
use crate::rigid_move::Move;
use nalgebra::{Matrix3, Vector3};

/// A donor and an acceptor that a move may bring together.
pub(super) struct BondPair {
    /// Ligand atom before any move relative to the centre of the interface, Å.
    pub arm: Vector3<f64>,
    /// Its direction.
    pub direction: Vector3<f64>,
    /// Receptor atom relative to the centre of the interface, Å.
    pub other: Vector3<f64>,
    /// Its direction.
    pub other_direction: Vector3<f64>,
    /// How often the bond counts: twice between opposite charges.
    pub count: f64,
}

/// Distance in Å from which no hydrogen bond has an energy.
pub(super) const BOND_REACH: f64 = BOND_LENGTH + BOND_RANGE;

impl BondPair {
    /// Adds the energy and slope of the pair at a move.
    pub fn add(&self, turn: &Matrix3<f64>, at: &Move, slope: &mut Slope) {
        let arm = turn * self.arm;
        let between = arm + at.shift - self.other;
        let square = between.norm_squared();
        if square > BOND_REACH * BOND_REACH || square == 0.0 {
            return;
        }
        let distance = square.sqrt();
        let along = between / distance;
        let direction = turn * self.direction;
        let (depth, by_distance) = well(distance - BOND_LENGTH, BOND_RANGE);
        let cosines = [self.other_direction.dot(&along), -direction.dot(&along)];
        let (first, by_first) = angle_weight(&self.other_direction, cosines[0]);
        let (second, by_second) = angle_weight(&direction, cosines[1]);
        let value = depth * first * second;
        if value == 0.0 {
            return;
        }
        slope.energy.bonds += self.count * value;
        let by_position = by_distance * first * second * along
            + depth * second * by_first / distance * (self.other_direction - cosines[0] * along)
            - depth * first * by_second / distance * (direction + cosines[1] * along);
        let by_direction = -(depth * first * by_second) * along;
        let scale = -BOND * self.count;
        let gradient = scale * by_position;
        let torque = arm.cross(&gradient) + direction.cross(&(scale * by_direction));
        slope.by_step.push(&gradient, &torque);
    }
}
