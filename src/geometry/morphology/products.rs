//! Products and quotients over a set of poses (B&I, section 4.3, after Roerdink).

use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::sampling::Ball;

use super::MorphologyOptions;
use super::complement::{Cube, hausdorff_bound, holding, inside, needed_in};
use crate::geometry::bracket::{Bracket, bounds};
use crate::geometry::obstacle::reduce::reduced;

/// Cells of free space about the cube of a quotient.
const MARGIN: f64 = 2.0;

/// The product over poses, at least one: all points of A in any of them.
///
/// # Errors
/// [`Error`] if memory has no room for the balls.
pub fn product(a: &Bracket, poses: &[Pose], options: &MorphologyOptions) -> Result<Bracket, Error> {
    let balls = a.inner.len().max(a.outer.len()) as u64;
    options.room_for(balls.saturating_mul(poses.len() as u64))?;
    let origin = poses.first().map_or(a.origin, |pose| pose.apply(a.origin));
    let of = |set: fn(Bracket) -> Vec<Ball>| {
        let sets = poses.iter().map(|pose| set(a.moved(pose).about(origin)));
        reduced(sets.flatten())
    };
    Ok(Bracket {
        origin,
        inner: of(|moved| moved.inner),
        outer: of(|moved| moved.outer),
        epsilon: a.epsilon,
    })
}

/// The quotient over poses, at least one: the points that are in A in each of them. Its eps is measured.
///
/// By duality: the complement of the product of the complement of A.
///
/// # Errors
/// [`Error`] if memory has no room for the balls.
pub fn quotient(
    a: &Bracket,
    poses: &[Pose],
    options: &MorphologyOptions,
) -> Result<Bracket, Error> {
    let origin = poses.first().map_or(a.origin, |pose| pose.apply(a.origin));
    let empty = Bracket {
        origin,
        inner: Vec::new(),
        outer: Vec::new(),
        epsilon: 0.0,
    };
    let (mut low, mut high) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
    for pose in poses {
        let (its_low, its_high) = bounds(&a.moved(pose).about(origin).outer);
        low = [0, 1, 2].map(|axis| low[axis].max(its_low[axis]));
        high = [0, 1, 2].map(|axis| high[axis].min(its_high[axis]));
    }
    if poses.is_empty() || (0..3).any(|axis| low[axis] >= high[axis]) {
        return Ok(empty);
    }
    let result = Cube::about((low, high), options.per_axis, MARGIN);
    // The cube of the result, as seen from A in each pose, is within this one about A.
    let (a_low, a_high) = a.bounds();
    let mut around = Cube::about((a_low, a_high), options.per_axis, MARGIN);
    let reach = poses.iter().map(|pose| {
        let to_a = pose.inverse();
        let middle = to_a.apply([0, 1, 2].map(|axis| result.center[axis] + origin[axis]));
        let off = (0..3).map(|axis| (middle[axis] - a.origin[axis] - around.center[axis]).abs());
        // Its corners, and the cells about them.
        let corner = 3f64.sqrt() * result.half * (1.0 + 1.0 / (result.per_axis - 1) as f64);
        off.fold(0.0, f64::max) + corner
    });
    let reach = reach.fold(around.half, f64::max);
    around = around.wider(reach - around.half);
    let blocked = |mut outside: Vec<Ball>| {
        outside.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        let outside = Bracket {
            origin: a.origin,
            inner: Vec::new(),
            outer: outside,
            epsilon: 0.0,
        };
        let moved = poses
            .iter()
            .flat_map(|pose| outside.moved(pose).about(origin).outer);
        let balls = needed_in(&result, moved);
        options.room_for(balls.len() as u64).map(|()| balls)
    };
    let inner = match a.inner.is_empty() {
        true => Vec::new(),
        false => inside(&blocked(holding(&a.inner, &around))?, &result),
    };
    let outer = holding(&blocked(inside(&a.outer, &around))?, &result);
    let epsilon = hausdorff_bound(&inner, &outer, options.per_axis);
    Ok(Bracket {
        inner,
        outer,
        epsilon,
        ..empty
    })
}
