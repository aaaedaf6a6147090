//! Attraction: how many of the residues that should be in contact are.
//!
//! The search draws poses to such residues by all contacts of their atoms ([`crate::effect::restraint`]), since a correlation can count
//! nothing else; buried deep, one residue would earn what several should. So what it keeps is asked how many touch at all.

use super::cells::{Atom, Cells};
use crate::exact::center;
use crate::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::Vector3;

/// Distance in Å within which two atoms of residues are in contact, as the field counts native contacts.
const TOUCHING: f64 = 5.0;

/// The residues of both sides that should be in contact.
pub struct Attraction {
    receptor: Side,
    ligand: Side,
    weight: f64,
}

/// One side.
struct Side {
    /// The atoms of each residue that should be in contact (Å).
    residues: Vec<Vec<[f64; 3]>>,
    /// All atoms, about the middle.
    atoms: Cells,
    middle: Vector3<f64>,
}

impl Attraction {
    /// Residues as the knots that make them, of the receptor and of the ligand; `weight` is what a pose earns in which all of them touch.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        residues: &[Vec<Vec<usize>>; 2],
        weight: f64,
    ) -> Self {
        let [of_receptor, of_ligand] = residues;
        Self {
            receptor: Side::new(receptor, of_receptor),
            ligand: Side::new(ligand, of_ligand),
            weight,
        }
    }

    /// The weight times the share of the residues that touch the other side in a pose.
    pub fn score(&self, pose: &Pose) -> f64 {
        let own = self.receptor.touching(&pose.inverse(), &self.ligand);
        let other = self.ligand.touching(pose, &self.receptor);
        let all = self.receptor.residues.len() + self.ligand.residues.len();
        self.weight * (own + other) as f64 / all.max(1) as f64
    }
}

impl Side {
    fn new(knots: &Knots, residues: &[Vec<usize>]) -> Self {
        let middle = center(knots);
        let atom = |x: &[f64; 3]| Atom {
            position: Vector3::from(*x) - middle,
            kind: 0,
        };
        let centers = |residue: &Vec<usize>| {
            let centers = residue.iter().filter_map(|&index| knots.centers.get(index));
            centers.copied().collect()
        };
        Self {
            residues: residues.iter().map(centers).collect(),
            atoms: Cells::new(knots.centers.iter().map(atom).collect()),
            middle,
        }
    }

    /// Residues, carried by `pose` into the other side's frame, that have an atom within [`TOUCHING`] of one of its.
    fn touching(&self, pose: &Pose, other: &Self) -> usize {
        let touches = |atom: &[f64; 3]| {
            let x = Vector3::from(pose.apply(*atom)) - other.middle;
            let mut near = false;
            other.atoms.near(x, TOUCHING, |_, _| near = true);
            near
        };
        let residues = self.residues.iter();
        residues.filter(|atoms| atoms.iter().any(touches)).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Atoms at 10, 20, 30 and 40 Å on both sides. Residues count once, however many atoms touch; turned about, the same ones touch.
    #[test]
    fn residues_that_touch_are_counted() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let residues = [vec![vec![0], vec![2, 3]], vec![vec![1]]];
        let attraction = Attraction::new(&knots, &knots, &residues, 300.0);
        let at = |quaternion, x: f64, y: f64| {
            attraction.score(&Pose::from_parts(quaternion, [x, y, 0.0]))
        };
        let straight = [1.0, 0.0, 0.0, 0.0];
        assert_eq!(at(straight, 0.0, 4.9), 300.0);
        assert_eq!(at(straight, 0.0, 5.1), 0.0);
        // The ligand's first two atoms lie over the receptor's last two.
        assert_eq!(at(straight, 20.0, 3.0), 200.0);
        assert_eq!(at(straight, 30.0, 3.0), 100.0);
        // Half a turn about z takes atoms to -10 ... -40 Å, and 50 Å bring them back in reverse.
        assert_eq!(at([0.0, 0.0, 0.0, 1.0], 50.0, 3.0), 300.0);
        assert_eq!(at([0.0, 0.0, 0.0, 1.0], 20.0, 3.0), 100.0);
    }
}
