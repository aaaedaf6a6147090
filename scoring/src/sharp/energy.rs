//! The energy of a pose, and the functions of a distance and an angle that make it.

use super::Site;
use crate::rigid_move::{Derivatives, Move};
use nalgebra::{Matrix3, Vector3};

/// Depth of a contact, RT.
pub(super) const DEPTH: f64 = 0.25;
/// Distance beyond contact at which it ends, Å.
pub(super) const RANGE: f64 = 2.0;
/// Overlap of two atoms at no cost, Å.
pub(super) const TOLERANCE: f64 = 0.1;
/// Stiffness of further overlap, RT/Å².
pub(super) const STIFFNESS: f64 = 6.0;
/// Depth of a hydrogen bond, RT.
pub(super) const BOND: f64 = 1.5;
/// Length of a hydrogen bond between heavy atoms at which it has its whole depth, Å.
pub(super) const BOND_LENGTH: f64 = 2.8;
/// Distance beyond it at which it ends, Å.
pub(super) const BOND_RANGE: f64 = 0.9;
/// Product of charges below which a hydrogen bond is a salt bridge, e².
const OPPOSITE: f64 = -0.05;
/// Overlap from which two atoms clash, Å. MolProbity counts overlaps of 0.4 Å between all atoms as clashes (Chen et al.,
/// Acta Cryst. D66 (2010) 12-21); united atoms with their tolerance leave 0.5 Å.
pub const CLASH: f64 = 0.5;
/// Cosine from which an angle has its whole weight: 60 degrees.
const STRAIGHT: f64 = 0.5;

/// Energy of a pose by its parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Contacts, each weighed by how close it is.
    pub contacts: f64,
    /// Sum of the squares of overlaps, Å².
    pub overlap: f64,
    /// Hydrogen bonds, each weighed by its geometry; those between opposite charges count twice.
    pub bonds: f64,
    /// Overlaps deeper than 0.5 Å.
    pub clashes: usize,
}

impl Energy {
    /// The sum, RT; lower is better.
    pub fn total(&self) -> f64 {
        self.at(STIFFNESS)
    }

    /// The sum at another stiffness (RT/Å²), RT.
    pub(super) fn at(&self, stiffness: f64) -> f64 {
        stiffness * self.overlap - DEPTH * self.contacts - BOND * self.bonds
    }

    /// Adds a receptor atom and a ligand atom with the vector from the first to the second (Å), and the ligand atom's
    /// direction.
    pub(super) fn add(
        &mut self,
        receptor: &Site,
        ligand: &Site,
        between: &Vector3<f64>,
        direction: &Vector3<f64>,
    ) {
        let distance = between.norm();
        let bonds = receptor.polar.may_bond(&ligand.polar);
        let beyond = distance - contact_distance(receptor.radius + ligand.radius, bonds);
        self.contacts += well(beyond, RANGE).0;
        let lack = (-beyond).max(0.0);
        self.overlap += lack * lack;
        self.clashes += usize::from(lack > CLASH);
        if bonds && distance > 0.0 {
            let along = between / distance;
            let of_receptor = Vector3::from(receptor.polar.direction);
            let (first, _) = angle_weight(&of_receptor, of_receptor.dot(&along));
            let (second, _) = angle_weight(direction, -direction.dot(&along));
            let (depth, _) = well(distance - BOND_LENGTH, BOND_RANGE);
            self.bonds += bond_count(receptor, ligand) * depth * first * second;
        }
    }
}

/// How often a hydrogen bond of two atoms counts: twice between opposite charges.
pub(super) fn bond_count(receptor: &Site, ligand: &Site) -> f64 {
    if receptor.charge * ligand.charge < OPPOSITE {
        2.0
    } else {
        1.0
    }
}

/// Distance of contact by a sum of radii (Å), and by whether a hydrogen bond is possible.
#[inline(always)]
pub fn contact_distance(radii: f64, bonds: bool) -> f64 {
    let least = if bonds { BOND_LENGTH } else { f64::INFINITY };
    radii.min(least) - TOLERANCE
}

/// Depth of a well at a distance beyond its bottom (Å), from 1 to 0 at `range`, and its derivative.
#[inline(always)]
pub(super) fn well(beyond: f64, range: f64) -> (f64, f64) {
    let t = (beyond / range).clamp(0.0, 1.0);
    let rest = 1.0 - t * t;
    (rest * rest, -4.0 * rest * t / range)
}

/// Weight of the angle between an atom's direction and a bond, by its cosine, and the derivative: 0 from a right angle
/// on, 1 below 60 degrees and for an atom without a direction.
pub(super) fn angle_weight(direction: &Vector3<f64>, cosine: f64) -> (f64, f64) {
    if direction.norm_squared() == 0.0 {
        return (1.0, 0.0);
    }
    let t = (cosine / STRAIGHT).clamp(0.0, 1.0);
    (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / STRAIGHT)
}

/// Energy of a move with its derivatives by a further step. The curvature is that of overlaps along the lines between
/// their atoms: positive semidefinite.
#[derive(Default)]
pub(super) struct Slope {
    pub energy: Energy,
    pub by_step: Derivatives,
}

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
