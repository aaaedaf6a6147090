//! Pair sums against closed forms, quadrature, finite differences and the laws of motion.

use super::quadrature::Quadrature;
use super::*;
use crate::kernel::product::lens_volume;
use crate::se3::Pose;
use crate::test_support::Numbers;
use cpu_time::ThreadTime;
use knotdock_structures::numeric::Bump;
use nalgebra::{UnitQuaternion, Vector3};
use std::sync::LazyLock;

static DEFAULT: LazyLock<PairOverlap> = LazyLock::new(|| PairOverlap::new(2.0).unwrap());

fn random_rotation(numbers: &mut Numbers) -> UnitQuaternion<f64> {
    let parts = std::array::from_fn(|_| numbers.next() - 0.5);
    Pose::from_parts(parts, [0.0; 3]).rotation
}

fn random_balls(count: usize, size: f64, numbers: &mut Numbers) -> Vec<WeightedBall> {
    (0..count)
        .map(|_| WeightedBall {
            center: std::array::from_fn(|_| size * (numbers.next() - 0.5)),
            radius: 0.02 * size * 50f64.powf(numbers.next()),
            weight: 0.2 + numbers.next(),
        })
        .collect()
}

/// Ratios from 1 to 1e6, distances over the whole reach: values to 1e-8 of that at d = 0, and slopes.
#[test]
fn the_table_follows_the_quadrature() {
    let quadrature = Quadrature::new(Bump::new(2.0).unwrap());
    let mut numbers = Numbers(1);
    let (mut worst, mut worst_slope) = (0.0f64, 0.0f64);
    for i in 0..3000 {
        let ratio = if i % 3 == 0 {
            numbers.next()
        } else {
            1e-6f64.powf(numbers.next())
        };
        let d = numbers.next() * (1.0 + ratio);
        let [value, by_square] = quadrature.value_and_slope(ratio, d);
        let scale = quadrature.value(ratio, 0.0);
        // In another unit, with the balls exchanged.
        let (ours, slope) = DEFAULT.value_and_slope(3.0, 3.0 * ratio, 3.0 * d);
        let unit = (3.0 * ratio).powi(3);
        worst = worst.max((ours / unit - value).abs() / scale);
        worst_slope = worst_slope.max((3.0 * slope / unit - 2.0 * d * by_square).abs() / scale);
    }
    println!(
        "table: stated {:.1e}, value {worst:.1e}, slope {worst_slope:.1e}",
        DEFAULT.error()
    );
    assert!(worst <= 2.0 * DEFAULT.error() && worst <= 1e-8);
    assert!(worst_slope <= 2e-5);
}

#[test]
fn values_fall_to_zero_at_the_reach() {
    for (r, s) in [(1.0, 1.0), (1.0, 7.0), (1e-6, 1.0)] {
        let peak = DEFAULT.value_and_slope(r, s, 0.0).0;
        let mut last = f64::INFINITY;
        for i in 0..=4000 {
            let (value, slope) = DEFAULT.value_and_slope(r, s, (r + s) * f64::from(i) / 4000.0);
            assert!(value >= 0.0 && slope <= 0.0);
            assert!(value <= last + 2e-8 * peak);
            last = value;
        }
        assert_eq!(DEFAULT.value_and_slope(r, s, r + s), (0.0, 0.0));
        assert_eq!(DEFAULT.value_and_slope(r, s, 0.0).1, 0.0);
    }
}

/// Grazing balls: the energy underflows, geometry reports the hit.
#[test]
fn grazing_contact_is_geometry() {
    for alpha in [2.0, 4.0] {
        let kernel = PairOverlap::new(alpha).unwrap();
        let a = WeightedBall {
            center: [0.0; 3],
            radius: 1.0,
            weight: 1.0,
        };
        let b = WeightedBall {
            center: [3.0 - 1e-9, 0.0, 0.0],
            radius: 2.0,
            weight: 1.0,
        };
        let mut sum = Accumulator::new(&kernel, [0.0; 3]);
        assert!(sum.add(&a, &b));
        assert_eq!(sum.sum().energy, 0.0);
        assert_eq!(sum.sum().pairs, 1);
        let away = WeightedBall {
            center: [3.0, 0.0, 0.0],
            ..b
        };
        assert!(!sum.add(&a, &away));
    }
}

#[test]
fn sharp_balls_share_their_lens() {
    let kernel = PairOverlap::new(f64::INFINITY).unwrap();
    for (r, s, d) in [
        (1.0, 1.0, 1.0),
        (1.0, 2.0, 0.5),
        (1.0, 2.0, 2.2),
        (1e-6, 1.0, 1.0),
    ] {
        assert_eq!(kernel.value_and_slope(r, s, d).0, lens_volume(r, s, d));
    }
    // Steep bumps tend to it.
    let steep = PairOverlap::new(100.0).unwrap();
    for d in [0.0, 0.3, 1.2, 2.0] {
        let (ours, exact) = (
            steep.value_and_slope(1.0, 1.5, d).0,
            lens_volume(1.0, 1.5, d),
        );
        assert!((ours - exact).abs() < 0.05 * lens_volume(1.0, 1.5, 0.0));
    }
}

/// Concentric equal balls: 4 pi times the integral of u^2 psi(u)^2. A tiny ball in a huge one: V r^3 psi(d / s).
#[test]
fn concentric_and_tiny_balls() {
    for alpha in [1.0, 2.0, 4.0] {
        let kernel = PairOverlap::new(alpha).unwrap();
        let bump = Bump::new(alpha).unwrap();
        let steps = 20_000;
        let midpoint = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
        let square: f64 = (0..steps)
            .map(midpoint)
            .map(|u| (u * bump.value(u)).powi(2))
            .sum();
        let exact = 4.0 * std::f64::consts::PI * square / f64::from(steps);
        let ours = kernel.value_and_slope(2.0, 2.0, 0.0).0 / 8.0;
        assert!(
            (ours / exact - 1.0).abs() < 2.0 * kernel.error().max(1e-8),
            "{alpha}"
        );
        let d = 0.4;
        let ours = kernel.value_and_slope(1e-6, 1.0, d).0 / 1e-18;
        let exact = bump.volume() * bump.value(d);
        assert!((ours / exact - 1.0).abs() < 1e-6, "{alpha}: {ours} {exact}");
    }
}

fn at(
    kernel: &PairOverlap,
    a: &[WeightedBall],
    b: &[WeightedBall],
    pose: &Pose,
    c: Vector3<f64>,
) -> Overlap {
    overlap_of_all(
        kernel,
        a,
        b,
        pose,
        (pose.rotation * c + pose.translation).into(),
    )
}

#[test]
fn force_and_torque_are_minus_the_slopes() {
    for alpha in [2.0, 4.0, f64::INFINITY] {
        let kernel = PairOverlap::new(alpha).unwrap();
        let mut numbers = Numbers(7);
        let a = random_balls(14, 4.0, &mut numbers);
        let b = random_balls(9, 3.0, &mut numbers);
        let center = Vector3::new(0.3, -0.2, 0.5);
        for _ in 0..5 {
            let rotation = random_rotation(&mut numbers);
            let place = Vector3::from_fn(|_, _| 2.0 * (numbers.next() - 0.5));
            let pose = Pose::about(rotation, center, place);
            let sum = at(&kernel, &a, &b, &pose, center);
            let h = 1e-5;
            for axis in 0..3 {
                let step = Vector3::ith(axis, h);
                let energy = |pose: &Pose| at(&kernel, &a, &b, pose, center).energy;
                let moved = |sign: f64| energy(&Pose::about(rotation, center, place + sign * step));
                let force = -(moved(1.0) - moved(-1.0)) / (2.0 * h);
                let turned = |sign: f64| {
                    energy(&Pose::about(
                        UnitQuaternion::new(sign * step) * rotation,
                        center,
                        place,
                    ))
                };
                let torque = -(turned(1.0) - turned(-1.0)) / (2.0 * h);
                let scale = sum.energy.abs().max(sum.force.norm());
                assert!(
                    (force - sum.force[axis]).abs() < 1e-5 * scale,
                    "{alpha}: {force}"
                );
                assert!((torque - sum.torque[axis]).abs() < 1e-5 * scale.max(sum.torque.norm()));
            }
        }
    }
}

/// Force on A = -force on B, and the torques about one point balance; turning or moving both bodies turns the vectors.
#[test]
fn action_is_reaction_and_frames_do_not_matter() {
    let mut numbers = Numbers(11);
    let a = random_balls(20, 4.0, &mut numbers);
    let b = random_balls(15, 4.0, &mut numbers);
    let pose = Pose::from_parts([0.8, 0.1, -0.5, 0.2], [0.4, -0.6, 0.9]);
    let about = [0.7, 0.1, -2.0];
    let on_b = overlap_of_all(&DEFAULT, &a, &b, &pose, about);
    // The same pair seen from B.
    let back = pose.inverse();
    let on_a = overlap_of_all(&DEFAULT, &b, &a, &back, back.apply(about));
    let scale = on_b.force.norm() + on_b.torque.norm();
    assert!((on_b.energy / on_a.energy - 1.0).abs() < 1e-12);
    assert!((on_b.force + pose.rotation * on_a.force).norm() < 1e-12 * scale);
    assert!((on_b.torque + pose.rotation * on_a.torque).norm() < 1e-12 * scale);
    assert_eq!(on_a.pairs, on_b.pairs);
    // Both bodies moved alike.
    let motion = Pose::from_parts([0.2, 0.9, 0.3, -0.4], [5.0, -3.0, 8.0]);
    let moved: Vec<WeightedBall> = a
        .iter()
        .map(|ball| WeightedBall {
            center: motion.apply(ball.center),
            ..*ball
        })
        .collect();
    let same = overlap_of_all(
        &DEFAULT,
        &moved,
        &b,
        &motion.after(&pose),
        motion.apply(about),
    );
    assert!((same.energy / on_b.energy - 1.0).abs() < 1e-11);
    assert!((same.force - motion.rotation * on_b.force).norm() < 1e-10 * scale);
    assert!((same.torque - motion.rotation * on_b.torque).norm() < 1e-10 * scale);
}

#[test]
fn leaves_and_single_pairs_agree() {
    let mut numbers = Numbers(13);
    for alpha in [2.0, 4.0, f64::INFINITY] {
        let kernel = PairOverlap::new(alpha).unwrap();
        let a = random_balls(21, 3.0, &mut numbers);
        let b = random_balls(19, 3.0, &mut numbers);
        let about = [0.1, 0.2, 0.3];
        let one = overlap_of_all(&kernel, &a, &b, &Pose::identity(), about);
        let [mut leaves, mut swapped] = [(); 2].map(|()| Accumulator::new(&kernel, about));
        let met: u64 = a.iter().map(|ball| leaves.add_leaf(ball, &b)).sum();
        let mut add = |x: &WeightedBall, y: &WeightedBall| u64::from(swapped.add(x, y));
        let back = b.iter().flat_map(|y| a.iter().map(move |x| (x, y)));
        let back: u64 = back.map(|(x, y)| add(x, y)).sum();
        assert_eq!([met, back], [one.pairs; 2]);
        // The same order, the same bits.
        let mut single = Accumulator::new(&kernel, about);
        for x in &a {
            b.iter().for_each(|y| {
                single.add(x, y);
            });
        }
        assert_eq!(single.sum(), leaves.sum());
        for other in [leaves.sum(), swapped.sum()] {
            assert!((other.energy / one.energy - 1.0).abs() < 1e-12);
            assert!((other.force - one.force).norm() < 1e-12 * one.energy);
            assert!((other.torque - one.torque).norm() < 1e-11 * one.energy);
        }
    }
}

/// Lengths of 1e-6 and 1e6: energies scale with the cube.
#[test]
fn units_do_not_matter() {
    let (value, slope) = DEFAULT.value_and_slope(1.3, 0.4, 1.1);
    for unit in [1e-6, 1e6] {
        let (other, steep) = DEFAULT.value_and_slope(1.3 * unit, 0.4 * unit, 1.1 * unit);
        assert!((other / (value * unit.powi(3)) - 1.0).abs() < 1e-12);
        assert!((steep / (slope * unit.powi(2)) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn refuses_what_is_no_exponent() {
    for alpha in [0.0, -1.0, f64::NAN] {
        assert!(PairOverlap::new(alpha).is_err());
    }
}

/// A way to sum the pairs of two sets; a list of those that meet is given.
type Way = fn(&mut Accumulator, &[WeightedBall], &[WeightedBall], &[(usize, usize)]);

/// Nanoseconds a pair and the time to build the table: `cargo test -p knotdock-scoring --lib --release overlap_costs --
/// --ignored --nocapture`.
#[test]
#[ignore = "timing, for a quiet machine"]
fn overlap_costs_of_pairs() {
    let start = ThreadTime::now();
    let kernel = PairOverlap::new(2.0).unwrap();
    println!("table: {:?}", start.elapsed());
    let mut numbers = Numbers(17);
    let a = random_balls(600, 1.0, &mut numbers);
    let b = random_balls(600, 1.0, &mut numbers);
    for kernel in [&kernel, &PairOverlap::new(f64::INFINITY).unwrap()] {
        let mut best = [f64::INFINITY; 3];
        let mut pairs = Vec::new();
        for (i, x) in a.iter().enumerate() {
            for (j, y) in b.iter().enumerate() {
                let arm = Vector3::from(y.center) - Vector3::from(x.center);
                if meet(x.radius, y.radius, arm.norm_squared()) {
                    pairs.push((i, j));
                }
            }
        }
        for _ in 0..15 {
            let sums: [Way; 3] = [
                |sum, a, b, pairs| {
                    pairs.iter().for_each(|&(i, j)| {
                        sum.add(&a[i], &b[j]);
                    })
                },
                |sum, a, b, _| {
                    a.iter().for_each(|x| {
                        sum.add_leaf(x, b);
                    })
                },
                |sum, a, b, _| {
                    a.iter().for_each(|x| {
                        b.iter().for_each(|y| {
                            sum.add(x, y);
                        })
                    })
                },
            ];
            for (best, way) in best.iter_mut().zip(sums) {
                let start = ThreadTime::now();
                let mut sum = Accumulator::new(kernel, [0.0; 3]);
                way(&mut sum, &a, &b, &pairs);
                assert_eq!(sum.sum().pairs, pairs.len() as u64);
                *best = best.min(start.elapsed().as_secs_f64());
            }
        }
        let [pairwise, leaves, single] = best.map(|time| time * 1e9 / pairs.len() as f64);
        println!(
            "alpha {}: {} of 360000 pairs meet; ns each: {pairwise:.1} pair by pair, {leaves:.1} by leaves, \
             {single:.1} one by one of all",
            kernel.bump().alpha(),
            pairs.len(),
        );
    }
}
