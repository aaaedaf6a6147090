//! Geodesic balls: the poses within a distance of one, as sets of tolerance.

use std::f64::consts::{PI, SQRT_2};

use knotdock_scoring::se3::Pose;
use nalgebra::{UnitQuaternion, Vector3};

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
    use crate::geometry::motion::geodesic::distance;

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
