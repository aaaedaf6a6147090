//! The first time at which a moving solid hits another, between two bounds: conservative advancement.
//!
//! Body B moves along geodesics from pose to pose, one unit of time each. While the bodies are apart, B may go on until a
//! point of it could have crossed their gap: that of the outer balls, and near contact that of the triangles if these
//! decide. The path is known to be free until the gap is within the tolerance. From there on B goes on in the same way
//! until a hit is certain, by the gap of the triangles, or else of the inner balls: by then the solids have met.

use knotdock_scoring::se3::Pose;
use knotdock_structures::ball_solid::Limits;

use super::{Collision, CollisionQuery, Gap, Verdict, Workspace};
use crate::geometry::motion::{angle, interpolated};

/// Maximum number of steps of one geodesic.
const STEPS: usize = 10_000;
/// Gap that counts as a hit, as a share of the smaller solid's reach.
const TOLERANCE: f64 = 1e-6;

/// Bounds of the first time at which a path comes closer than the margin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Impact {
    /// The path is free until this time, in poses from the first one.
    pub free_until: f64,
    /// By this time the solids have come closer than the margin; `None` if that is not certain on the path.
    pub hit_by: Option<f64>,
    /// The pose at `free_until`; `None` if the whole path is free.
    pub pose: Option<Pose>,
    /// The verdict at that pose.
    pub verdict: Verdict,
    /// Distances that were computed.
    pub steps: usize,
}

impl Collision<'_> {
    /// Follows a path until the solids may come closer than the margin.
    pub fn first_impact(&self, path: &[Pose]) -> Impact {
        let work = &mut Workspace::default();
        let tolerance = TOLERANCE * self.solids[0].reach().min(self.solids[1].reach());
        let mut steps = 0;
        let stopped = |time: f64, pose: Pose, steps: usize, work: &mut Workspace| Impact {
            free_until: time,
            hit_by: self.hit_after(path, time, tolerance, work),
            pose: Some(pose),
            verdict: self.timeless(&pose, work).certificate_by_search().verdict(),
            steps,
        };
        for (number, ends) in path.windows(2).enumerate() {
            let speed = self.top_speed(&ends[0], &ends[1]);
            let mut share = 0.0;
            for taken in 0.. {
                let pose = interpolated(&ends[0], &ends[1], share);
                let gap = self.gap(&pose, work);
                steps += 1;
                if gap <= tolerance || taken >= STEPS {
                    return stopped(number as f64 + share, pose, steps, work);
                }
                if share >= 1.0 {
                    break;
                }
                share = advanced(share, gap / speed);
            }
        }
        if let [only] = path
            && self.gap(only, work) <= tolerance
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

    /// The first time from `start` on at which a hit is certain.
    fn hit_after(
        &self,
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
            let speed = self.top_speed(from, to);
            for _ in 0..STEPS {
                let pose = interpolated(from, to, share);
                let certificate = self.timeless(&pose, work).certificate_by_search();
                if certificate.verdict() == Verdict::Hit {
                    return Some(number as f64 + share);
                }
                let gap = match self.exact() {
                    Some(_) => self.gap(&pose, work),
                    // Inner balls are as much farther apart as the outer ones are larger.
                    None => self.gap(&pose, work) + self.band(),
                };
                if share >= 1.0 {
                    break;
                }
                share = advanced(share, gap.max(tolerance) / speed);
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
    fn gap(&self, pose: &Pose, work: &mut Workspace) -> f64 {
        let limits = Limits {
            ignored_from: f64::INFINITY,
            // Inner balls that meet end the path, however deep they are.
            enough_below: self.margin,
        };
        let mut query = self.timeless(pose, work);
        let closest = query.closest(&limits);
        let low = closest.distance - self.band();
        // Far from contact balls are near enough to the truth.
        let exact = self.exact().filter(|_| low < self.margin + self.band());
        let gap = match exact {
            Some(solids) if closest.distance > 0.0 => match query.gap(solids, closest.distance) {
                Gap::Apart(found) => found.low.max(low),
                Gap::None | Gap::Open => low.min(0.0),
            },
            _ => low,
        };
        gap - self.margin
    }

    /// A query without a deadline.
    fn timeless<'q>(&'q self, pose: &Pose, work: &'q mut Workspace) -> CollisionQuery<'q> {
        CollisionQuery {
            end: None,
            ..self.query(pose, work)
        }
    }

    /// How far any point of body B moves at most on the geodesic between two poses.
    fn top_speed(&self, from: &Pose, to: &Pose) -> f64 {
        let solid = self.solids[1];
        let shift = (to.translation - from.translation).norm();
        shift + angle(from, to) * (super::length(solid.origin()) + solid.reach())
    }
}

/// The share of a geodesic after a step; its end if nothing moves.
fn advanced(share: f64, step: f64) -> f64 {
    match step.is_finite() {
        true => (share + step).min(1.0),
        false => 1.0,
    }
}
