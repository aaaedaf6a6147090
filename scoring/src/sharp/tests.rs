//! Energies against the definition, slopes against differences, and the results of descents.

use super::energy::STIFFNESS;
use super::pair_list::PairList;
use super::*;
use crate::rigid_move::Move;
use crate::test_support::Numbers;
use nalgebra::{UnitQuaternion, Vector6};

/// Atoms on a jittered lattice within a ball, a third of them polar and some charged.
fn body(radius: f64, seed: u64, at: [f64; 3]) -> (Knots, Vec<PolarAtom>) {
    let mut numbers = Numbers(seed);
    let (mut centers, mut polar) = (Vec::new(), Vec::new());
    let steps = (radius / 3.0).ceil() as i32;
    for x in -steps..=steps {
        for y in -steps..=steps {
            for z in -steps..=steps {
                let node = Vector3::new(x, y, z).map(|x| 3.0 * f64::from(x));
                let jitter = Vector3::from_fn(|_, _| 0.8 * (numbers.next() - 0.5));
                if node.norm() <= radius {
                    centers.push((node + jitter + Vector3::from(at)).into());
                    polar.push(label(&mut numbers));
                }
            }
        }
    }
    let radii = (0..centers.len()).map(|index| 1.4 + 0.1 * (index % 5) as f64);
    let charges = (0..centers.len()).map(|index| [0.0, 0.5, -0.5][index % 3]);
    let (radii, charges) = (radii.collect(), charges.collect());
    let knots = Knots::new(centers, radii).unwrap();
    (knots.with_labels(charges, Vec::new()).unwrap(), polar)
}

/// A polar atom one time in three, now and then without a direction.
fn label(numbers: &mut Numbers) -> PolarAtom {
    let kind = numbers.next();
    let direction = Vector3::from_fn(|_, _| numbers.next() - 0.5).normalize();
    PolarAtom {
        donates: kind < 0.25,
        accepts: (0.15..0.4).contains(&kind),
        direction: if kind < 0.05 {
            [0.0; 3]
        } else {
            direction.into()
        },
    }
}

/// Two bodies about `at` and their fit.
fn bodies(at: f64) -> (SharpFit, SharpFit) {
    let (receptor, of_receptor) = body(13.0, 1, [at; 3]);
    let (ligand, of_ligand) = body(9.0, 2, [3.0, -2.0, 1.0]);
    (
        SharpFit::new([&receptor, &ligand], [&of_receptor, &of_ligand]),
        SharpFit::new([&ligand, &receptor], [&of_ligand, &of_receptor]),
    )
}

/// Poses about the receptor at `at`, from deep inside to out of reach.
fn poses(at: f64) -> impl Iterator<Item = Pose> {
    (0..50).map(move |step| {
        let angle = 0.7 * f64::from(step);
        let far = 16.0 + 0.3 * f64::from(step);
        let axis = Vector3::new(angle.cos(), angle.sin(), (3.0 * angle).cos()).normalize();
        let turn = [angle.cos(), 0.3, angle.sin(), 0.2];
        Pose::from_parts(turn, (far * axis).add_scalar(at).into())
    })
}

/// Two atoms at a distance, by the formula.
#[test]
fn a_pair_has_the_energy_of_the_definition() {
    let at = |x: f64| Knots::new(vec![[x, 0.0, 0.0]], vec![1.8]).unwrap();
    let toward = |x: f64| PolarAtom {
        donates: true,
        accepts: true,
        direction: [x, 0.0, 0.0],
    };
    let energy = |polar: [&[PolarAtom]; 2], d: f64| {
        let fit = SharpFit::new([&at(0.0), &at(0.0)], polar);
        fit.energy(&Pose::from_parts([1.0, 0.0, 0.0, 0.0], [d, 0.0, 0.0]))
            .total()
    };
    // Contact at 3.5 Å: 0.5 Å beyond, in contact, 0.5 Å too near.
    assert!((energy([&[], &[]], 4.0) + 0.25 * (1.0f64 - 0.0625).powi(2)).abs() < 1e-12);
    assert!((energy([&[], &[]], 3.5) + 0.25).abs() < 1e-12);
    assert!((energy([&[], &[]], 3.0) - (6.0 * 0.25 - 0.25)).abs() < 1e-12);
    assert_eq!(energy([&[], &[]], 5.6), 0.0);
    // Facing each other they bond and may come as near as 2.7 Å; at a right angle they do not bond.
    let (facing, away) = ([toward(1.0)], [toward(-1.0)]);
    assert!((energy([&facing, &away], 2.8) + 1.5 + 0.25 * well_at(0.1)).abs() < 1e-12);
    let aside = [PolarAtom {
        direction: [0.0, 1.0, 0.0],
        ..toward(0.0)
    }];
    assert!((energy([&facing, &aside], 2.8) + 0.25 * well_at(0.1)).abs() < 1e-12);
    assert_eq!(
        energy([&facing, &facing], 2.8),
        energy([&facing, &aside], 2.8)
    );
}

fn well_at(beyond: f64) -> f64 {
    (1.0 - (beyond / 2.0f64).powi(2)).powi(2)
}

/// Lists and lanes in f32 add up to the double sum in f64, before any move and after moves with and without a new list.
#[test]
fn pairs_of_a_list_add_up_to_the_double_sum() {
    let (fit, _) = bodies(0.0);
    let mut list = PairList::default();
    let mut touching = 0;
    for pose in poses(0.0) {
        if !list.begin(&fit, &pose) {
            assert_eq!(fit.energy(&pose).overlap, 0.0);
            continue;
        }
        let mut at = Move::default();
        for step in 0..6 {
            list.renew(&fit, &at);
            let in_list = list.slope(&fit, STIFFNESS, &at).energy;
            let exact = fit.energy(&fit.moved(&pose, &at, &list));
            for (a, b) in [
                (in_list.contacts, exact.contacts),
                (in_list.overlap, exact.overlap),
                (in_list.bonds, exact.bonds),
            ] {
                assert!((a - b).abs() < 1e-4 * b.abs().max(1.0), "{a} {b} at {step}");
            }
            at = at.then(&Vector6::new(0.5, -0.3, 0.2, 0.05, -0.04, 0.02));
            touching += usize::from(exact.contacts > 0.0);
        }
    }
    assert!(touching > 100, "{touching}");
}

/// The slope is the gradient of the energy by a further step, after some move as before any. Differences are of the
/// double sum in f64.
#[test]
fn slopes_are_those_of_the_energy() {
    let (fit, _) = bodies(0.0);
    let mut list = PairList::default();
    let mut seen = 0;
    for pose in poses(0.0).skip(4).step_by(3).take(8) {
        assert!(list.begin(&fit, &pose));
        let at = Move::default().then(&Vector6::new(0.3, -0.2, 0.1, 0.02, 0.05, -0.03));
        list.renew(&fit, &at);
        let slope = list.slope(&fit, STIFFNESS, &at);
        let energy =
            |step: &Vector6<f64>| fit.energy(&fit.moved(&pose, &at.then(step), &list)).total();
        for row in 0..6 {
            let mut step = Vector6::zeros();
            step[row] = 1e-5;
            let difference = (energy(&step) - energy(&-step)) / 2e-5;
            let size = slope.by_step.gradient.norm();
            assert!(
                (difference - slope.by_step.gradient[row]).abs() <= 1e-3 * size,
                "{row}"
            );
        }
        seen += usize::from(slope.energy.bonds > 0.0);
        assert!(
            (slope.by_step.curvature - slope.by_step.curvature.transpose()).norm()
                <= 1e-6 * slope.by_step.curvature.norm()
        );
        let least = slope.by_step.curvature.symmetric_eigenvalues().min();
        assert!(least >= -1e-6 * slope.by_step.curvature.norm());
    }
    assert!(seen > 3, "{seen}");
}

/// Receptor and ligand may be exchanged, and coordinates of 1e6 Å cost only their own digits.
#[test]
fn neither_exchange_nor_offsets_matter() {
    let offset = f64::from(1 << 20);
    let ((fit, exchanged), (far, _)) = (bodies(0.0), bodies(offset));
    for (pose, there) in poses(0.0).zip(poses(offset)) {
        let energy = fit.energy(&pose);
        let other = exchanged.energy(&pose.inverse());
        let moved = far.energy(&there);
        for other in [other, moved] {
            let difference = (other.total() - energy.total()).abs();
            assert!(difference < 1e-5 * energy.total().abs().max(1.0));
        }
    }
}

/// Most descents end where no small move gains; further starts only gain. What is out of reach has no optimum.
#[test]
fn descents_end_in_optima() {
    let (fit, _) = bodies(0.0);
    let mut list = PairList::default();
    let far = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [90.0, 0.0, 0.0]);
    assert_eq!(fit.descend(&far, &mut list), None);
    assert_eq!(fit.best_near(&far, &mut list), None);
    let mut at_rest = 0;
    let mut optima = 0;
    for pose in poses(0.0) {
        let Some(found) = fit.descend(&pose, &mut list) else {
            continue;
        };
        optima += 1;
        assert_eq!(found.energy, fit.energy(&found.pose));
        assert_eq!(Some(found), fit.descend(&pose, &mut PairList::default()));
        let nearby = (0..12).map(|which| {
            let mut shift = Vector3::zeros();
            shift[which % 3] = if which % 2 == 0 { 0.05 } else { -0.05 };
            let turn = UnitQuaternion::new(if which < 6 {
                Vector3::zeros()
            } else {
                0.1 * shift
            });
            let shift = if which < 6 { shift } else { Vector3::zeros() };
            let about = found.pose.translation;
            Pose {
                rotation: turn * found.pose.rotation,
                translation: about + shift,
            }
        });
        let least = nearby.map(|pose| fit.energy(&pose).total());
        at_rest += usize::from(least.fold(f64::INFINITY, f64::min) > found.energy.total() - 0.02);
    }
    assert!(
        optima > 20 && at_rest * 10 >= optima * 9,
        "{at_rest} of {optima}"
    );
    let pose = poses(0.0).nth(6).unwrap();
    let (one, many) = (
        fit.descend(&pose, &mut list),
        fit.best_near(&pose, &mut list),
    );
    assert!(many.unwrap().energy.total() <= one.unwrap().energy.total());
}

/// If a ligand is the mould of a receptor, a pose some Å off returns to it.
#[test]
fn a_ligand_returns_to_its_mould() {
    let (receptor, _) = body(13.0, 1, [0.0; 3]);
    // The ligand: lattice points of a neighbouring ball that lie within contact of no receptor atom.
    let (ligand, _) = body(10.0, 7, [15.0, 0.0, 0.0]);
    let mut centers = ligand.centers.clone();
    centers.retain(|x| {
        let gap = |y: &[f64; 3]| (Vector3::from(*x) - Vector3::from(*y)).norm() - 3.3;
        receptor
            .centers
            .iter()
            .map(gap)
            .fold(f64::INFINITY, f64::min)
            > 0.0
    });
    let radii = vec![1.7; centers.len()];
    let receptor = Knots::new(receptor.centers.clone(), vec![1.7; receptor.centers.len()]).unwrap();
    let ligand = Knots::new(centers, radii).unwrap();
    let fit = SharpFit::new([&receptor, &ligand], [&[], &[]]);
    let mut list = PairList::default();
    let home = fit.descend(&Pose::identity(), &mut list).unwrap();
    let middle = Vector3::new(12.0, 0.0, 0.0);
    let mut back = 0;
    for step in 0..8 {
        let angle = f64::from(step);
        let shift = 0.8 * Vector3::new(angle.cos(), angle.sin(), (2.0 * angle).sin());
        let turn = UnitQuaternion::new(0.05 * Vector3::new(angle.sin(), 1.0, angle.cos()));
        let off = Pose {
            rotation: turn,
            translation: middle - turn * middle + shift,
        };
        let found = fit.best_near(&off, &mut list).unwrap();
        back += usize::from(found.energy.total() < home.energy.total() + 0.5);
    }
    assert!(back >= 6, "{back} of 8");
}
