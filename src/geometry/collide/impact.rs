//! The first time at which a moving solid hits another, between two bounds: conservative advancement.
//!
//! Body B moves along geodesics from pose to pose, one unit of time each. While the outer balls are apart, B may go on
//! for as long as no point of it moves farther than that. The time at which their gap is no longer above the tolerance
//! is the last at which the path is known to be free. From there on the inner balls are followed in the same way, until
//! some of them meet: by then the solids have met. At the first time their gap is below the two eps.

use knotdock_scoring::se3::Pose;

use super::scene::{CollisionScene, Deadline, Verdict, Workspace};
use crate::geometry::motion::geodesic::{angle, interpolated};

/// Steps of one geodesic at most.
const STEPS: usize = 10_000;

/// What is known of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The path is free until this time, in poses from the first one.
    pub free_until: f64,
    /// By this time the solids have come closer than the margin; `None` if that is not certain on the path.
    pub hit_by: Option<f64>,
    /// The pose at that time; `None` where the whole path is free.
    pub pose: Option<Pose>,
    /// Whether the solids are known to come closer than the margin at that time.
    pub verdict: Verdict,
    /// Distances that were computed.
    pub steps: usize,
}

/// Follows a path until the solids may come closer than the margin and `tolerance`, which is above zero.
pub fn first_impact(
    scene: &CollisionScene,
    path: &[Pose],
    tolerance: f64,
    work: &mut Workspace,
) -> Impact {
    let mut steps = 0;
    let stopped = |time: f64, pose: Pose, steps: usize, work: &mut Workspace| {
        let motion = scene.motion(&pose);
        Impact {
            free_until: time,
            hit_by: hit_after(scene, path, time, tolerance, work),
            pose: Some(pose),
            verdict: scene.verdict(&motion, Deadline::NEVER, work).verdict,
            steps,
        }
    };
    for (number, ends) in path.windows(2).enumerate() {
        let speed = top_speed(scene, &ends[0], &ends[1]);
        let mut share = 0.0;
        for taken in 0.. {
            let pose = interpolated(&ends[0], &ends[1], share);
            let gap = gap(scene, &pose, work);
            steps += 1;
            if gap <= tolerance || taken >= STEPS {
                return stopped(number as f64 + share, pose, steps, work);
            }
            if share >= 1.0 {
                break;
            }
            // Where nothing moves, the end of the geodesic is as far as its beginning.
            let step = gap / speed;
            share = if step.is_finite() {
                (share + step).min(1.0)
            } else {
                1.0
            };
        }
    }
    if let [only] = path
        && gap(scene, only, work) <= tolerance
    {
        return stopped(0.0, *only, 1, work);
    }
    Impact {
        free_until: path.len().saturating_sub(1) as f64,
        hit_by: None,
        pose: None,
        verdict: Verdict::Free,
        steps: steps.max(1),
    }
}

/// The first time from `start` on that is found at which inner balls come closer than the margin.
fn hit_after(
    scene: &CollisionScene,
    path: &[Pose],
    start: f64,
    tolerance: f64,
    work: &mut Workspace,
) -> Option<f64> {
    let first = start as usize;
    let mut share = start - first as f64;
    // The last pose is a geodesic that ends where it begins.
    for (number, from) in path.iter().enumerate().skip(first) {
        let to = path.get(number + 1).unwrap_or(from);
        let speed = top_speed(scene, from, to);
        for _ in 0..STEPS {
            // Inner balls lie as much farther apart as the outer ones are larger.
            let gap = gap(scene, &interpolated(from, to, share), work) + scene.band();
            if gap < 0.0 {
                return Some(number as f64 + share);
            }
            if share >= 1.0 {
                break;
            }
            let step = gap.max(tolerance) / speed;
            share = if step.is_finite() {
                (share + step).min(1.0)
            } else {
                1.0
            };
        }
        if share < 1.0 {
            // Too many steps along one geodesic.
            return None;
        }
        share = 0.0;
    }
    None
}

/// Lower bound of the distance of the solids, less the margin.
fn gap(scene: &CollisionScene, pose: &Pose, work: &mut Workspace) -> f64 {
    let motion = scene.motion(pose);
    let limits = knotdock_structures::ball_solid::Limits {
        ignored_from: f64::INFINITY,
        // Inner balls that meet end the path, however deep they are.
        enough_below: scene.margin(),
    };
    let found = scene.search(&motion, &limits, Deadline::NEVER, work);
    found.distance - scene.band() - scene.margin()
}

/// How far any point of body B moves at most on the geodesic between two poses.
fn top_speed(scene: &CollisionScene, from: &Pose, to: &Pose) -> f64 {
    let solid = &scene.solids()[1];
    let turned = angle(from, to);
    let shift = (to.translation - from.translation).norm();
    let arm = solid
        .origin()
        .iter()
        .fold(0.0f64, |sum, part| sum.hypot(*part));
    shift + turned * (arm + solid.reach())
}
