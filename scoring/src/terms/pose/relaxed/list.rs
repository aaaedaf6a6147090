//! The ligand atoms near the receptor, their pairs, and the interface's centre and radius.

use crate::blocks::{Blocks, NearPoints};
use crate::rigid_move::Move;
use crate::se3::Pose;
use crate::vectorized::with_simd;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use pulp::Simd;

/// Distance in Å beyond the reach up to which ligand atoms are collected. Once one may have moved farther they are
/// collected anew, so that those collected make every pair within reach.
const SLACK: f64 = 2.0;
/// Radius in Å that is added to that of an interface, by squares: a single contact may rotate, too.
const MIN_RADIUS: f64 = 3.0;

/// Radius and kind of an atom.
#[derive(Clone, Copy)]
pub(super) struct Site {
    /// Radius, Å.
    pub radius: f64,
    pub kind: usize,
}

/// The atoms of two bodies.
pub(super) struct Atoms {
    /// Positions of the receptor's atoms relative to its centre.
    pub receptor: Blocks,
    pub receptor_center: Vector3<f64>,
    /// The receptor's atoms, in the order of the blocks.
    pub sites: Vec<Site>,
    pub ligand: Vec<(Vector3<f64>, Site)>,
    pub ligand_center: Vector3<f64>,
    /// Distance in Å from which no pair has an energy.
    pub reach: f64,
}

/// A ligand atom near the receptor.
pub(super) struct Mobile {
    /// Position before any move relative to the centre of the interface, Å.
    pub arm: Vector3<f64>,
    pub site: Site,
}

/// Scratch space for scoring poses by any term. Buffers keep their size from one pose to the next.
#[derive(Default)]
pub struct Workspace {
    pub(super) mobile: Vec<Mobile>,
    /// Centre of the interface relative to the receptor's, Å.
    pub(super) middle: Vector3<f64>,
    /// Receptor atoms near one of them.
    near: NearPoints,
    /// Violations of distance restraints, Å.
    pub(in crate::terms::pose) violations: Vec<f64>,
}

/// A pair of atoms within reach.
pub(super) struct Pair<'a> {
    /// The receptor's atom.
    pub receptor: &'a Site,
    /// From the receptor's atom to the ligand's, Å.
    pub between: Vector3<f64>,
    /// Square of their distance, Å².
    pub square: f64,
}

/// Place of the ligand before any move, relative to the receptor's centre.
pub(super) struct Start {
    matrix: Matrix3<f64>,
    place: Vector3<f64>,
}

/// The contact region of two bodies at a pose.
pub(super) struct Interface {
    /// Centre relative to the receptor's, Å.
    pub middle: Vector3<f64>,
    /// Root mean square distance from the centre, Å.
    pub radius: f64,
}

impl Workspace {
    /// Makes arms relative to a centre of the interface.
    fn recenter(&mut self, middle: &Vector3<f64>) {
        for atom in &mut self.mobile {
            atom.arm += self.middle - middle;
        }
        self.middle = *middle;
    }
}

impl Atoms {
    /// Place of the ligand at a pose.
    pub(super) fn start(&self, pose: &Pose) -> Start {
        Start {
            matrix: *pose.rotation.to_rotation_matrix().matrix(),
            place: pose.rotation * self.ligand_center + pose.translation - self.receptor_center,
        }
    }

    /// Collects the ligand atoms within reach and [`SLACK`] of the receptor at a move about `middle`.
    pub(super) fn collect(
        &self,
        start: &Start,
        middle: &Vector3<f64>,
        at: &Move,
        workspace: &mut Workspace,
    ) {
        workspace.mobile.clear();
        workspace.middle = *middle;
        let turn = at.turn.to_rotation_matrix();
        for &(position, site) in &self.ligand {
            let arm = start.matrix * position + start.place - middle;
            let position = (turn * arm + at.shift + middle).into();
            if self.receptor.may_be_within(&position, self.reach + SLACK) {
                workspace.mobile.push(Mobile { arm, site });
            }
        }
    }

    /// Collects anew where an atom may have moved by more than [`SLACK`] since that was done at the move `collected`.
    /// `widest` is the distance in Å of any ligand atom from the centre of the interface.
    pub(super) fn renew(
        &self,
        collected: &mut Move,
        at: &Move,
        widest: f64,
        start: &Start,
        workspace: &mut Workspace,
    ) {
        let turned = widest * at.turn.angle_to(&collected.turn);
        if (at.shift - collected.shift).norm() + turned > SLACK {
            *collected = *at;
            let middle = workspace.middle;
            self.collect(start, &middle, at, workspace);
        }
    }

    /// Visits each collected ligand atom at a move, with its arm there and the receptor atoms within reach of it.
    ///
    /// `begin` is called for an atom and its arm, `pair` for each of its pairs, `end` after them. All must be
    /// `#[inline(always)]`.
    #[inline(always)]
    pub(super) fn visit<S: Simd, T>(
        &self,
        simd: S,
        workspace: &mut Workspace,
        at: &Move,
        begin: impl Fn() -> T,
        mut pair: impl FnMut(&mut T, &Mobile, Pair),
        mut end: impl FnMut(T, &Vector3<f64>),
    ) {
        let turn = at.turn.to_rotation_matrix();
        let Workspace {
            mobile,
            middle,
            near,
            ..
        } = workspace;
        for atom in mobile.iter() {
            let arm = turn * atom.arm;
            let position = arm + at.shift + *middle;
            let mut sums = begin();
            self.receptor.near(
                simd,
                &position.into(),
                self.reach,
                near,
                #[inline(always)]
                |near| {
                    for (square, point) in near.pairs() {
                        let Some(receptor) = self.sites.get(point as usize) else {
                            debug_assert!(false, "an atom that is not there is near");
                            continue;
                        };
                        let between = position - Vector3::from(self.receptor.position(point));
                        let pair_of = Pair {
                            receptor,
                            between,
                            square,
                        };
                        pair(&mut sums, atom, pair_of);
                    }
                },
            );
            end(sums, &arm);
        }
    }

    /// Largest distance in Å of a ligand atom from `middle`.
    pub(super) fn widest(&self, start: &Start, middle: &Vector3<f64>) -> f64 {
        let squares = self
            .ligand
            .iter()
            .map(|(position, _)| (start.matrix * position + start.place - middle).norm_squared());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Centre and radius of the middles of all pairs, which weigh less the farther they are and nothing at the reach.
    /// `None` if no pair is within reach. From then on arms are relative to that centre.
    pub(super) fn interface(&self, workspace: &mut Workspace) -> Option<Interface> {
        let atoms = self;
        let middles = with_simd!(
            <'a>(atoms: &'a Atoms, workspace: &'a mut Workspace) -> MiddleSums,
            |simd| atoms.middles(simd, workspace)
        );
        if middles.count == 0.0 {
            return None;
        }
        let middle = middles.sum / middles.count;
        let spread = (middles.squares / middles.count - middle.norm_squared()).max(0.0);
        let radius = (spread + MIN_RADIUS * MIN_RADIUS).sqrt();
        workspace.recenter(&middle);
        Some(Interface { middle, radius })
    }

    /// Sums over the weighted middles of all pairs.
    #[inline(always)]
    fn middles<S: Simd>(&self, simd: S, workspace: &mut Workspace) -> MiddleSums {
        let mut sums = MiddleSums::default();
        let from = workspace.middle;
        self.visit(
            simd,
            workspace,
            &Move::default(),
            #[inline(always)]
            || (),
            #[inline(always)]
            |(), atom, pair| {
                let weight = self.contact(pair.square);
                let middle = from + atom.arm - 0.5 * pair.between;
                sums.count += weight;
                sums.sum += weight * middle;
                sums.squares += weight * middle.norm_squared();
            },
            #[inline(always)]
            |(), _| (),
        );
        sums
    }

    /// Weight of a pair by the square of its distance (Å²): from 1 to 0 at the reach, where its slope is 0 as well.
    #[inline(always)]
    pub(super) fn contact(&self, square: f64) -> f64 {
        let within = (1.0 - square / (self.reach * self.reach)).max(0.0);
        within * within
    }

    /// The pose that a move about an interface leads to from another.
    pub(super) fn moved(&self, pose: &Pose, at: &Move, middle: &Vector3<f64>) -> Pose {
        // Centre of the interface in the receptor's file frame.
        let about = middle + self.receptor_center;
        let turn: &UnitQuaternion<f64> = &at.turn;
        Pose {
            rotation: turn * pose.rotation,
            translation: turn * (pose.translation - about) + about + at.shift,
        }
    }
}

/// Sums of weights, of weighted middles (Å) and of the squares of their distances from the receptor's centre (Å²).
#[derive(Default)]
struct MiddleSums {
    count: f64,
    sum: Vector3<f64>,
    squares: f64,
}
