//! Energies against the definition, slopes against differences, and the ends of descents.

use super::descent::FARTHEST;
use super::*;
use crate::terms::pose::AtomPairs;
use crate::test_support::Numbers;

/// Atoms of all kinds on a jittered lattice within a ball, at least 2.4 Å from each other.
fn body(radius: f64, seed: u64, at: [f64; 3]) -> Knots {
    let mut numbers = Numbers(seed);
    let mut centers = Vec::new();
    let steps = (radius / 3.2).ceil() as i32;
    for x in -steps..=steps {
        for y in -steps..=steps {
            for z in -steps..=steps {
                let node = Vector3::new(x, y, z).map(|x| 3.2 * f64::from(x));
                let jitter = Vector3::from_fn(|_, _| 0.8 * (numbers.next() - 0.5));
                if node.norm() <= radius {
                    centers.push((node + jitter + Vector3::from(at)).into());
                }
            }
        }
    }
    let count = centers.len();
    let radii = (0..count).map(|index| 1.4 + 0.1 * (index % 5) as f64);
    let kinds = (0..count).map(|_| (numbers.next() < 0.9).then(|| (158.0 * numbers.next()) as u8));
    let (radii, kinds) = (radii.collect(), kinds.collect());
    let knots = Knots::new(centers, radii).unwrap();
    knots.with_atom_kinds(kinds).unwrap()
}

fn bodies(at: f64) -> (Knots, Knots, Relaxation) {
    let (receptor, ligand) = (body(14.0, 1, [at; 3]), body(9.0, 2, [3.0, -2.0, 1.0]));
    let relaxation = Relaxation::new(&receptor, &ligand, &AtomPairPotential::default(), 3.0);
    (receptor, ligand, relaxation)
}

/// Poses about the receptor at `at`, some deep inside and some out of reach.
fn poses(at: f64) -> impl Iterator<Item = Pose> {
    (0..60).map(move |step| {
        let angle = 0.7 * f64::from(step);
        let far = 16.0 + 0.15 * f64::from(step);
        let turn = [angle.cos(), 0.3, angle.sin(), 0.2];
        let axis = Vector3::new(angle.cos(), angle.sin(), (3.0 * angle).cos()).normalize();
        Pose::from_parts(turn, (far * axis).add_scalar(at).into())
    })
}

/// The definition, pair by pair.
fn direct(a: &Knots, b: &Knots, pose: &Pose) -> f64 {
    let mut sum = 0.0;
    for (x, r) in a.centers.iter().zip(&a.radii) {
        for (y, s) in b.centers.iter().zip(&b.radii) {
            let distance = (Vector3::from(pose.apply(*y)) - Vector3::from(*x)).norm();
            sum += 0.8 * (r + s - 0.1 - distance).max(0.0).powi(2);
        }
    }
    let pairs = AtomPairs::new(a, b, &AtomPairPotential::default(), 1.0);
    sum - pairs.score(pose)
}

#[test]
fn the_energy_is_that_of_atom_pairs_and_overlaps() {
    let (receptor, ligand, relaxation) = bodies(0.0);
    let mut touching = 0;
    for pose in poses(0.0) {
        let (energy, expected) = (relaxation.energy(&pose), direct(&receptor, &ligand, &pose));
        assert!((energy - expected).abs() < 1e-9 * expected.abs().max(1.0));
        touching += usize::from(expected != 0.0);
    }
    assert!(touching > 30, "{touching}");
}

/// The slope is the gradient of the energy, by shift and by rotation.
#[test]
fn the_slope_is_that_of_the_energy() {
    let (_, _, relaxation) = bodies(0.0);
    let mut workspace = Workspace::default();
    let pose = poses(0.0).nth(9).unwrap();
    let (middle, _) = relaxation.list(&pose, &mut workspace).unwrap();
    let at = |turn: Vector3<f64>, shift: Vector3<f64>| {
        relaxation.slope(
            &workspace,
            &Rotation3::new(turn),
            &(middle + shift),
            SOFT_CORE_STIFFNESS,
        )
    };
    let none = Vector3::zeros();
    let slope = at(none, none);
    assert!(slope.force.norm() > 1.0 && slope.torque.norm() > 1.0);
    for axis in 0..3 {
        let step = 1e-6 * Vector3::ith(axis, 1.0);
        let shifted = at(none, step).energy - at(none, -step).energy;
        let turned = at(step, none).energy - at(-step, none).energy;
        assert!((shifted / 2e-6 - slope.force[axis]).abs() < 1e-3 * slope.force.norm());
        assert!((turned / 2e-6 - slope.torque[axis]).abs() < 1e-3 * slope.torque.norm());
    }
}

/// Before any move the list contains every pair within reach.
#[test]
fn pairs_within_reach_add_up_to_the_energy() {
    let (_, _, relaxation) = bodies(0.0);
    let mut workspace = Workspace::default();
    let mut touching = 0;
    for pose in poses(0.0) {
        let energy = relaxation.energy(&pose);
        let Some((middle, _)) = relaxation.list(&pose, &mut workspace) else {
            assert_eq!(energy, 0.0);
            continue;
        };
        let slope = relaxation.slope(&workspace, &Rotation3::identity(), &middle, STIFFNESS);
        assert!((slope.energy - energy).abs() < 1e-9 * energy.abs().max(1.0));
        touching += 1;
    }
    assert!(touching > 30, "{touching}");
}

/// A relaxed pose has the returned energy, which is never more than before, and its interface lies within the bounds.
/// Most poses gain.
#[test]
fn poses_come_to_rest_nearby_and_lower() {
    let (_, ligand, relaxation) = bodies(0.0);
    let mut workspace = Workspace::default();
    let mut gained = 0;
    for pose in poses(0.0) {
        let before = relaxation.energy(&pose);
        let relaxed = relaxation.relax(&pose, &mut workspace);
        let at_rest = relaxation.energy(&relaxed.pose);
        assert!((relaxed.energy - at_rest).abs() < 1e-9 * at_rest.abs().max(1.0));
        assert!(relaxed.energy <= before + 1e-9 * before.abs());
        let score = relaxation.score(&pose, &mut workspace);
        assert_eq!(score, -3.0 * relaxed.energy);
        gained += usize::from(relaxed.energy < before - 1.0);
        // No atom of this small a ligand is so far out that the arc bound lets it go twice as far.
        for &y in &ligand.centers {
            let moved = Vector3::from(relaxed.pose.apply(y)) - Vector3::from(pose.apply(y));
            assert!(moved.norm() < 3.0 * FARTHEST);
        }
    }
    assert!(gained > 30, "{gained}");
}

/// Out of reach the energy is 0 and the pose stays.
#[test]
fn what_does_not_touch_stays() {
    let (_, _, relaxation) = bodies(0.0);
    let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [80.0, 0.0, 0.0]);
    let relaxed = relaxation.relax(&pose, &mut Workspace::default());
    assert_eq!(relaxed, Relaxed { pose, energy: 0.0 });
}

/// Coordinates of 1e6 Å cost only their own digits, a workspace carries nothing over, and hydrogens do not count.
#[test]
fn neither_offsets_nor_earlier_poses_nor_hydrogens_matter() {
    let at = f64::from(1 << 20);
    let ((receptor, ligand, near), (_, _, far)) = (bodies(0.0), bodies(at));
    let with_hydrogens = |knots: &Knots| {
        let mut centers = knots.centers.clone();
        let mut radii = knots.radii.clone();
        let mut kinds = knots.atom_kinds.clone();
        let hydrogens = knots.centers.iter().map(|x| [x[0] + 1.0, x[1], x[2]]);
        centers.extend(hydrogens);
        radii.resize(centers.len(), 1.1);
        kinds.resize(centers.len(), None);
        let knots = Knots::new(centers, radii).unwrap();
        knots.with_atom_kinds(kinds).unwrap()
    };
    let clothed = Relaxation::new(
        &with_hydrogens(&receptor),
        &with_hydrogens(&ligand),
        &AtomPairPotential::default(),
        3.0,
    );
    let mut workspace = Workspace::default();
    for (here, there) in poses(0.0).zip(poses(at)) {
        let score = near.score(&here, &mut workspace);
        assert_eq!(score, near.score(&here, &mut Workspace::default()));
        let close = |other: f64| (other - score).abs() < 1e-3 * score.abs().max(1.0);
        assert!(close(far.score(&there, &mut workspace)));
        assert!(close(clothed.score(&here, &mut workspace)));
    }
}

/// Two atoms without a kind that overlap slightly move until they are in contact.
#[test]
fn an_overlap_gives_way() {
    let ball = |x: f64| Knots::new(vec![[x, 0.0, 0.0]], vec![1.8]).unwrap();
    let pair = Relaxation::new(&ball(0.0), &ball(0.0), &AtomPairPotential::default(), 2.0);
    let pose = |x: f64| Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
    assert!((pair.energy(&pose(2.5)) - 0.8).abs() < 1e-12);
    assert_eq!(pair.energy(&pose(3.5)), 0.0);
    let relaxed = pair.relax(&pose(2.5), &mut Workspace::default());
    assert!(relaxed.energy < 1e-3, "{relaxed:?}");
    // The last step may go past contact, where no force acts.
    assert!((3.45..4.1).contains(&relaxed.pose.translation.x));
    // A deeper overlap is not resolved within 2 Å.
    let relaxed = pair.relax(&pose(1.0), &mut Workspace::default());
    assert!((relaxed.pose.translation.x - 3.0).abs() < 0.05);
}
