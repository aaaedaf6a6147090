//! Lists of the pairs of atoms near an interface.

use super::contacts::{Block, LANES, atom_sums};
use super::energy::{bond_count, distance_of};
use super::hydrogen_bond::{BOND_REACH, BondPair};
use super::slope::Slope;
use super::{SharpFit, Site};
use crate::rigid_move::Move;
use crate::se3::Pose;
use crate::vectorized::vectorized;
use nalgebra::{Matrix3, Vector3};

/// Shift in Å of a move and its angle in radians up to which a list holds every pair within reach.
const SHIFT: f64 = 1.6;
const ANGLE: f64 = 0.16;
/// Distance in Å within which pairs make the interface, whose centre and radius moves refer to.
const INTERFACE: f64 = 6.0;
/// Radius in Å that is added to that of an interface, by squares: a single contact may rotate, too.
const MIN_RADIUS: f64 = 3.0;

/// A ligand atom with receptor atoms near it.
struct Mobile {
    /// Position before any move relative to the centre of the interface, Å.
    arm: Vector3<f64>,
    /// End of its blocks; they begin where those of the previous atom end.
    end: usize,
}

/// Pairs of atoms about the interface of a pose. Buffers keep their size from one pose to the next.
#[derive(Default)]
pub struct PairList {
    mobile: Vec<Mobile>,
    blocks: Vec<Block>,
    bonds: Vec<BondPair>,
    /// Ligand atoms that a descent may bring near the receptor: index and arm.
    reachable: Vec<(usize, Vector3<f64>)>,
    /// Centre of the interface relative to the receptor's centre, Å.
    pub(super) middle: Vector3<f64>,
    /// Root mean square distance of its pairs from there, Å.
    pub(super) radius: f64,
    /// Principal axes of its spread, one a column, narrowest first.
    pub(super) axes: Matrix3<f64>,
    /// Rotation of the ligand before any move.
    matrix: Matrix3<f64>,
    /// The move at which the list was made.
    made_at: Option<Move>,
}

impl PairList {
    /// Begins at a pose: finds its interface. False if no pair is near.
    pub(super) fn begin(&mut self, fit: &SharpFit, pose: &Pose) -> bool {
        let (matrix, place) = fit.placed(pose);
        self.matrix = matrix;
        self.made_at = None;
        let (mut count, mut sum, mut squares) = (0.0, Vector3::zeros(), Matrix3::zeros());
        self.reachable.clear();
        for (index, site) in fit.ligand.iter().enumerate() {
            let at: Vector3<f64> = matrix * site.position + place;
            self.reachable.push((index, at));
            if fit.near.excludes(&at, INTERFACE) {
                continue;
            }
            fit.receptor
                .visit_within(at.into(), INTERFACE, |atom, square| {
                    let Some(other) = fit.sites.get(atom.index as usize) else {
                        return;
                    };
                    let weight = (1.0 - square / (INTERFACE * INTERFACE)).powi(2);
                    let middle = 0.5 * (at + other.position);
                    count += weight;
                    sum += weight * middle;
                    squares += weight * middle * middle.transpose();
                });
        }
        if count == 0.0 {
            return false;
        }
        let middle: Vector3<f64> = sum / count;
        let spread: Matrix3<f64> = squares / count - middle * middle.transpose();
        self.middle = middle;
        self.radius = (spread.trace().max(0.0) + MIN_RADIUS * MIN_RADIUS).sqrt();
        self.axes = principal_axes(spread);
        for (_, at) in &mut self.reachable {
            *at -= middle;
        }
        true
    }

    /// Makes the list anew where a move is too far from the one at which it was made.
    pub(super) fn renew(&mut self, fit: &SharpFit, at: &Move) {
        let holds = self.made_at.is_some_and(|made_at| {
            (at.shift - made_at.shift).norm() <= SHIFT && at.turn.angle_to(&made_at.turn) <= ANGLE
        });
        if !holds {
            self.list(fit, at);
        }
    }

    /// Lists every pair that may come within reach before the list is renewed.
    fn list(&mut self, fit: &SharpFit, at: &Move) {
        self.made_at = Some(*at);
        self.mobile.clear();
        self.blocks.clear();
        self.bonds.clear();
        let turn = *at.turn.to_rotation_matrix().matrix();
        let reachable = std::mem::take(&mut self.reachable);
        for &(index, arm) in &reachable {
            let place = turn * arm + at.shift + self.middle;
            let Some(site) = fit.ligand.get(index) else {
                continue;
            };
            let slack = SHIFT + ANGLE * arm.norm();
            if !fit.near.excludes(&place, fit.reach(site) + slack) {
                self.list_atom(fit, site, (&arm, &place), slack);
            }
        }
        self.reachable = reachable;
    }

    /// Lists the pairs of one ligand atom.
    fn list_atom(
        &mut self,
        fit: &SharpFit,
        site: &Site,
        (arm, place): (&Vector3<f64>, &Vector3<f64>),
        slack: f64,
    ) {
        let before = self.blocks.len();
        let direction = self.matrix * Vector3::from(site.polar.direction);
        let mut lane = LANES;
        let (donates, accepts) = (site.polar.donates, site.polar.accepts);
        let reach = fit.reach(site) + slack;
        fit.receptor
            .visit_within((*place).into(), reach, |atom, square| {
                let Some(other) = fit.sites.get(atom.index as usize) else {
                    return;
                };
                let position = other.position - self.middle;
                let bonds = (donates & atom.accepts) | (accepts & atom.donates);
                if lane == LANES {
                    self.blocks.push(Block::EMPTY);
                    lane = 0;
                }
                if let Some(block) = self.blocks.last_mut() {
                    block.x[lane] = position.x as f32;
                    block.y[lane] = position.y as f32;
                    block.z[lane] = position.z as f32;
                    block.contact[lane] =
                        distance_of(f64::from(atom.radius) + site.radius, bonds) as f32;
                }
                lane += 1;
                if bonds && square < (BOND_REACH + slack).powi(2) {
                    self.bonds.push(BondPair {
                        arm: *arm,
                        direction,
                        other: position,
                        other_direction: other.polar.direction.into(),
                        count: bond_count(other, site),
                    });
                }
            });
        let end = self.blocks.len();
        if end > before {
            self.mobile.push(Mobile { arm: *arm, end });
        }
    }

    /// Energy with its slope at a move over the pairs of the list; clashes are not counted.
    pub(super) fn slope(&self, stiffness: f64, at: &Move) -> Slope {
        let turn = *at.turn.to_rotation_matrix().matrix();
        let mut slope = vectorized(
            #[inline(always)]
            || self.contacts(stiffness, &turn, &at.shift),
        );
        for bond in &self.bonds {
            bond.add(&turn, at, &mut slope);
        }
        slope
    }

    /// The part of contacts and overlaps.
    #[inline(always)]
    fn contacts(&self, stiffness: f64, turn: &Matrix3<f64>, shift: &Vector3<f64>) -> Slope {
        let mut slope = Slope::zero();
        let mut from = 0;
        for atom in &self.mobile {
            let blocks = &self.blocks[from..atom.end];
            from = atom.end;
            let arm = turn * atom.arm;
            let sums = atom_sums(blocks, &(arm + shift), stiffness);
            if sums.contacts == 0.0 {
                continue;
            }
            slope.energy.contacts += sums.contacts;
            slope.energy.overlap += sums.overlap;
            slope
                .by_step
                .push(&sums.gradient, &arm.cross(&sums.gradient));
            if sums.overlap > 0.0 {
                slope.by_step.curve(&arm, &sums.curvature);
            }
        }
        slope
    }
}

/// Principal axes of a symmetric matrix, one a column, by rising eigenvalue.
fn principal_axes(matrix: Matrix3<f64>) -> Matrix3<f64> {
    let parts = matrix.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| parts.eigenvalues[a].total_cmp(&parts.eigenvalues[b]));
    Matrix3::from_columns(&order.map(|column| parts.eigenvectors.column(column)))
}
