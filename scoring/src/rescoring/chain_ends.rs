//! Contacts of residues near the ends of chains, which poses pay for: those residues move, and what is docked against where they were seen is docked
//! against one place of many.

use super::side::Side;
use crate::se3::Pose;
use knotdock_structures::Knots;

/// Atoms near ends of chains of both sides, and the atoms that should not touch them.
pub struct ChainEndContacts {
    /// Positions of the atoms of receptor and ligand that are near ends, each in its own frame (Å).
    ends: [Vec<[f64; 3]>; 2],
    receptor: Side,
    ligand: Side,
    weight: f64,
}

impl ChainEndContacts {
    /// Atoms near ends of receptor and ligand, as the places of their knots; `weight` is what each costs that touches the other side.
    pub fn new(receptor: &Knots, ligand: &Knots, ends: [&[usize]; 2], weight: f64) -> Self {
        let positions = |knots: &Knots, ends: &[usize]| {
            let centers = ends.iter().filter_map(|&index| knots.centers.get(index));
            centers.copied().collect()
        };
        Self {
            ends: [positions(receptor, ends[0]), positions(ligand, ends[1])],
            receptor: Side::new(receptor),
            ligand: Side::new(ligand),
            weight,
        }
    }

    /// Minus the weight times the atoms near ends that touch the other side.
    pub fn score(&self, pose: &Pose) -> f64 {
        let [receptor, ligand] = &self.ends;
        let inverse = pose.inverse();
        let atoms =
            touching(&self.ligand, receptor, &inverse) + touching(&self.receptor, ligand, pose);
        // Of none nothing, not minus nothing.
        0.0 - self.weight * atoms as f64
    }
}

/// How many of the other side's atoms, carried by `pose` into this one's frame, touch it.
fn touching(side: &Side, atoms: &[[f64; 3]], pose: &Pose) -> usize {
    let touches = |atom: &&[f64; 3]| side.touches(pose, **atom);
    atoms.iter().filter(touches).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four atoms in a row on both sides, of which the first two of the receptor and the last of the ligand are near ends.
    #[test]
    fn atoms_near_ends_that_touch_are_counted() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let ends = ChainEndContacts::new(&knots, &knots, [&[0, 1], &[3]], 2.5);
        let at =
            |quaternion, x: f64, y: f64| ends.score(&Pose::from_parts(quaternion, [x, y, 0.0]));
        let straight = [1.0, 0.0, 0.0, 0.0];
        assert_eq!(at(straight, 0.0, 4.9), -7.5);
        assert_eq!(at(straight, 0.0, 5.1), 0.0);
        assert!(at(straight, 0.0, 5.1).is_sign_positive());
        // One place on: the receptor's second atom meets the ligand's first, and the ligand's last nothing.
        assert_eq!(at(straight, 10.0, 3.0), -2.5);
        // Half a turn about z and 50 Å bring the atoms back in reverse, so that the ligand's last meets the receptor's first.
        assert_eq!(at([0.0, 0.0, 0.0, 1.0], 50.0, 0.0), -7.5);
        // Half way between them all none is touched.
        assert_eq!(at(straight, 5.0, 1.0), 0.0);
    }

    #[test]
    fn an_atom_counts_once_however_many_it_touches() {
        let knots = Knots::new(vec![[0.0; 3], [2.0, 0.0, 0.0]], vec![1.9; 2]).unwrap();
        let ends = ChainEndContacts::new(&knots, &knots, [&[0], &[]], 2.0);
        let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
        assert_eq!(ends.score(&pose), -2.0);
    }
}
