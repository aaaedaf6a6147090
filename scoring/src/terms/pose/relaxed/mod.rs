//! Pose term `relaxed`: energy of atom pairs with a penalty on overlap, after a small rigid move that lowers it.
//!
//! Unbound surfaces overlap at some places of a grid pose and leave gaps at others, in native poses too. So an energy
//! that penalises overlap says little about a pose as it stands. It says more about one half an Ångström beside it.
//! [`Relaxation`] finds that pose by steepest descent. Rigid-body minimisation does the same before force fields rank
//! poses (Li, Chen & Weng, Proteins 53 (2003) 693-707).

mod descent;
#[cfg(test)]
mod tests;

use self::descent::{FARTHEST, Slope, descend};
use super::atom_pair_potential::AtomPairPotential;
use super::energy_table::{EnergyTable, REACH};
use super::{CELL_EDGE, PoseTerm, TermDefinition};
use crate::exact::center;
use crate::se3::Pose;
use crate::terms::weight::Weight;
use crate::vectorized::vectorized;
use knotdock_structures::Knots;
use knotdock_structures::neighbours::{CellList, Member};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "relaxed",
    label: "atom pairs once relaxed",
    weight: Weight {
        option: "relaxed-weight",
        help: "Weight of the atom pair potential with a penalty on overlap, after a rigid move of at most 2 Å; it scores poses where \
                  the contact effect is on",
        unit: "score per RT",
        default: 3.0,
    },
    time_share: 1.0,
    reads: "atoms with kinds",
    count: |inputs| inputs.atoms_with_kinds(),
    applies: |inputs| inputs.has_atom_kinds(),
    build: |inputs, weight| {
        let [receptor, ligand] = inputs.bodies;
        let potential = inputs.atom_pair_potential.cloned().unwrap_or_default();
        Box::new(Relaxation::new(receptor, ligand, &potential, weight))
    },
};

/// Depth in Å by which two atoms may overlap at no cost.
const OVERLAP: f64 = 0.1;
/// Stiffness of further overlap, RT per Å². It is soft, because atoms of unbound surfaces stand where the other
/// body's will be.
const STIFFNESS: f64 = 0.8;
/// Stiffness during the descent. It is softer still, so that single overlaps do not hold back the whole interface.
const SOFT_CORE_STIFFNESS: f64 = 0.2;
/// Largest radius in Å of a hydrogen. Hydrogens overlap the atoms that they bond to, so they do not count where a
/// file keeps them.
const HYDROGEN: f64 = 1.15;

/// Distance in Å beyond the reach up to which pairs are collected: the interface moves by at most [`FARTHEST`].
///
/// A descent may miss pairs that a long arm brings within reach. The final energy is the whole sum.
const SLACK: f64 = FARTHEST + 0.6;
/// Number of collected atoms that are sorted by distance at a time.
const CHUNK: usize = 64;
/// Least radius in Å about which an interface rotates.
const MIN_RADIUS: f64 = 3.0;

/// Two bodies prepared for relaxing poses.
///
/// The energy of a pose in RT is a sum over pairs of atoms: the atom pair potential (as [`super::AtomPairs`] reads
/// it), and 0.8 RT/Å² times the square of their overlap. The overlap is the sum of their radii less 0.1 Å and less
/// their distance. Atoms without a kind only repel. The pose descends by at most 2 Å on a like energy of a quarter of
/// that stiffness. Its score is minus the weight times the energy of the relaxed pose.
pub struct Relaxation {
    /// Atoms of the receptor, each with its index in `sites`.
    receptor: CellList<usize>,
    receptor_center: Vector3<f64>,
    sites: Vec<Site>,
    ligand: Vec<(Vector3<f64>, Site)>,
    ligand_center: Vector3<f64>,
    energies: EnergyTable,
    reach: f64,
    weight: f64,
}

/// Position relative to the receptor's centre (unused for ligand atoms), radius and kind of an atom.
#[derive(Clone, Copy)]
struct Site {
    position: Vector3<f64>,
    radius: f64,
    kind: usize,
}

/// A ligand atom with receptor atoms in its neighbourhood.
struct Mobile {
    /// Position relative to the centre of the interface, Å.
    arm: Vector3<f64>,
    site: Site,
    /// End of its neighbours in the list; they begin where those of the previous atom end.
    end: usize,
}

/// Scratch space for scoring poses by any term. Buffers keep their size from one pose to the next.
#[derive(Default)]
pub struct Workspace {
    mobile: Vec<Mobile>,
    neighbours: Vec<Site>,
}

/// A relaxed pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxed {
    /// The pose after the descent, or the original one if that is no worse.
    pub pose: Pose,
    /// Its energy in RT; lower is better.
    pub energy: f64,
}

impl PoseTerm for Relaxation {
    fn score(&self, pose: &Pose, workspace: &mut Workspace) -> f64 {
        self.score(pose, workspace)
    }
}

impl Relaxation {
    /// Prepares two sets of knots with atom kinds. `weight` is in score per RT.
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

    /// Minus the weight times the energy of the relaxed pose; higher is better.
    pub fn score(&self, pose: &Pose, workspace: &mut Workspace) -> f64 {
        -self.weight * self.relax(pose, workspace).energy
    }

    /// Energy of a pose as it stands in RT: the double sum over atoms.
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

    /// Relaxed pose with its energy, which is never above that of `pose`.
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
        // Before any move the list contains every pair within reach.
        let start = Relaxed {
            pose: *pose,
            energy: slope(&UnitQuaternion::identity(), &Vector3::zeros(), STIFFNESS).energy,
        };
        let (turn, shift) = descend(radius, |turn, shift| {
            slope(turn, shift, SOFT_CORE_STIFFNESS)
        });
        // Centre of the interface in the receptor's file frame.
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

    /// Lists the pairs that may come within reach at a pose.
    ///
    /// Returns the centre of the ligand's interface, relative to the receptor's centre, and its root mean square
    /// radius; `None` if no pair is within reach.
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

    /// Energy and gradient over the collected pairs, with the arms rotated by `turn` about `place`.
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
            for near in workspace.neighbours[from..atom.end].chunks(CHUNK) {
                // Without a branch: a third of the pairs is within reach, in an unpredictable order.
                let mut within = [(0, 0.0); CHUNK];
                let mut count = 0;
                for (index, other) in near.iter().enumerate() {
                    let square = (position - other.position).norm_squared();
                    within[count] = (index, square);
                    count += usize::from(square < limit);
                }
                for &(index, square) in &within[..count] {
                    let (other, distance) = (&near[index], square.sqrt());
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

    /// Energy of two atoms in RT and its derivative by their distance in RT/Å, at a stiffness.
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

/// The atoms of a set of knots other than hydrogens, relative to its centre. `unknown` is the kind of atoms without a
/// kind.
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
