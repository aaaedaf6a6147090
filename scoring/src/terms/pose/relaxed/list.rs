//! Lists of the pairs of atoms near an interface, and the interface's centre and radius.

use crate::rigid_move::Move;
use crate::se3::Pose;
use knotdock_structures::neighbours::CellList;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// Distance in Å beyond the reach up to which pairs are collected. Once an atom may have moved farther they are collected
/// anew, so that a list holds every pair within reach.
const SLACK: f64 = 2.0;
/// Radius in Å that is added to that of an interface, by squares: a single contact may rotate, too.
const MIN_RADIUS: f64 = 3.0;

/// Position relative to the receptor's centre (unused for ligand atoms), radius and kind of an atom.
#[derive(Clone, Copy)]
pub(super) struct Site {
    pub position: Vector3<f64>,
    pub radius: f64,
    pub kind: usize,
}

/// The atoms of two bodies.
pub(super) struct Atoms {
    /// Atoms of the receptor, each with its index in `sites`.
    pub receptor: CellList<usize>,
    pub receptor_center: Vector3<f64>,
    pub sites: Vec<Site>,
    pub ligand: Vec<(Vector3<f64>, Site)>,
    pub ligand_center: Vector3<f64>,
    /// Distance in Å from which no pair has an energy.
    pub reach: f64,
}

/// A ligand atom with receptor atoms in its neighbourhood.
pub(super) struct Mobile {
    /// Position before any move relative to the centre of the interface, Å.
    pub arm: Vector3<f64>,
    pub site: Site,
    /// End of its neighbours in the list; they begin where those of the previous atom end.
    pub end: usize,
}

/// Scratch space for scoring poses by any term. Buffers keep their size from one pose to the next.
#[derive(Default)]
pub struct Workspace {
    pub(super) mobile: Vec<Mobile>,
    /// Receptor atoms relative to the centre of the interface.
    pub(super) neighbours: Vec<Site>,
}

/// Where the ligand stands before any move, relative to the receptor's centre.
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
    /// Makes a list that is relative to the receptor's centre relative to `middle`.
    pub(super) fn recenter(&mut self, middle: &Vector3<f64>) {
        for atom in &mut self.mobile {
            atom.arm -= middle;
        }
        for site in &mut self.neighbours {
            site.position -= middle;
        }
    }

    /// Each collected ligand atom with its neighbours.
    pub(super) fn atoms(&self) -> impl Iterator<Item = (&Mobile, &[Site])> {
        let mut from = 0;
        self.mobile.iter().map(move |atom| {
            let near = &self.neighbours[from..atom.end];
            from = atom.end;
            (atom, near)
        })
    }
}

impl Atoms {
    /// Where the ligand stands at a pose.
    pub(super) fn start(&self, pose: &Pose) -> Start {
        Start {
            matrix: *pose.rotation.to_rotation_matrix().matrix(),
            place: pose.rotation * self.ligand_center + pose.translation - self.receptor_center,
        }
    }

    /// Lists the pairs within reach and [`SLACK`] at a move about `middle`.
    pub(super) fn list(
        &self,
        start: &Start,
        middle: &Vector3<f64>,
        at: &Move,
        workspace: &mut Workspace,
    ) {
        let Workspace { mobile, neighbours } = workspace;
        mobile.clear();
        neighbours.clear();
        let matrix = at.turn.to_rotation_matrix();
        for &(position, site) in &self.ligand {
            let arm = start.matrix * position + start.place - middle;
            let position = matrix * arm + at.shift + middle;
            let before = neighbours.len();
            let reach = self.reach + SLACK;
            self.receptor
                .visit_within(position.into(), reach, |&atom, _| {
                    let site = self.sites[atom];
                    let position = site.position - middle;
                    neighbours.push(Site { position, ..site });
                });
            let end = neighbours.len();
            if end > before {
                mobile.push(Mobile { arm, site, end });
            }
        }
    }

    /// Lists pairs anew where an atom may have moved by more than [`SLACK`] since they were collected at the move
    /// `collected`. `widest` is the distance in Å of any ligand atom from `middle`.
    pub(super) fn renew(
        &self,
        collected: &mut Move,
        at: &Move,
        widest: f64,
        (start, middle): (&Start, &Vector3<f64>),
        workspace: &mut Workspace,
    ) {
        let turned = widest * at.turn.angle_to(&collected.turn);
        if (at.shift - collected.shift).norm() + turned > SLACK {
            *collected = *at;
            self.list(start, middle, at, workspace);
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
    /// `None` if no pair is within reach. The list is relative to the receptor's centre.
    pub(super) fn interface(&self, workspace: &Workspace) -> Option<Interface> {
        let (mut count, mut sum, mut squares) = (0.0, Vector3::zeros(), 0.0);
        for (atom, near) in workspace.atoms() {
            for other in near {
                let square = (atom.arm - other.position).norm_squared();
                let weight = self.contact(square);
                let middle = 0.5 * (atom.arm + other.position);
                count += weight;
                sum += weight * middle;
                squares += weight * middle.norm_squared();
            }
        }
        if count == 0.0 {
            return None;
        }
        let middle = sum / count;
        let spread = (squares / count - middle.norm_squared()).max(0.0);
        let radius = (spread + MIN_RADIUS * MIN_RADIUS).sqrt();
        Some(Interface { middle, radius })
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
