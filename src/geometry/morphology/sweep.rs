//! Sweeps: all points that a solid passes on a path of poses, with tolerances.
//!
//! Between two poses of the path the motion is the geodesic: the rotation turns at a constant rate and the translation
//! moves on a straight line. On a step of angle theta and translation dt a point x moves by theta |x| + |dt| at most.
//! Every point of the step is within half of that of a sampled pose. Outer balls grow by it, each by the motion of its
//! own centre, since a ball turns about its centre unseen. Inner balls are those of the samples alone.
//!
//! A tolerance R lets each pose vary within the geodesic ball of that radius, sqrt(2 theta^2 + |dt|^2) <= R (B&I, eq. 59).
//! A point x then moves by R sqrt(|x|^2 / 2 + 1) at most, which outer balls grow by. Translations alone reach R in every
//! direction, so inner balls grow by R.

use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::sampling::Ball;

use super::MorphologyOptions;
use crate::geometry::bracket::{Bracket, shifted, turned};
use crate::geometry::motion::{angle, interpolated};
use crate::geometry::obstacle::reduce::reduced;

/// How finely a path is sampled, and how exactly it is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepOptions {
    /// Most that a point of the solid moves between two samples, in the file's unit; above zero.
    pub step: f64,
    /// Radius of the geodesic ball that each pose may vary in.
    pub tolerance: f64,
}

/// A sampled pose of a path.
struct Sample {
    pose: Pose,
    /// Angle and translation of the longer of the steps before and after.
    step: (f64, f64),
}

/// Steps between two poses, so many that no point within `reach` of the frame's origin moves by more than `step`; and
/// the angle and length of all of them together.
fn steps_between(ends: &[Pose], reach: f64, step: f64) -> (f64, [f64; 2]) {
    let [from, to] = [ends[0], ends[1]];
    let (turn, shift) = (
        angle(&from, &to),
        (to.translation - from.translation).norm(),
    );
    let count = ((turn * reach + shift) / step).ceil().max(1.0);
    (count, [turn, shift])
}

/// Poses along a path, so dense that no point within `reach` of the frame's origin moves by more than `step`.
fn samples(path: &[Pose], reach: f64, step: f64) -> Vec<Sample> {
    let first = path.iter().take(1).map(|&pose| Sample {
        pose,
        step: (0.0, 0.0),
    });
    let mut samples: Vec<Sample> = first.collect();
    for pair in path.windows(2) {
        let (count, [turn, shift]) = steps_between(pair, reach, step);
        let step = (turn / count, shift / count);
        for number in 1..=count as usize {
            if let Some(Sample { step: last, .. }) = samples.last_mut() {
                *last = (last.0.max(step.0), last.1.max(step.1));
            }
            let pose = interpolated(&pair[0], &pair[1], number as f64 / count);
            samples.push(Sample { pose, step });
        }
    }
    samples
}

/// Poses that [`sweep`] would sample.
pub fn sample_count(a: &Bracket, path: &[Pose], options: &SweepOptions) -> u64 {
    let reach = reach(a);
    let legs = path.windows(2);
    let steps = legs.map(|pair| steps_between(pair, reach, options.step).0);
    (steps.sum::<f64>() as u64).saturating_add(1)
}

/// Farthest distance of an outer ball's centre from the frame's origin.
fn reach(a: &Bracket) -> f64 {
    let far = a.outer.iter().map(|ball| from_frame(ball, a.origin));
    far.fold(0.0, f64::max)
}

/// Distance of a ball's centre from the frame's origin.
fn from_frame(ball: &Ball, origin: [f64; 3]) -> f64 {
    nalgebra::Vector3::from(shifted(ball, origin).center).norm()
}

/// All points that the solid passes on a path of at least one pose. eps is that of the solid, the half step and what
/// tolerances leave open.
///
/// # Errors
/// [`Error`] if memory has no room for the balls.
pub fn sweep(
    a: &Bracket,
    path: &[Pose],
    sweep: &SweepOptions,
    options: &MorphologyOptions,
) -> Result<Bracket, Error> {
    let balls = a.inner.len().max(a.outer.len()) as u64;
    options.room_for(balls.saturating_mul(sample_count(a, path, sweep)))?;
    let samples = samples(path, reach(a), sweep.step);
    let origin = path.first().map_or(a.origin, |pose| pose.apply(a.origin));
    let varied = |far: f64| sweep.tolerance * (0.5 * far * far + 1.0).sqrt();
    let moved = |balls: &'_ [Ball], margin: &dyn Fn(f64, (f64, f64)) -> f64| {
        let mut all = Vec::new();
        for &Sample { pose, step } in &samples {
            let place = pose.apply(a.origin);
            let by = [0, 1, 2].map(|axis| place[axis] - origin[axis]);
            all.extend(balls.iter().map(|ball| {
                let far = from_frame(ball, a.origin);
                shifted(&turned(ball, &pose), by).grown(margin(far, step))
            }));
        }
        reduced(all)
    };
    let half_step = |far: f64, (turn, shift): (f64, f64)| 0.5 * (turn * far + shift);
    let inner = moved(&a.inner, &|_, _| sweep.tolerance);
    let outer = moved(&a.outer, &|far, step| half_step(far, step) + varied(far));
    let far = reach(a);
    let longest = samples.iter().map(|sample| half_step(far, sample.step));
    Ok(Bracket {
        origin,
        inner,
        outer,
        epsilon: a.epsilon + longest.fold(0.0, f64::max) + varied(far) - sweep.tolerance,
    })
}
