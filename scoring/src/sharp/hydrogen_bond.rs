//! Donors and acceptors near each other: their energy with its slope.

use super::Site;
use super::energy::{BOND, BOND_LENGTH, BOND_RANGE, angle, are_opposite, well};
use super::rigid_move::{Move, Slope};
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

/// Whether two atoms carry opposite charges.
pub(super) fn is_bridge(a: &Site, b: &Site) -> bool {
    are_opposite(a.charge, b.charge)
}

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
        let [(first, by_first), (second, by_second)] = [
            (&self.other_direction, cosines[0]),
            (&direction, cosines[1]),
        ]
        .map(weighted);
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
        slope.push(&gradient, &torque);
    }
}

/// Weight of an angle and its derivative by the cosine; 1 and 0 where an atom has no direction.
fn weighted((direction, cosine): (&Vector3<f64>, f64)) -> (f64, f64) {
    if direction.norm_squared() == 0.0 {
        (1.0, 0.0)
    } else {
        angle(cosine)
    }
}
