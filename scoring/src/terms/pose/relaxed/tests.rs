//! Energies against the definition, slopes against differences, and where descents end, with and without noise.

use super::*;
use crate::terms::pose::atom_pair;
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
    let pairs = atom_pair::term([a, b], &AtomPairPotential::default(), 1.0);
    sum - pairs(pose, &mut Workspace::default())
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

/// Energy of the descent at a move.
fn soft_energy(relaxation: &Relaxation, workspace: &mut Workspace, at: &Move) -> f64 {
    let energy = |ligand: &Site, eight: &Eight| relaxation.soft(ligand, eight).energy;
    relaxation.sum(workspace, at, energy)
}

/// The ligand atoms near the interface of a pose, with the interface.
fn collected(relaxation: &Relaxation, pose: &Pose) -> Option<(Workspace, Interface)> {
    let mut workspace = Workspace::default();
    let start = relaxation.atoms.start(pose);
    let interface = relaxation.atoms.interface(&start, &mut workspace)?;
    let none = Move::default();
    relaxation
        .atoms
        .collect(&start, &interface.middle, &none, &mut workspace);
    Some((workspace, interface))
}

/// The slope is the gradient of the energy of the descent by a further step, after some move as before any.
#[test]
fn the_slope_is_that_of_the_energy() {
    let (_, _, relaxation) = bodies(0.0);
    let (mut workspace, _) = collected(&relaxation, &poses(0.0).nth(9).unwrap()).unwrap();
    let (shift, turn) = (
        Vector3::new(0.3, -0.2, 0.1),
        Vector3::new(0.02, 0.05, -0.03),
    );
    for at in [Move::default(), Move::default().then_by_halves(shift, turn)] {
        let slope = relaxation.slope(&mut workspace, &at);
        let mut energy =
            |shift, turn| soft_energy(&relaxation, &mut workspace, &at.then_by_halves(shift, turn));
        let none = Vector3::zeros();
        let sizes = [0, 3].map(|row| slope.by_step.gradient.fixed_rows::<3>(row).norm());
        assert!(sizes.iter().all(|size| *size > 1.0), "{sizes:?}");
        for axis in 0..3 {
            let step = 1e-6 * Vector3::ith(axis, 1.0);
            let shifted = energy(step, none) - energy(-step, none);
            let turned = energy(none, step) - energy(none, -step);
            assert!((shifted / 2e-6 - slope.by_step.gradient[axis]).abs() < 1e-5 * sizes[0]);
            assert!((turned / 2e-6 - slope.by_step.gradient[axis + 3]).abs() < 1e-5 * sizes[1]);
        }
        // Symmetric, and no direction curves downward.
        assert!((slope.by_step.curvature - slope.by_step.curvature.transpose()).norm() < 1e-9);
        let least = slope.by_step.curvature.symmetric_eigenvalues().min();
        assert!(least > -1e-9 * slope.by_step.curvature.norm(), "{least}");
    }
}

/// A list contains every pair within reach before any move, and after one that is far enough for a new list.
#[test]
fn collected_pairs_add_up_to_the_energy() {
    let (_, _, relaxation) = bodies(0.0);
    let mut touching = 0;
    for pose in poses(0.0) {
        let energy = relaxation.energy(&pose);
        let Some((mut workspace, Interface { middle, .. })) = collected(&relaxation, &pose) else {
            assert_eq!(energy, 0.0);
            continue;
        };
        let mut was = Move::default();
        let start = relaxation.atoms.start(&pose);
        let steps = [0.0, 0.1, 0.3, 1.2].map(|by| Vector3::new(by, 0.4 * by, -by));
        let mut at = was;
        for step in steps {
            at = at.then_by_halves(step, 0.1 * step);
            relaxation
                .atoms
                .renew(&mut was, &at, &start, &mut workspace);
            let energy = relaxation.energy(&relaxation.atoms.moved(&pose, &at, &middle));
            let collected = relaxation.collected_energy(&mut workspace, &at);
            assert!((collected - energy).abs() < 1e-9 * energy.abs().max(1.0));
        }
        assert!(was.shift.norm() > 0.0, "no new list");
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
            assert!(moved.norm() < 3.0 * MAX_STEPS.iter().sum::<f64>());
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
        let close = |other: f64| (other - score).abs() < 1e-5 * score.abs().max(1.0);
        assert!(close(far.score(&there, &mut workspace)));
        assert!(close(clothed.score(&here, &mut workspace)));
    }
}

/// Two atoms without a kind part along the line between them, by steps known in closed form.
///
/// At a distance d and a sum of radii s, less 0.1 Å, the slope is `-k d (1 - d²/s²)`. It is divided by the curvature
/// `2 k d²/s²` (less of it for an overlap below 0.5 Å) and the damping, which is 2 and 0.05 of the contact's weight.
#[test]
fn an_overlap_gives_way() {
    let ball = |x: f64| Knots::new(vec![[x, 0.0, 0.0]], vec![1.8]).unwrap();
    let pair = Relaxation::new(&ball(0.0), &ball(0.0), &AtomPairPotential::default(), 2.0);
    let pose = |x: f64| Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
    assert!((pair.energy(&pose(2.5)) - 0.8).abs() < 1e-12);
    assert_eq!(pair.energy(&pose(3.5)), 0.0);
    for start in [1.0, 2.5, 3.2, 3.6] {
        let mut d: f64 = start;
        for longest in MAX_STEPS {
            let lack = (1.0 - d * d / 12.25).max(0.0);
            let part = (1.75 * lack / 0.5).min(1.0);
            let weight = (1.0 - d * d / (6.5 * 6.5)).powi(2);
            let step = 0.2 * lack * d / (0.4 * part * d * d / 12.25 + 0.05 * weight + 2.0);
            d += step / (1.0 + (step / longest).powi(2)).sqrt();
        }
        let expected = 0.8 * (3.5 - d).max(0.0).powi(2);
        let relaxed = pair.relax(&pose(start), &mut Workspace::default());
        assert!((relaxed.energy - expected).abs() < 1e-12, "{relaxed:?}");
        assert!((relaxed.pose.translation.x - d).abs() < 1e-12);
        assert_eq!(relaxed.energy < pair.energy(&pose(start)), start < 3.5);
    }
}

/// Steepest descent with trials that were accepted or refused made the score chaotic: noise of 1e-6 Å on the atoms
/// moved it by up to 6, and exchange of the bodies by 2%. The score changes in proportion to the noise, of atoms as of
/// poses, in contact as in a deep overlap.
#[test]
fn scores_change_in_proportion_to_noise() {
    let (receptor, ligand, relaxation) = bodies(0.0);
    let mut workspace = Workspace::default();
    let mut numbers = Numbers(5);
    let mut noise = |size: f64| Vector3::from_fn(|_, _| 2.0 * size * (numbers.next() - 0.5));
    for size in [1e-3, 1e-6] {
        let mut shaken = |knots: &Knots| {
            let mut knots = knots.clone();
            for x in &mut knots.centers {
                *x = (Vector3::from(*x) + noise(size)).into();
            }
            knots
        };
        let (receptor, ligand) = (shaken(&receptor), shaken(&ligand));
        let other = Relaxation::new(&receptor, &ligand, &AtomPairPotential::default(), 3.0);
        let mut worst: f64 = 0.0;
        for pose in poses(0.0) {
            let score = relaxation.score(&pose, &mut workspace);
            let turn = nalgebra::UnitQuaternion::new(0.1 * noise(size));
            let moved = Pose {
                rotation: turn * pose.rotation,
                translation: pose.translation + noise(size),
            };
            for other in [
                other.score(&pose, &mut workspace),
                relaxation.score(&moved, &mut workspace),
            ] {
                worst = worst.max((other - score).abs() / size);
            }
        }
        // Score per Å: three times what these bodies show.
        assert!(worst < 1e3, "{worst} at {size}");
    }
}

/// Receptor and ligand may be exchanged.
#[test]
fn exchanged_bodies_have_the_same_score() {
    let (receptor, ligand, relaxation) = bodies(0.0);
    let exchanged = Relaxation::new(&ligand, &receptor, &AtomPairPotential::default(), 3.0);
    let mut workspace = Workspace::default();
    let mut touching = 0;
    for pose in poses(0.0) {
        let score = relaxation.score(&pose, &mut workspace);
        let other = exchanged.score(&pose.inverse(), &mut workspace);
        assert!(
            (other - score).abs() < 1e-9 * score.abs().max(1.0),
            "{other} {score}"
        );
        touching += usize::from(score != 0.0);
    }
    assert!(touching > 30, "{touching}");
}
