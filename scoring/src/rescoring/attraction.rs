//! Attraction: how many of the residues that should be in contact are.
//!
//! The search draws poses to such residues by all contacts of their atoms ([`crate::effect::restraint`]), since a correlation can count
//! nothing else; buried deep, one residue would earn what several should. So what it keeps is asked how many touch at all.

use crate::se3::Pose;
use knotdock_structures::Knots;

/// Distance in Å within which two atoms of residues are in contact, as the field counts native contacts.
const TOUCHING: f64 = 5.0;

/// The residues of both sides that should be in contact.
pub struct Attraction {
    /// Of receptor and ligand, the atoms of each such residue (Å).
    residues: [Vec<Vec<[f64; 3]>>; 2],
    /// All atoms of receptor and ligand.
    atoms: [Vec<[f64; 3]>; 2],
    weight: f64,
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
        let atoms = |knots: &Knots, residues: &[Vec<usize>]| {
            let atoms = |residue: &Vec<usize>| {
                let centers = residue.iter().filter_map(|&index| knots.centers.get(index));
                centers.copied().collect()
            };
            residues.iter().map(atoms).collect()
        };
        Self {
            residues: [atoms(receptor, of_receptor), atoms(ligand, of_ligand)],
            atoms: [receptor.centers.clone(), ligand.centers.clone()],
            weight,
        }
    }

    /// The weight times the share of the residues that touch the other side in a pose.
    pub fn score(&self, pose: &Pose) -> f64 {
        let [of_receptor, of_ligand] = &self.residues;
        let [receptor, ligand] = &self.atoms;
        let back = pose.inverse();
        let own = touching(of_receptor, &back, ligand);
        let other = touching(of_ligand, pose, receptor);
        let all = (of_receptor.len() + of_ligand.len()).max(1);
        self.weight * (own + other) as f64 / all as f64
    }
}

/// Residues, carried by `pose`, that have an atom within [`TOUCHING`] of one of the others.
fn touching(residues: &[Vec<[f64; 3]>], pose: &Pose, others: &[[f64; 3]]) -> usize {
    let touches = |atom: &[f64; 3]| {
        let x = pose.apply(*atom);
        others.iter().any(|y| {
            let squares = (0..3).map(|axis| (x[axis] - y[axis]).powi(2));
            squares.sum::<f64>() <= TOUCHING * TOUCHING
        })
    };
    let residues = residues.iter();
    residues.filter(|atoms| atoms.iter().any(touches)).count()
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
