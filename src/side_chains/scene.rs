//! Both molecules of a pose, prepared for energies and for counts of clashes.

use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{HydrogenBonding, Molecule, SideChain, hydrogen_bonding};
use knotdock_structures::neighbours::{CellList, Member};

use super::energy::{Bonding, Particle, REACH};

/// Longest bond in Å of a nitrogen or oxygen to a heavy atom.
const BOND: f64 = 1.75;

/// A molecule with its properties that do not depend on the pose.
pub(super) struct Body<'a> {
    pub molecule: &'a Molecule,
    pub side_chains: Vec<SideChain>,
    /// Role of each atom in hydrogen bonds, and the heavy atoms that it is bonded to.
    bonding: Vec<Option<(HydrogenBonding, Vec<usize>)>>,
}

impl<'a> Body<'a> {
    pub fn new(molecule: &'a Molecule) -> Self {
        let atoms = &molecule.atoms;
        // An offset of the whole costs no cells.
        let origin = atoms.first().map_or([0.0; 3], |atom| atom.position);
        let heavy = atoms
            .iter()
            .enumerate()
            .filter(|(_, atom)| !atom.is_hydrogen());
        let members = heavy.map(|(place, atom)| (minus(atom.position, origin), place));
        let cells = cells(members, REACH / 2.0);
        let bonding = atoms.iter().enumerate().map(|(place, atom)| {
            let role = hydrogen_bonding(&atom.residue_name, &atom.name, &atom.element)?;
            let mut bonded = Vec::new();
            cells.visit_within(minus(atom.position, origin), BOND, |&other, _| {
                if other != place {
                    bonded.push(other);
                }
            });
            Some((role, bonded))
        });
        Self {
            molecule,
            bonding: bonding.collect(),
            side_chains: molecule.side_chains(),
        }
    }

    /// Positions of all atoms in the receptor's frame relative to `origin` (Å).
    pub fn positions(&self, pose: &Pose, origin: [f64; 3]) -> Vec<[f64; 3]> {
        let placed = self
            .molecule
            .atoms
            .iter()
            .map(|atom| pose.apply(atom.position));
        placed.map(|position| minus(position, origin)).collect()
    }

    /// An atom, with all atoms of its molecule at these positions.
    pub fn particle(&self, atom: usize, positions: &[[f64; 3]]) -> Particle {
        let position = positions[atom];
        let bonding = self.bonding[atom].as_ref().map(|(role, bonded)| Bonding {
            role: *role,
            direction: away(position, bonded, positions).map(|away| (away, bonded.len() == 1)),
        });
        Particle {
            position,
            radius: self.molecule.atoms[atom].radius,
            bonding,
        }
    }
}

/// Unit vector from the middle of the bonded atoms to an atom; `None` if there are none or it has no direction.
fn away(position: [f64; 3], bonded: &[usize], positions: &[[f64; 3]]) -> Option<[f64; 3]> {
    let middle = |axis: usize| {
        let along = bonded.iter().map(|&atom| positions[atom][axis]);
        along.sum::<f64>() / bonded.len() as f64
    };
    let arm: [f64; 3] = std::array::from_fn(|axis| position[axis] - middle(axis));
    let length = arm.iter().map(|x| x * x).sum::<f64>().sqrt();
    // Not a number without bonded atoms.
    (length > 1e-6).then(|| arm.map(|x| x / length))
}

/// Heavy atoms by place: cells of `edge` (Å) with an item for each atom.
pub(super) fn cells<T>(atoms: impl Iterator<Item = ([f64; 3], T)>, edge: f64) -> CellList<T> {
    let members = atoms.map(|(position, item)| Member { position, item });
    CellList::new(members.collect(), edge)
}

pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Two atoms clash if they are nearer than this share of the sum of their radii: carbons at 3.0 Å, a nitrogen and an
/// oxygen at 2.4 Å.
const CLASH: f64 = 0.8;

/// Pairs of heavy atoms of two placed molecules that clash; `origin` (Å) is near both.
pub(super) fn clashes(receptor: &Molecule, ligand: &Molecule, origin: [f64; 3]) -> usize {
    let heavy = |molecule: &Molecule| -> Vec<([f64; 3], f64)> {
        let atoms = molecule.atoms.iter().filter(|atom| !atom.is_hydrogen());
        let balls = atoms.map(|atom| (minus(atom.position, origin), atom.radius));
        balls.collect()
    };
    let receptor = heavy(receptor);
    let largest = receptor
        .iter()
        .map(|(_, radius)| *radius)
        .fold(0.0, f64::max);
    let cells = cells(receptor.into_iter(), REACH);
    let mut count = 0;
    for (position, radius) in heavy(ligand) {
        cells.visit_within(position, CLASH * (largest + radius), |other, square| {
            count += usize::from(square < (CLASH * (radius + other)).powi(2));
        });
    }
    count
}
