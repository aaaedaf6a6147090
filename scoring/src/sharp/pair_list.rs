//! Lists of the pairs of atoms near an interface.

use super::contacts::{LigandAtom, PositionLanes, atom_sums};
use super::energy::{BOND_REACH, BondPair, Slope, bond_count};
use super::{SharpFit, Site};
use crate::blocks::NearPoints;
use crate::rigid_move::Move;
use crate::se3::Pose;
use crate::vectorized::vectorize;
use nalgebra::{Matrix3, Vector3};

/// Shift in Å of a move and its angle in radians up to which a list holds every pair within reach.
const SHIFT: f64 = 0.8;
const ANGLE: f64 = 0.08;
/// Distance in Å within which pairs make the interface, whose centre and radius moves refer to.
const INTERFACE: f64 = 6.0;
/// Radius in Å that is added to that of an interface, by squares: a single contact may rotate, too.
const MIN_RADIUS: f64 = 3.0;

/// A ligand atom with receptor atoms near it.
struct Mobile {
    /// Position before any move relative to the centre of the interface, Å.
    arm: Vector3<f64>,
    atom: LigandAtom,
    /// End of its blocks; they begin where those of the previous atom end.
    end: usize,
}

/// Pairs of atoms about the interface of a pose. Buffers keep their size from one pose to the next.
#[derive(Default)]
pub struct PairList {
    mobile: Vec<Mobile>,
    /// Numbers of the receptor's blocks near each of them.
    blocks: Vec<u32>,
    /// Positions of the receptor's atoms by block.
    positions: Vec<PositionLanes>,
    near: NearPoints,
    bonds: Vec<BondPair>,
    /// Ligand atoms that a descent may bring near the receptor: index and arm.
    reachable: Vec<(usize, Vector3<f64>)>,
    /// Centre of the interface relative to the receptor's centre, Å.
    pub(super) middle: Vector3<f64>,
    /// Root mean square distance of its pairs from there, Å.
    pub(super) radius: f64,
    /// Principal axes of its spread, one per column, narrowest first.
    pub(super) axes: Matrix3<f64>,
    /// Rotation of the ligand before any move.
    matrix: Matrix3<f64>,
    /// The move at which the list was made.
    made_at: Option<Move>,
}

impl PairList {
    /// How much farther than pairs reach atoms are listed, but for atoms far from the interface, Å.
    pub(super) const USUAL_SLACK: f64 = SHIFT + 30.0 * ANGLE;

    /// Begins at a pose: finds its interface. False if no pair is near.
    pub(super) fn begin(&mut self, fit: &SharpFit, pose: &Pose) -> bool {
        let (matrix, place) = fit.placed(pose);
        self.matrix = matrix;
        self.made_at = None;
        let (mut count, mut sum, mut squares) = (0.0, Vector3::zeros(), Matrix3::zeros());
        self.reachable.clear();
        let near = &mut self.near;
        for (index, site) in fit.ligand.iter().enumerate() {
            let at: Vector3<f64> = matrix * site.position + place;
            self.reachable.push((index, at));
            fit.receptor.list_near(&at.into(), INTERFACE, near, |near| {
                for (square, atom) in near.pairs() {
                    let position = Vector3::from(fit.receptor.position(atom));
                    let weight = (1.0 - square / (INTERFACE * INTERFACE)).powi(2);
                    let middle = 0.5 * (at + position);
                    count += weight;
                    sum += weight * middle;
                    squares += weight * middle * middle.transpose();
                }
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
        PositionLanes::of_all(&fit.receptor, &middle, &mut self.positions);
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
            if !fit
                .receptor
                .excludes(&place.into(), fit.reach(site) + slack)
            {
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
        let Self {
            blocks,
            bonds,
            near,
            ..
        } = self;
        let before = blocks.len();
        let reach = fit.reach(site) + slack;
        fit.receptor
            .list_blocks(&(*place).into(), reach, |block| blocks.push(block));
        let end = blocks.len();
        if end > before {
            self.mobile.push(Mobile {
                arm: *arm,
                atom: LigandAtom::new(site),
                end,
            });
        }
        if !(site.polar.donates || site.polar.accepts) {
            return;
        }
        let direction = self.matrix * Vector3::from(site.polar.direction);
        let (middle, reach) = (self.middle, BOND_REACH + slack);
        fit.polar.list_near(&(*place).into(), reach, near, |near| {
            for (_, atom) in near.pairs() {
                let index = fit.polar_sites.get(atom as usize);
                let Some(other) = index.and_then(|&index| fit.sites.get(index)) else {
                    debug_assert!(false, "an atom that is not there is near");
                    continue;
                };
                if other.polar.may_bond(&site.polar) {
                    bonds.push(BondPair {
                        arm: *arm,
                        direction,
                        other: other.position - middle,
                        other_direction: other.polar.direction.into(),
                        count: bond_count(other, site),
                    });
                }
            }
        });
    }

    /// Energy with its slope at a move over the pairs of the list; clashes are not counted.
    pub(super) fn slope(&self, fit: &SharpFit, stiffness: f64, at: &Move) -> Slope {
        let turn = *at.turn.to_rotation_matrix().matrix();
        let mut slope = vectorize!(self.contacts(fit, stiffness, &turn, &at.shift));
        for bond in &self.bonds {
            bond.add(&turn, at, &mut slope);
        }
        slope
    }

    /// The part of contacts and overlaps.
    #[inline(always)]
    fn contacts(
        &self,
        fit: &SharpFit,
        stiffness: f64,
        turn: &Matrix3<f64>,
        shift: &Vector3<f64>,
    ) -> Slope {
        let mut slope = Slope::default();
        let mut from = 0;
        for atom in &self.mobile {
            let numbers = &self.blocks[from..atom.end];
            from = atom.end;
            let arm = turn * atom.arm;
            let sums = atom_sums(
                (numbers, &self.positions, &fit.contacts),
                atom.atom,
                &(arm + shift),
                stiffness,
            );
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

/// Principal axes of a symmetric matrix, one per column, by rising eigenvalue.
fn principal_axes(matrix: Matrix3<f64>) -> Matrix3<f64> {
    let parts = matrix.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| parts.eigenvalues[a].total_cmp(&parts.eigenvalues[b]));
    Matrix3::from_columns(&order.map(|column| parts.eigenvectors.column(column)))
}
