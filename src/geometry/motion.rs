//! Rigid motions as points of SE(3) with a distance: geodesics and sets of tolerated poses (B&I, appendix B).
//!
//! The distance is sqrt(2 theta^2 + |dt|^2) (B&I, eq. 59, with the Frobenius norm of the rotation's logarithm).
//! Theta is the angle between the rotations in radians, dt the difference of the translations in the file's unit. The
//! distance is the same after both poses are followed by one motion. It depends on the unit, and on where the moved
//! solid's frame has its origin.

use std::f64::consts::{PI, SQRT_2};

use knotdock_scoring::se3::Pose;
use nalgebra::{UnitQuaternion, Vector3};

/// Angle in radians, 0 to pi, between the rotations of two poses, without the lost digits of an arc cosine.
pub fn angle(a: &Pose, b: &Pose) -> f64 {
    a.rotation.rotation_to(&b.rotation).angle()
}

/// Distance of two poses.
pub fn distance(a: &Pose, b: &Pose) -> f64 {
    let shift = (b.translation - a.translation).norm();
    shift.hypot(SQRT_2 * angle(a, b))
}

/// The pose at `share` of the geodesic, 0 at `a` and 1 at `b`. Of two rotations that
/// differ by half a turn one of the two ways is taken, always the same.
pub fn interpolated(a: &Pose, b: &Pose, share: f64) -> Pose {
    if share <= 0.0 {
        return *a;
    }
    if share >= 1.0 {
        return *b;
    }
    Pose {
        rotation: a.rotation.rotation_to(&b.rotation).powf(share) * a.rotation,
        translation: a.translation.lerp(&b.translation, share),
    }
}

/// `steps` + 1 poses from `a` to `b`, evenly spaced on the geodesic.
pub fn path(a: &Pose, b: &Pose, steps: usize) -> Vec<Pose> {
    let steps = steps.max(1);
    let at = |step: usize| interpolated(a, b, step as f64 / steps as f64);
    (0..=steps).map(at).collect()
}

/// The positive root of x^7 = x + 1. Its powers give the additive recurrence in six dimensions (Roberts, 2018), whose
/// points spread evenly for any count.
const RATIO: f64 = 1.112_775_684_278_705_5;

/// `count` poses within `radius` of `center`, the centre first. They are the same on every machine. They spread evenly
/// over the ball of tangent vectors (sqrt(2) w, v) that are no longer than the radius, |w| <= pi.
pub fn geodesic_ball(center: &Pose, radius: f64, count: usize) -> Vec<Pose> {
    let mut poses = Vec::with_capacity(count);
    poses.extend((count > 0).then_some(*center));
    let widest = (radius / SQRT_2).min(PI);
    let mut number = 0.0;
    while poses.len() < count {
        number += 1.0;
        let part = |power: i32| 2.0 * (0.5 + number * RATIO.powi(-power)).fract() - 1.0;
        let point = [1, 2, 3, 4, 5, 6].map(part);
        let turn = Vector3::new(point[0], point[1], point[2]) * widest;
        let step = Vector3::new(point[3], point[4], point[5]) * radius;
        let length = step.norm().hypot(SQRT_2 * turn.norm());
        if length > radius || turn.norm() > PI {
            continue;
        }
        poses.push(Pose {
            rotation: center.rotation * UnitQuaternion::from_scaled_axis(turn),
            translation: center.translation + center.rotation * step,
        });
    }
    poses
}

#[cfg(test)]
mod tests {
    use super::*;

    fn poses() -> Vec<Pose> {
        (1..=12)
            .map(|i| {
                let part = |step: f64| 2.0 * (f64::from(i) * step).fract() - 1.0;
                let rotation = [part(0.8191), part(0.671), part(0.5497), part(0.4503)];
                Pose::from_parts(rotation, [5.0 * part(0.3), part(0.7), 3.0 * part(0.9)])
            })
            .collect()
    }

    #[test]
    fn the_distance_is_a_left_invariant_metric() {
        let poses = poses();
        for a in &poses {
            assert!(distance(a, a) < 1e-15);
            for b in &poses {
                let ab = distance(a, b);
                assert!((ab - distance(b, a)).abs() < 1e-12);
                for c in &poses {
                    assert!(ab <= distance(a, c) + distance(c, b) + 1e-12);
                    let after = distance(&c.after(a), &c.after(b));
                    assert!((ab - after).abs() < 1e-12, "{ab} {after}");
                }
            }
        }
    }

    #[test]
    fn a_quarter_turn_and_a_step() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let moved = Pose::from_parts([half, 0.0, 0.0, half], [0.0, 3.0, 0.0]);
        let theta = std::f64::consts::FRAC_PI_2;
        let exact = (2.0 * theta * theta + 9.0).sqrt();
        assert!((distance(&Pose::identity(), &moved) - exact).abs() < 1e-14);
    }

    #[test]
    fn geodesics_are_even() {
        let poses = poses();
        for pair in poses.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            let path = path(a, b, 7);
            assert_eq!((path[0], path[7]), (*a, *b));
            for step in path.windows(2) {
                let exact = distance(a, b) / 7.0;
                assert!((distance(&step[0], &step[1]) - exact).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn poses_lie_within_the_radius_and_fill_it() {
        assert!((RATIO.powi(7) - RATIO - 1.0).abs() < 1e-14);
        let center = Pose::from_parts([0.3, -0.8, 0.1, 0.5], [10.0, -4.0, 2.0]);
        for radius in [1e-3, 0.5, 3.0] {
            let poses = geodesic_ball(&center, radius, 2000);
            assert_eq!((poses.len(), poses[0]), (2000, center));
            let shares = poses.iter().map(|pose| distance(&center, pose) / radius);
            let shares: Vec<f64> = shares.collect();
            assert!(shares.iter().all(|&share| share <= 1.0 + 1e-9));
            // In six dimensions half of the volume lies beyond 0.89 of the radius.
            let beyond = shares
                .iter()
                .filter(|&&share| share > 0.5f64.powf(1.0 / 6.0));
            let beyond = beyond.count();
            assert!((900..1100).contains(&beyond), "{beyond}");
        }
        assert!(geodesic_ball(&center, 1.0, 0).is_empty());
        assert_eq!(geodesic_ball(&center, 1e9, 100).len(), 100);
    }
}
