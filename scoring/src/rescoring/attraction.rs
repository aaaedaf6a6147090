//! Attraction: how many of the residues that should be in contact are, those that a user names or those of an enzyme's active site, of which a
//! molecule may have several.
//!
//! The search draws poses to residues that are named by all contacts of their atoms ([`crate::effect::restraint`]), since a correlation can count
//! nothing else; buried deep, one residue would earn what several should. So what it keeps is asked how many touch at all.

use super::side::Side;
use crate::se3::Pose;
use knotdock_structures::Knots;

/// Residues of receptor and ligand, each as the places of its knots.
pub type Residues = [Vec<Vec<usize>>; 2];

/// Residues of both sides that should be in contact.
pub struct Attraction {
    /// Sets of residues of receptor and ligand, each as the positions of its atoms (Å); those of one set should touch.
    sets: Vec<[Vec<Positions>; 2]>,
    receptor: Side,
    ligand: Side,
    weight: f64,
}

/// Where the atoms of a residue stand (Å).
type Positions = Vec<[f64; 3]>;

impl Attraction {
    /// Sets of residues, any one of which should be in contact; `weight` is what a pose earns in which all residues of a set touch.
    pub fn new(receptor: &Knots, ligand: &Knots, sets: &[Residues], weight: f64) -> Self {
        let of = |knots: &Knots, residues: &[Vec<usize>]| -> Vec<Positions> {
            let centers = |residue: &Vec<usize>| {
                let centers = residue.iter().filter_map(|&index| knots.centers.get(index));
                centers.copied().collect()
            };
            residues.iter().map(centers).collect()
        };
        let sets = sets.iter();
        Self {
            sets: sets
                .map(|[own, other]| [of(receptor, own), of(ligand, other)])
                .collect(),
            receptor: Side::new(receptor),
            ligand: Side::new(ligand),
            weight,
        }
    }

    /// The weight times the share of a set's residues that touch the other side in a pose, of the set of which most do.
    pub fn score(&self, pose: &Pose) -> f64 {
        let inverse = pose.inverse();
        let shares = self.sets.iter().map(|[receptor, ligand]| {
            let own = touched(&self.ligand, receptor, &inverse);
            let other = touched(&self.receptor, ligand, pose);
            (own + other) as f64 / (receptor.len() + ligand.len()).max(1) as f64
        });
        self.weight * shares.fold(0.0, f64::max)
    }
}

/// How many of the other side's residues, carried by `pose` into this one's frame, have an atom that touches it.
fn touched(side: &Side, residues: &[Positions], pose: &Pose) -> usize {
    let touches = |atom: &[f64; 3]| side.touches(pose, *atom);
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
        let attraction = Attraction::new(&knots, &knots, &[residues], 300.0);
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

    /// Of copies of a site the one counts that is touched more, and nothing is earned by touching one with some residues and the other with the rest.
    #[test]
    fn one_set_of_several_is_enough() {
        let centers = (1..=4).map(|k| [10.0 * f64::from(k), 0.0, 0.0]).collect();
        let knots = Knots::new(centers, vec![1.9; 4]).unwrap();
        let ligand = Knots::new(vec![[0.0; 3], [10.0, 0.0, 0.0]], vec![1.9; 2]).unwrap();
        let set = |first: usize, second: usize| [vec![vec![first], vec![second]], Vec::new()];
        let sets = [set(0, 1), set(2, 3)];
        let attraction = Attraction::new(&knots, &ligand, &sets, 300.0);
        let at = |x: f64| attraction.score(&Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 3.0, 0.0]));
        assert_eq!(at(10.0), 300.0);
        assert_eq!(at(30.0), 300.0);
        assert_eq!(at(20.0), 150.0);
        assert_eq!(at(40.0), 150.0);
        assert_eq!(at(60.0), 0.0);
    }
}
