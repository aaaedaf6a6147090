//! A restraint as balls of translations.

use knotdock_scoring::terms::pose::DistanceRestraint;
use knotdock_structures::Knots;
use nalgebra::Vector3;

/// Largest distance in Å of an atom from the middle of its clump.
const CLUMP: f64 = 4.0;
/// Most balls of a restraint; with more of them clumps grow.
const MAX_BALLS: usize = 2000;
/// Pairs of atoms that may bring an effective distance below the shortest.
const PAIRS: usize = 64;

/// Translations at which a restraint may hold.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    /// Middle of a clump of the receptor's atoms relative to its centre, Å.
    pub receptor: Vector3<f64>,
    /// Middle of a clump of the ligand's atoms relative to its centre, Å.
    pub ligand: Vector3<f64>,
    /// Largest distance of the two, Å.
    pub radius: f64,
}

/// Atoms near each other: their middle, and their largest distance from it (Å).
type Clump = (Vector3<f64>, f64);

/// The balls of a restraint. Samples leave `between` Å between translations and `step` radians between rotations.
pub(super) fn of_restraint(
    restraint: &DistanceRestraint,
    knots: [&Knots; 2],
    centers: [Vector3<f64>; 2],
    (between, step): (f64, f64),
) -> Vec<Ball> {
    let count: usize = restraint.pairs.iter().map(|[a, b]| a.len() * b.len()).sum();
    let upper = restraint.upper * (count.min(PAIRS) as f64).powf(1.0 / 6.0);
    let mut widest = CLUMP;
    loop {
        let mut balls = Vec::new();
        for sides in &restraint.pairs {
            let [receptor, ligand] = [0, 1].map(|side| {
                let atoms = sides[side].iter();
                let atoms = atoms.filter_map(|&atom| knots[side].centers.get(atom));
                clumps(atoms.map(|x| Vector3::from(*x) - centers[side]), widest)
            });
            for (receptor, wide) in receptor {
                balls.extend(ligand.iter().map(|(ligand, other)| Ball {
                    receptor,
                    ligand: *ligand,
                    radius: upper + wide + other + between + 0.5 * step * ligand.norm(),
                }));
            }
        }
        if balls.len() <= MAX_BALLS.max(restraint.pairs.len()) {
            return balls;
        }
        widest *= 1.5;
    }
}

/// Splits points into clumps: each joins the first clump whose first point is near, in the order given.
fn clumps(points: impl Iterator<Item = Vector3<f64>>, widest: f64) -> Vec<Clump> {
    let mut members: Vec<Vec<Vector3<f64>>> = Vec::new();
    for point in points {
        let near = |clump: &&mut Vec<Vector3<f64>>| (clump[0] - point).norm() <= widest;
        match members.iter_mut().find(near) {
            Some(clump) => clump.push(point),
            None => members.push(vec![point]),
        }
    }
    let clump = |points: Vec<Vector3<f64>>| {
        let middle = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
        let distances = points.iter().map(|point| (point - middle).norm());
        (middle, distances.fold(0.0, f64::max))
    };
    members.into_iter().map(clump).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clumps hold every point, and a single one has no radius.
    #[test]
    fn clumps_hold_all_points() {
        let points: Vec<Vector3<f64>> = (0..40)
            .map(|i| Vector3::new((1.3 * i as f64).sin(), 0.1 * i as f64, 1.0) * 9.0)
            .collect();
        let clumps = clumps(points.iter().copied(), 4.0);
        assert!(clumps.len() > 3 && clumps.len() < 40);
        for point in points {
            let holds = |(middle, wide): &Clump| (middle - point).norm() <= wide + 1e-9;
            assert!(clumps.iter().any(holds));
        }
        let one = super::clumps(std::iter::once(Vector3::new(1.0, 2.0, 3.0)), 4.0);
        assert_eq!(one, [(Vector3::new(1.0, 2.0, 3.0), 0.0)]);
    }

    /// A pair of atoms has one ball: the bound, and the allowance for the steps between samples at the ligand's atom.
    #[test]
    fn a_pair_has_the_ball_of_its_bound() {
        let one = |x: [f64; 3]| Knots::new(vec![x], vec![1.7]).unwrap();
        let (receptor, ligand) = (one([1.0, 2.0, 3.0]), one([3.0, 4.0, 0.0]));
        let restraint = DistanceRestraint {
            pairs: vec![[vec![0], vec![0]]],
            lower: 0.0,
            upper: 7.0,
        };
        let none = Vector3::zeros();
        let balls = of_restraint(&restraint, [&receptor, &ligand], [none, none], (1.5, 0.2));
        assert_eq!(balls.len(), 1);
        assert_eq!(balls[0].receptor, Vector3::new(1.0, 2.0, 3.0));
        // Half of 0.2 radians at 5 Å.
        assert!((balls[0].radius - 9.0).abs() < 1e-12);
    }

    /// Large sets make larger clumps instead of more balls.
    #[test]
    fn balls_are_bounded_in_number() {
        let side = |at: f64| {
            let atoms = (0..400).map(|i| [at + 5.0 * (i % 20) as f64, 5.0 * (i / 20) as f64, 0.0]);
            Knots::new(atoms.collect(), vec![1.7; 400]).unwrap()
        };
        let (receptor, ligand) = (side(0.0), side(3.0));
        let all: Vec<usize> = (0..400).collect();
        let restraint = DistanceRestraint {
            pairs: vec![[all.clone(), all]],
            lower: 0.0,
            upper: 2.0,
        };
        let none = Vector3::zeros();
        let balls = of_restraint(&restraint, [&receptor, &ligand], [none, none], (1.0, 0.1));
        assert!(!balls.is_empty() && balls.len() <= MAX_BALLS);
        // 2 Å times 64^(1/6) = 2, and half of a voxel's diagonal.
        assert!(balls.iter().all(|ball| ball.radius >= 5.0));
    }
}
