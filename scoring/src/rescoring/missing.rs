//! Missing residues: what a pose costs in which atoms of one side lie where the other has residues that its file does not show.
//!
//! Where they are is not known, so balls of a residue's size stand for them (`Molecule::missing_residues`), and they can only cost: a ball that is
//! touched says nothing good of a pose, for it may be elsewhere. So it has no part in shape, which would earn by its skin.

use super::side::Side;
use crate::se3::Pose;
use knotdock_structures::Knots;

/// Distance in Å from a ball's centre within which an atom lies where the ball is: radii of 3.2 and 1.8.
const WITHIN: f64 = 5.0;

/// Balls of both sides, and the atoms that should not lie in them.
pub struct MissingContacts {
    /// Centres of receptor's and ligand's balls, each in its own frame (Å).
    balls: [Vec<[f64; 3]>; 2],
    receptor: Side,
    ligand: Side,
    weight: f64,
}

impl MissingContacts {
    /// Balls of receptor and ligand; `weight` is what each atom costs that lies in some of the other side's.
    pub fn new(receptor: &Knots, ligand: &Knots, balls: [Vec<[f64; 3]>; 2], weight: f64) -> Self {
        Self {
            balls,
            receptor: Side::new(receptor),
            ligand: Side::new(ligand),
            weight,
        }
    }

    /// Minus the weight times the atoms of both sides that lie in balls of the other.
    pub fn score(&self, pose: &Pose) -> f64 {
        let [receptor, ligand] = &self.balls;
        let inverse = pose.inverse();
        let atoms = inside(&self.ligand, receptor, &inverse) + inside(&self.receptor, ligand, pose);
        // Of none nothing, not minus nothing.
        0.0 - self.weight * atoms as f64
    }
}

/// How many atoms of a side lie in balls of the other; `pose` carries these into the side's frame.
fn inside(side: &Side, balls: &[[f64; 3]], pose: &Pose) -> usize {
    let mut atoms = Vec::new();
    for ball in balls {
        side.near(pose, *ball, WITHIN, |atom| atoms.push(atom));
    }
    atoms.sort_unstable();
    atoms.dedup();
    atoms.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four atoms in a row on both sides. Each counts once, however many balls it lies in, and those of both sides count.
    #[test]
    fn atoms_in_balls_are_counted() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let balls = [
            vec![[10.0, 3.0, 0.0], [12.0, 3.0, 0.0]],
            vec![[40.0, 0.0, 4.0]],
        ];
        let missing = MissingContacts::new(&knots, &knots, balls, 7.0);
        let at =
            |quaternion, x: f64, y: f64| missing.score(&Pose::from_parts(quaternion, [x, y, 0.0]));
        let straight = [1.0, 0.0, 0.0, 0.0];
        // The ligand's first atom lies in both of the receptor's balls, and the receptor's last in the ligand's.
        assert_eq!(at(straight, 0.0, 0.0), -14.0);
        assert_eq!(at(straight, 0.0, 4.0), -7.0);
        assert_eq!(at(straight, 0.0, 9.0), 0.0);
        assert!(at(straight, 0.0, 9.0).is_sign_positive());
        // Half a turn about z and 50 Å bring the atoms back in reverse, and the ligand's ball to the receptor's first.
        assert_eq!(at([0.0, 0.0, 0.0, 1.0], 50.0, 0.0), -14.0);
        // The ligand's second atom where its first was, its ball over the end of the row.
        assert_eq!(at(straight, -10.0, 0.0), -14.0);
        assert_eq!(at(straight, 10.0, 0.0), 0.0);
    }
}
