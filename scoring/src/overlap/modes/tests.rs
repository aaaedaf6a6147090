//! Modes against pairs: values within their bounds, gradients, and certificates that are never wrong.

use super::*;
use crate::overlap::{meet, overlap_of_all};
use crate::test_support::Numbers;
use cpu_time::ThreadTime;
use nalgebra::UnitQuaternion;
use std::sync::LazyLock;

static KERNEL: LazyLock<PairOverlap> = LazyLock::new(|| PairOverlap::new(2.0).unwrap());

fn balls(count: usize, size: f64, numbers: &mut Numbers) -> Vec<WeightedBall> {
    (0..count)
        .map(|_| WeightedBall {
            center: std::array::from_fn(|_| 30.0 + size * (numbers.next() - 0.5)),
            radius: size * (0.2 + 0.2 * numbers.next()),
            weight: 0.3 + numbers.next(),
        })
        .collect()
}

/// A random pose: along each axis the bodies' middles differ by at most `reach`.
fn pose(modes: &OverlapModes, reach: f64, numbers: &mut Numbers) -> Pose {
    let rotation =
        Pose::from_parts(std::array::from_fn(|_| numbers.next() - 0.5), [0.0; 3]).rotation;
    let place = modes.a.center + Vector3::from_fn(|_, _| 2.0 * reach * (numbers.next() - 0.5));
    Pose::about(rotation, modes.b.center, place)
}

fn gap(a: &[WeightedBall], b: &[WeightedBall], pose: &Pose) -> f64 {
    let mut gap = f64::INFINITY;
    for y in b {
        let y_center = Vector3::from(pose.apply(y.center));
        for x in a {
            let distance = (y_center - Vector3::from(x.center)).norm();
            gap = gap.min(distance - x.radius - y.radius);
        }
    }
    gap
}

#[test]
fn energies_lie_within_their_bounds() {
    let mut numbers = Numbers(3);
    let a = balls(40, 10.0, &mut numbers);
    let b = balls(25, 8.0, &mut numbers);
    for most in [20, 300, 4000, 30_000] {
        let modes = OverlapModes::new(&KERNEL, &a, &b, most).unwrap();
        let mut work = modes.workspace();
        let (mut worst, mut hits, mut meets) = (0.0f64, 0, 0);
        let mut scale = 0.0f64;
        for _ in 0..60 {
            let pose = pose(&modes, 12.0, &mut numbers);
            let exact = overlap_of_all(&KERNEL, &a, &b, &pose, [0.0; 3]);
            let mut sum = modes.start(&pose, &mut work);
            // Every stop on the way has its bound.
            loop {
                let part = sum.sum();
                let error = (part.energy - exact.energy).abs();
                let kernel = 3.0 * KERNEL.error() * exact.pairs as f64 * 40.0;
                assert!(
                    error <= part.tail + part.rounding + kernel,
                    "{part:?} {}",
                    exact.energy
                );
                assert!(!part.certifies_hit() || exact.pairs > 0);
                if part.complete {
                    // In pieces and at once, the same bits.
                    let mut work = modes.workspace();
                    let whole = modes.start(&pose, &mut work).advance(|_| false);
                    assert_eq!(whole, part);
                    worst = worst.max(error);
                    scale = scale.max(exact.energy);
                    hits += usize::from(part.certifies_hit());
                    meets += usize::from(exact.pairs > 0);
                    break;
                }
                let mut once = false;
                sum.advance(|_| std::mem::replace(&mut once, true));
            }
        }
        println!(
            "{} modes: error {worst:.1e} of {scale:.1}, {hits} of {meets} hits certified",
            modes.modes()
        );
        assert!(most < 30_000 || 2 * hits > meets);
        assert!(most < 30_000 || worst < 1e-3 * scale);
    }
}

#[test]
fn force_and_torque_are_those_of_the_sum_and_near_those_of_pairs() {
    let mut numbers = Numbers(5);
    let a = balls(20, 10.0, &mut numbers);
    let b = balls(11, 8.0, &mut numbers);
    let modes = OverlapModes::new(&KERNEL, &a, &b, 20_000).unwrap();
    let mut work = modes.workspace();
    for _ in 0..4 {
        let pose = pose(&modes, 5.0, &mut numbers);
        let about = [27.0, 31.0, 35.0];
        let sum = modes.evaluate(&pose, about, &mut work);
        let exact = overlap_of_all(&KERNEL, &a, &b, &pose, about);
        let scale = exact.force.norm() + exact.torque.norm();
        // Slopes converge a power of the frequency slower than the energy.
        assert!((sum.force - exact.force).norm() < 1e-2 * scale);
        assert!((sum.torque - exact.torque).norm() < 5e-2 * scale);
        let h = 1e-4;
        for axis in 0..3 {
            let step = Vector3::ith(axis, h);
            let mut energy = |pose: &Pose| modes.evaluate(pose, about, &mut work).energy;
            let mut moved = |sign: f64| {
                energy(&Pose {
                    translation: pose.translation + sign * step,
                    ..pose
                })
            };
            let force = -(moved(1.0) - moved(-1.0)) / (2.0 * h);
            let mut turned = |sign: f64| {
                let turn = UnitQuaternion::new(sign * step);
                let center = Vector3::from(about);
                energy(&Pose::about(turn, center, center).after(&pose))
            };
            let torque = -(turned(1.0) - turned(-1.0)) / (2.0 * h);
            assert!(
                (force - sum.force[axis]).abs() < 1e-6 * scale,
                "{force} {}",
                sum.force
            );
            assert!(
                (torque - sum.torque[axis]).abs() < 1e-5 * scale,
                "{torque} {}",
                sum.torque
            );
        }
    }
}

/// Poses near contact, with and without a margin: a certificate never fires where the gap is wider than the margin.
#[test]
fn certificates_are_never_wrong() {
    let mut numbers = Numbers(9);
    let a = balls(12, 10.0, &mut numbers);
    let b = balls(12, 9.0, &mut numbers);
    for margin in [0.0, 0.7, 3.0, 20.0] {
        let modes = OverlapModes::with_margin(&KERNEL, &a, &b, 3000, margin).unwrap();
        let mut work = modes.workspace();
        let (mut fired, mut near) = (0, 0);
        for _ in 0..400 {
            let pose = pose(&modes, 11.0 + margin, &mut numbers);
            let sum = modes
                .start(&pose, &mut work)
                .advance(|sum| sum.certifies_hit());
            let gap = gap(&a, &b, &pose);
            assert!(
                !sum.certifies_hit() || gap < margin,
                "{margin}: {gap} {sum:?}"
            );
            fired += usize::from(sum.certifies_hit());
            near += usize::from(gap < margin);
        }
        println!("margin {margin}: {fired} of {near} certified");
        assert!(fired > 0);
    }
}

/// The smoothed function is A convolved with the bump: one ball against one is a triple overlap, whose integral over
/// all translations is the product of the volumes.
#[test]
fn a_margin_keeps_the_integral() {
    let one = |radius| WeightedBall {
        center: [0.0; 3],
        radius,
        weight: 1.0,
    };
    let modes = OverlapModes::with_margin(&KERNEL, &[one(1.0)], &[one(2.0)], 40_000, 1.5).unwrap();
    let mut work = modes.workspace();
    let mut at = |d: f64| {
        let pose = Pose {
            translation: Vector3::new(d, 0.0, 0.0),
            ..Pose::identity()
        };
        modes.start(&pose, &mut work).advance(|_| false).energy
    };
    let step = 4.6 / 500.0;
    let integral: f64 = (0..500)
        .map(|i| (f64::from(i) + 0.5) * step)
        .map(|d| 4.0 * PI * d * d * at(d) * step)
        .sum();
    let volume = KERNEL.bump().volume();
    assert!(
        (integral / (8.0 * volume * volume) - 1.0).abs() < 1e-4,
        "{integral}"
    );
}

/// Grazing balls have energy 0: the modes stay silent where geometry reports the hit.
#[test]
fn modes_are_silent_about_grazing_contact() {
    let ball = |x: f64| WeightedBall {
        center: [x, 0.0, 0.0],
        radius: 1.0,
        weight: 1.0,
    };
    let modes = OverlapModes::new(&KERNEL, &[ball(0.0)], &[ball(0.0)], 5000).unwrap();
    let mut work = modes.workspace();
    let pose = Pose {
        translation: Vector3::new(2.0 - 1e-9, 0.0, 0.0),
        ..Pose::identity()
    };
    assert!(!modes.evaluate(&pose, [0.0; 3], &mut work).certifies_hit());
    assert!(meet(1.0, 1.0, pose.translation.norm_squared()));
    let deep = modes.evaluate(&Pose::identity(), [0.0; 3], &mut work);
    assert!(deep.certifies_hit() && deep.force.norm() < 1e-9);
    let far = Pose {
        translation: Vector3::new(50.0, 0.0, 0.0),
        ..Pose::identity()
    };
    let sum = modes.evaluate(&far, [0.0; 3], &mut work);
    assert!(sum.energy == 0.0 && sum.tail == 0.0 && sum.complete);
}

#[test]
fn negative_weights_certify_nothing_and_bad_balls_are_refused() {
    let ball = |weight: f64, radius: f64| WeightedBall {
        center: [0.0; 3],
        radius,
        weight,
    };
    let modes = OverlapModes::new(&KERNEL, &[ball(-1.0, 1.0)], &[ball(-1.0, 1.0)], 500).unwrap();
    let sum = modes.evaluate(&Pose::identity(), [0.0; 3], &mut modes.workspace());
    assert!(sum.energy > 0.0 && !sum.certifies_hit());
    let good = [ball(1.0, 1.0)];
    let new = |a: &[WeightedBall], b: &[WeightedBall], margin| {
        let refused = OverlapModes::with_margin(&KERNEL, a, b, 10, margin).err();
        refused.unwrap().to_string()
    };
    assert!(new(&[], &good, 0.0).starts_with("body A has no balls"));
    for ball in [
        ball(f64::NAN, 1.0),
        ball(1.0, 0.0),
        ball(1.0, f64::INFINITY),
    ] {
        assert!(new(&good, &[good[0], ball], 0.0).starts_with("ball 1 of body B"));
    }
    assert!(new(&good, &good, -1.0).starts_with("the margin"));
}

/// Sharp balls have modes too, and wide tails.
#[test]
fn sharp_balls_lie_within_their_bounds() {
    let kernel = PairOverlap::new(f64::INFINITY).unwrap();
    let mut numbers = Numbers(21);
    let a = balls(6, 10.0, &mut numbers);
    let b = balls(5, 9.0, &mut numbers);
    let modes = OverlapModes::new(&kernel, &a, &b, 3000).unwrap();
    let mut work = modes.workspace();
    for _ in 0..40 {
        let pose = pose(&modes, 8.0, &mut numbers);
        let exact = overlap_of_all(&kernel, &a, &b, &pose, [0.0; 3]);
        let sum = modes.evaluate(&pose, [0.0; 3], &mut work);
        assert!((sum.energy - exact.energy).abs() <= sum.tail + sum.rounding);
    }
}

/// Microseconds a pose: `cargo test -p knotdock-scoring --lib --release overlap_costs -- --ignored --nocapture`.
#[test]
#[ignore = "timing, for a quiet machine"]
fn overlap_costs_of_modes() {
    let mut numbers = Numbers(17);
    let a = balls(600, 10.0, &mut numbers);
    let b = balls(600, 10.0, &mut numbers);
    for most in [256, 1024, 4096, 16_384] {
        let start = ThreadTime::now();
        let modes = OverlapModes::new(&KERNEL, &a, &b, most).unwrap();
        let built = start.elapsed();
        let mut work = modes.workspace();
        let pose = pose(&modes, 2.0, &mut numbers);
        let mut best = [f64::INFINITY; 2];
        let mut sum = ModesOverlap::default();
        for _ in 0..5 {
            let start = ThreadTime::now();
            modes.start(&pose, &mut work).advance(|_| false);
            best[0] = best[0].min(start.elapsed().as_secs_f64());
            let start = ThreadTime::now();
            sum = modes.evaluate(&pose, [0.0; 3], &mut work);
            best[1] = best[1].min(start.elapsed().as_secs_f64());
        }
        let start = ThreadTime::now();
        let hit = modes
            .start(&pose, &mut work)
            .advance(|sum| sum.certifies_hit());
        let early = start.elapsed();
        let [value, all] = best.map(|time| 1e6 * time);
        println!(
            "{} modes: built in {built:?}; energy and force {value:.0} us, with torque {all:.0} us ({:.3} ns a mode and \
             ball); energy {:.4e}, tail {:.1e}, rounding {:.1e}; early hit {} after {} modes, {early:?}",
            modes.modes(),
            1e3 * all / (modes.modes() * b.len()) as f64,
            sum.energy,
            sum.tail,
            sum.rounding,
            hit.certifies_hit(),
            hit.modes
        );
    }
    let start = ThreadTime::now();
    let exact = overlap_of_all(&KERNEL, &a, &b, &Pose::identity(), [0.0; 3]);
    println!(
        "{} pairs meet, one by one {:?}",
        exact.pairs,
        start.elapsed()
    );
}
