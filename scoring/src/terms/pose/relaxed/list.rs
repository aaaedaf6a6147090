//! The ligand atoms near the receptor, their pairs, and the interface's centre and radius.

use crate::blocks::{Blocks, LANES, NearPoints};
use crate::lanes::each;
use crate::rigid_move::Move;
use crate::se3::Pose;
use crate::vectorized::with_simd;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use pulp::Simd;

/// Shift in Å of a move and its angle in radians up to which a list holds every pair within reach.
const SHIFT: f64 = 0.8;
const ANGLE: f64 = 0.08;
/// How much farther than pairs reach blocks are listed, but for atoms far from the interface, Å.
pub(super) const USUAL_SLACK: f64 = SHIFT + 30.0 * ANGLE;
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
    /// The receptor's atoms.
    pub receptor: Blocks,
    pub receptor_center: Vector3<f64>,
    /// The receptor's atoms with their positions relative to its centre, in the order of the blocks.
    pub sites: Vec<(Vector3<f64>, Site)>,
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
    /// End of its blocks; they begin where those of the previous atom end.
    end: usize,
}

/// Scratch space for scoring poses by any term. Buffers keep their size from one pose to the next.
#[derive(Default)]
pub struct Workspace {
    pub(super) mobile: Vec<Mobile>,
    /// Numbers of the receptor's blocks near each of them.
    blocks: Vec<u32>,
    /// Centre of the interface relative to the receptor's, Å.
    pub(super) middle: Vector3<f64>,
    /// Receptor atoms near one of them.
    near: NearPoints,
    /// Violations of distance restraints, Å.
    pub(in crate::terms::pose) violations: Vec<f64>,
}

/// Eight receptor atoms about a ligand atom. What fills up the last eight is as far away as [`FARTHEST`].
pub(super) struct Eight<'a> {
    /// From the receptor's atoms to the ligand's, along each axis, Å.
    pub between: [[f64; LANES]; 3],
    /// Squares of their distances, Å².
    pub squares: [f64; LANES],
    /// Their radii, Å.
    pub radii: [f64; LANES],
    /// Their kinds.
    pub kinds: &'a [usize; LANES],
}

/// Largest square of a distance, Å²: no energy is left there.
const FARTHEST: f64 = 1e6;

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

impl Atoms {
    /// Place of the ligand at a pose.
    pub(super) fn start(&self, pose: &Pose) -> Start {
        Start {
            matrix: *pose.rotation.to_rotation_matrix().matrix(),
            place: pose.rotation * self.ligand_center + pose.translation - self.receptor_center,
        }
    }

    /// Collects the ligand atoms that may come within reach of the receptor near a move about `middle`, and the blocks that
    /// each may reach.
    pub(super) fn collect(
        &self,
        start: &Start,
        middle: &Vector3<f64>,
        at: &Move,
        workspace: &mut Workspace,
    ) {
        workspace.mobile.clear();
        workspace.blocks.clear();
        workspace.middle = *middle;
        let turn = at.turn.to_rotation_matrix();
        for &(position, site) in &self.ligand {
            let arm = start.matrix * position + start.place - middle;
            let position = (turn * arm + at.shift + middle).into();
            let reach = self.reach + SHIFT + ANGLE * arm.norm();
            let before = workspace.blocks.len();
            let blocks = &mut workspace.blocks;
            self.receptor
                .list_blocks(&position, reach, |block| blocks.push(block));
            let end = workspace.blocks.len();
            if end > before {
                workspace.mobile.push(Mobile { arm, site, end });
            }
        }
    }

    /// Collects anew where an atom may have moved too far since that was done at the move `collected`.
    pub(super) fn renew(
        &self,
        collected: &mut Move,
        at: &Move,
        start: &Start,
        workspace: &mut Workspace,
    ) {
        let turned = at.turn.angle_to(&collected.turn);
        if (at.shift - collected.shift).norm() > SHIFT || turned > ANGLE {
            *collected = *at;
            let middle = workspace.middle;
            self.collect(start, &middle, at, workspace);
        }
    }

    /// Visits each collected ligand atom at a move, with its arm there and the receptor atoms within reach of it, eight at
    /// a time.
    ///
    /// `begin` is called for an atom, `eight` for each eight of its partners, `end` after them with the atom's arm. All
    /// must be `#[inline(always)]`.
    #[inline(always)]
    pub(super) fn visit<S: Simd, T>(
        &self,
        simd: S,
        workspace: &mut Workspace,
        at: &Move,
        begin: impl Fn() -> T,
        mut eight: impl FnMut(&mut T, &Mobile, &Eight),
        mut end: impl FnMut(T, &Vector3<f64>),
    ) {
        let turn = at.turn.to_rotation_matrix();
        let Workspace {
            mobile,
            blocks,
            middle,
            near,
            ..
        } = workspace;
        let mut from = 0;
        for atom in mobile.iter() {
            let listed = blocks.get(from..atom.end).unwrap_or_default();
            from = atom.end;
            let arm = turn * atom.arm;
            let position = arm + at.shift + *middle;
            let mut sums = begin();
            self.receptor.near_among(
                simd,
                listed,
                (&position.into(), self.reach),
                near,
                #[inline(always)]
                |near| {
                    for (squares, points) in near.eights() {
                        let mut kinds = [0; LANES];
                        let mut of = Eight {
                            between: [[0.0; LANES]; 3],
                            squares: each(|lane| squares[lane].min(FARTHEST)),
                            radii: [0.0; LANES],
                            kinds: &[0; LANES],
                        };
                        for lane in 0..LANES {
                            let Some((at, site)) = self.sites.get(points[lane] as usize) else {
                                debug_assert!(false, "an atom that is not there is near");
                                continue;
                            };
                            for axis in 0..3 {
                                of.between[axis][lane] = position[axis] - at[axis];
                            }
                            of.radii[lane] = site.radius;
                            kinds[lane] = site.kind;
                        }
                        of.kinds = &kinds;
                        eight(&mut sums, atom, &of);
                    }
                },
            );
            end(sums, &arm);
        }
    }

    /// Centre and radius of the middles of all pairs at the start, which weigh less the farther they are and nothing at the
    /// reach. `None` if no pair is within reach.
    pub(super) fn interface(&self, start: &Start, workspace: &mut Workspace) -> Option<Interface> {
        let (atoms, near) = (self, &mut workspace.near);
        let middles = with_simd!(
            <'a>(atoms: &'a Atoms, start: &'a Start, near: &'a mut NearPoints) -> MiddleSums,
            |simd| atoms.middles(simd, start, near)
        );
        if middles.count == 0.0 {
            return None;
        }
        let middle = middles.sum / middles.count;
        let spread = (middles.squares / middles.count - middle.norm_squared()).max(0.0);
        let radius = (spread + MIN_RADIUS * MIN_RADIUS).sqrt();
        Some(Interface { middle, radius })
    }

    /// Sums over the weighted middles of all pairs.
    #[inline(always)]
    fn middles<S: Simd>(&self, simd: S, start: &Start, near: &mut NearPoints) -> MiddleSums {
        let mut sums = MiddleSums::default();
        for (position, _) in &self.ligand {
            let at = start.matrix * position + start.place;
            self.receptor.near(
                simd,
                &at.into(),
                self.reach,
                near,
                #[inline(always)]
                |near| {
                    for (square, point) in near.pairs() {
                        let Some((other, _)) = self.sites.get(point as usize) else {
                            debug_assert!(false, "an atom that is not there is near");
                            continue;
                        };
                        let weight = self.contact(square);
                        let middle = 0.5 * (at + other);
                        sums.count += weight;
                        sums.sum += weight * middle;
                        sums.squares += weight * middle.norm_squared();
                    }
                },
            );
        }
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
