//! What a pose is worth once its two bodies may give way to each other: the energy of atoms that must not overlap, where small rigid moves bring it down.
//!
//! Unbound surfaces laid on each other at the places of a grid overlap here and miss each other there, natively or not, so an energy that
//! asks atoms to keep apart says little of a pose as it stands. Half an Ångström to the side it may. [`Relaxation`] looks for that place, as rigid-body
//! minimisation does before poses are ranked by force fields (Li, Chen & Weng, Proteins 53 (2003) 693-707), by steepest descent with a step that
//! grows while it helps.

mod descent;
#[cfg(test)]
mod tests;

use self::descent::{FARTHEST, Slope, descend};
use super::CELL_EDGE;
use super::energy_table::{EnergyTable, REACH};
use super::pair_potential::AtomPairPotential;
use crate::exact::center;
use crate::se3::Pose;
use crate::vectorized::vectorized;
use knotdock_structures::Knots;
use knotdock_structures::neighbours::{CellList, Member};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// What atoms may come closer than their radii add up to, in Å.
const OVERLAP: f64 = 0.1;
/// What overlapping further costs, RT per Å²: a cushion, not a wall, for atoms of unbound surfaces stand where the other body's will be.
const STIFFNESS: f64 = 0.8;
/// The same while the pose gives way: softer, so that single overlaps do not hold back what the whole interface gains.
const SOFT_CORE_STIFFNESS: f64 = 0.2;
/// Radius in Å up to which an atom is a hydrogen, which reaches into what it is bonded to by: where hydrogens are kept they take no part.
const HYDROGEN: f64 = 1.15;

/// Pairs that may come within reach are listed once, a little farther out than the interface is moved. A descent may miss some that a long arm brings near; the
/// energy told of where it ends is the whole sum.
const SLACK: f64 = FARTHEST + 0.6;
/// Listed atoms that are sorted by distance at a time.
const CHUNK: usize = 64;
/// Least radius in Å about which an interface turns.
const MIN_RADIUS: f64 = 3.0;

/// Two bodies prepared for relaxing poses.
///
/// The energy of a pose, in RT, is the sum over pairs of atoms of the atom pair potential (as [`super::AtomPairs`] reads it) and of 0.8 RT/Å² times the square
/// of what they lack of touching, the sum of their radii less 0.1 Å. Atoms without a kind only push. The pose descends by at most 2 Å on a like energy with a quarter of that
/// stiffness, and scores minus the weight times its energy where it comes to rest.
pub struct Relaxation {
    /// Atoms of the receptor, each by its number in `sites`.
    receptor: CellList<usize>,
    receptor_center: Vector3<f64>,
    sites: Vec<Site>,
    ligand: Vec<(Vector3<f64>, Site)>,
    ligand_center: Vector3<f64>,
    energies: EnergyTable,
    reach: f64,
    weight: f64,
}

/// An atom as the sums need it: its place relative to the receptor's middle (of a ligand's atom unused), radius and kind.
#[derive(Clone, Copy)]
struct Site {
    position: Vector3<f64>,
    radius: f64,
    kind: usize,
}

/// A ligand atom with receptor atoms in its neighbourhood.
struct Mobile {
    /// Relative to the middle of the interface, Å.
    arm: Vector3<f64>,
    site: Site,
    /// The last of its neighbours in the list, which begin where those of the atom before end.
    end: usize,
}

/// Buffers of a relaxation, which keep their size from one pose to the next.
#[derive(Default)]
pub struct Workspace {
    mobile: Vec<Mobile>,
    neighbours: Vec<Site>,
}

/// A pose that gave way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxed {
    /// Where it came to rest, or where it stood if that is no worse.
    pub pose: Pose,
    /// Energy there in RT; lower is better.
    pub energy: f64,
}

impl Relaxation {
    /// Prepares two sets of knots with kinds of atoms; `weight` is score per RT.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        potential: &AtomPairPotential,
        weight: f64,
    ) -> Self {
        let energies = EnergyTable::new(potential);
        let (receptor_center, ligand_center) = (center(receptor), center(ligand));
        let bodies = [(receptor, receptor_center), (ligand, ligand_center)];
        let [receptor, ligand] =
            bodies.map(|(knots, middle)| sites(knots, middle, energies.unknown()));
        let widest = |body: &[(Vector3<f64>, Site)]| {
            let radii = body.iter().map(|(_, site)| site.radius);
            radii.fold(0.0, f64::max)
        };
        let atoms = receptor.iter().enumerate();
        let atoms = atoms.map(|(item, &(position, _))| Member {
            position: position.into(),
            item,
        });
        Self {
            receptor: CellList::new(atoms.collect(), CELL_EDGE),
            receptor_center,
            reach: REACH.max(widest(&receptor) + widest(&ligand)),
            sites: receptor.iter().map(|(_, site)| *site).collect(),
            ligand,
            ligand_center,
            energies,
            weight,
        }
    }

    /// What a pose of the ligand is worth once relaxed; higher is better.
    pub fn score(&self, pose: &Pose, workspace: &mut Workspace) -> f64 {
        -self.weight * self.relax(pose, workspace).energy
    }

    /// Energy of a pose as it stands, in RT: the double sum, in double precision.
    pub fn energy(&self, pose: &Pose) -> f64 {
        let matrix = pose.rotation.to_rotation_matrix();
        let place = pose.rotation * self.ligand_center + pose.translation - self.receptor_center;
        let mut total = 0.0;
        for (position, site) in &self.ligand {
            let mut sum = 0.0;
            let near = matrix * position + place;
            self.receptor
                .visit_within(near.into(), self.reach, |&atom, square| {
                    let other = &self.sites[atom];
                    let (energy, _) = self.pair(other, site, square.sqrt(), STIFFNESS);
                    sum += energy;
                });
            total += sum;
        }
        total
    }

    /// Where a pose comes to rest, and its energy there: never above that of the pose itself.
    pub fn relax(&self, pose: &Pose, workspace: &mut Workspace) -> Relaxed {
        let Some((middle, radius)) = self.list(pose, workspace) else {
            return Relaxed {
                pose: *pose,
                energy: 0.0,
            };
        };
        let slope = |turn: &UnitQuaternion<f64>, shift: &Vector3<f64>, stiffness: f64| {
            vectorized(
                #[inline(always)]
                || {
                    self.slope(
                        workspace,
                        &turn.to_rotation_matrix(),
                        &(middle + shift),
                        stiffness,
                    )
                },
            )
        };
        // Where nothing has moved the list has all that is within reach.
        let start = Relaxed {
            pose: *pose,
            energy: slope(&UnitQuaternion::identity(), &Vector3::zeros(), STIFFNESS).energy,
        };
        let (turn, shift) = descend(radius, |turn, shift| {
            slope(turn, shift, SOFT_CORE_STIFFNESS)
        });
        // About the interface's middle, in the receptor's file frame.
        let about = middle + self.receptor_center;
        let pose = Pose {
            rotation: turn * pose.rotation,
            translation: turn * (pose.translation - about) + about + shift,
        };
        let energy = self.energy(&pose);
        if energy < start.energy {
            Relaxed { pose, energy }
        } else {
            start
        }
    }

    /// Lists what may come within reach at a pose. Middle and root mean square radius of the ligand's interface, relative to the receptor's middle; `None` where
    /// nothing is within reach.
    fn list(&self, pose: &Pose, workspace: &mut Workspace) -> Option<(Vector3<f64>, f64)> {
        let Workspace { mobile, neighbours } = workspace;
        mobile.clear();
        neighbours.clear();
        let matrix = pose.rotation.to_rotation_matrix();
        let place = pose.rotation * self.ligand_center + pose.translation - self.receptor_center;
        let (mut count, mut sum, mut squares) = (0.0, Vector3::zeros(), 0.0);
        for &(position, site) in &self.ligand {
            let position = matrix * position + place;
            let mut nearest = f64::INFINITY;
            self.receptor
                .visit_within(position.into(), self.reach + SLACK, |&atom, square| {
                    nearest = nearest.min(square);
                    neighbours.push(self.sites[atom]);
                });
            if nearest < f64::INFINITY {
                let end = neighbours.len();
                let arm = position;
                mobile.push(Mobile { arm, site, end });
            }
            if nearest < self.reach * self.reach {
                count += 1.0;
                sum += position;
                squares += position.norm_squared();
            }
        }
        if count == 0.0 {
            return None;
        }
        let middle = sum / count;
        for atom in mobile.iter_mut() {
            atom.arm -= middle;
        }
        let spread = (squares / count - middle.norm_squared()).max(0.0);
        Some((middle, spread.sqrt().max(MIN_RADIUS)))
    }

    /// Energy and gradient over the listed pairs, the arms turned and laid at a place.
    #[inline(always)]
    fn slope(
        &self,
        workspace: &Workspace,
        turn: &Rotation3<f64>,
        place: &Vector3<f64>,
        stiffness: f64,
    ) -> Slope {
        let turn: &Matrix3<f64> = turn.matrix();
        let mut slope = Slope {
            energy: 0.0,
            force: Vector3::zeros(),
            torque: Vector3::zeros(),
        };
        let limit = self.reach * self.reach;
        let mut from = 0;
        for atom in &workspace.mobile {
            let arm = turn * atom.arm;
            let position = arm + place;
            let (mut energy, mut force) = (0.0, Vector3::zeros());
            for listed in workspace.neighbours[from..atom.end].chunks(CHUNK) {
                // Without a branch: a third of the pairs is within reach, in no order that could be foreseen.
                let mut within = [(0, 0.0); CHUNK];
                let mut count = 0;
                for (index, other) in listed.iter().enumerate() {
                    let square = (position - other.position).norm_squared();
                    within[count] = (index, square);
                    count += usize::from(square < limit);
                }
                for &(index, square) in &within[..count] {
                    let (other, distance) = (&listed[index], square.sqrt());
                    let (value, rise) = self.pair(other, &atom.site, distance, stiffness);
                    energy += value;
                    force += rise / distance.max(1e-6) * (position - other.position);
                }
            }
            from = atom.end;
            slope.energy += energy;
            slope.force += force;
            slope.torque += arm.cross(&force);
        }
        slope
    }

    /// Energy of two atoms in RT and its derivative by their distance in Å, with a stiffness.
    #[inline(always)]
    fn pair(&self, receptor: &Site, ligand: &Site, distance: f64, stiffness: f64) -> (f64, f64) {
        let (energy, rise) = self.energies.at(receptor.kind, ligand.kind, distance);
        let lack = (receptor.radius + ligand.radius - OVERLAP - distance).max(0.0);
        (
            energy + stiffness * lack * lack,
            rise - 2.0 * stiffness * lack,
        )
    }
}

/// The atoms of a set of knots that take part, relative to its middle; `unknown` is the kind of those without one.
fn sites(knots: &Knots, middle: Vector3<f64>, unknown: usize) -> Vec<(Vector3<f64>, Site)> {
    let atoms = knots.centers.iter().zip(&knots.radii).enumerate();
    let atoms = atoms.filter(|(_, (_, radius))| **radius > HYDROGEN);
    atoms
        .map(|(index, (&x, &radius))| {
            let position = Vector3::from(x) - middle;
            let kind = knots.atom_kinds.get(index).copied().flatten();
            let kind = kind.map_or(unknown, |kind| usize::from(kind).min(unknown));
            let site = Site {
                position,
                radius,
                kind,
            };
            (position, site)
        })
        .collect()
}
