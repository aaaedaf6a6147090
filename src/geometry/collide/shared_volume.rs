//! The volume that two solids share at a pose: of meshes whose triangles decide exact but for rounding
//! ([`knotdock_structures::mesh::SharedRegion`]), of others between that of their inner and that of their outer balls.
//!
//! A point of both solids is in a ball of either, and these two meet. So only balls that meet one of the other body's
//! count. The volume that their unions share is exact but for rounding ([`ball_union::shared_volume`]).
//!
//! That cannot stop halfway. Under a deadline the volume is bounded by balls alone: from below by the largest lens of two
//! inner balls, from above by the balls of either solid that meet one of the other.

use std::f64::consts::PI;

use knotdock_structures::Ball;
use knotdock_structures::ball_solid::BallSolid;
use knotdock_structures::ball_union::{self, Volume, lens_volume};

use super::{CollisionQuery, PAIRS_PER_CLOCK_CHECK, has_come};

/// A volume and how far the true one may be from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SharedVolume {
    /// The middle of the range, in the cube of the files' unit.
    pub value: f64,
    /// Half of the range: the volume that the solids share differs from the value by no more than this.
    pub bound: f64,
}

impl SharedVolume {
    fn between(low: f64, high: f64) -> Self {
        let low = low.max(0.0);
        Self {
            value: 0.5 * low + 0.5 * high,
            bound: 0.5 * (high - low).max(0.0),
        }
    }
}

impl CollisionQuery<'_> {
    /// The volume of the region in both solids.
    pub fn shared_volume(&mut self) -> SharedVolume {
        if self.end.is_some() {
            return self.volume_by_pairs();
        }
        if let Some(region) = self.region() {
            return SharedVolume {
                value: region.volume,
                bound: region.bound,
            };
        }
        let band = self.collision.band();
        let inner = self.shared(0.0);
        if band == 0.0 {
            return SharedVolume {
                value: inner.value,
                bound: inner.error,
            };
        }
        let outer = self.shared(band);
        SharedVolume::between(inner.value - inner.error, outer.value + outer.error)
    }

    /// Clears the marks of balls.
    fn clear_marks(&mut self) {
        let trees = self.collision.trees();
        for (marks, tree) in self.work.marks.iter_mut().zip(trees) {
            marks.clear();
            marks.resize(tree.balls().len(), false);
        }
    }

    /// Bounds from the pairs of balls that meet; if the deadline ends the visit, from the balls about all of them.
    fn volume_by_pairs(&mut self) -> SharedVolume {
        self.clear_marks();
        let (trees, band) = (self.collision.trees(), self.collision.band());
        let [a, b] = self.collision.solids.map(BallSolid::epsilon);
        let (pairs, marks) = (&mut self.work.pairs, &mut self.work.marks);
        let (mut low, mut high, mut seen) = (0.0f64, [0.0f64; 2], 0usize);
        let all = pairs.visit(trees, &self.motion, band, |[i, j], moved, squared| {
            let first = trees[0].balls()[i];
            let grown = [(0, i, first.radius + a), (1, j, moved.radius + b)];
            for (side, ball, radius) in grown {
                if !std::mem::replace(&mut marks[side][ball], true) {
                    high[side] += ball_volume(radius);
                }
            }
            low = low.max(lens_volume(first.radius, moved.radius, squared.sqrt()));
            seen += 1;
            !seen.is_multiple_of(PAIRS_PER_CLOCK_CHECK) || !has_come(self.end)
        });
        let bounds = [0, 1].map(|side| match trees[side].bound() {
            Some(bound) if !all => ball_volume(bound.radius + band),
            _ => high[side],
        });
        SharedVolume::between(low, bounds[0].min(bounds[1]))
    }

    /// Shared volume of the inner balls, or of the outer ones if `band` is above zero.
    fn shared(&mut self, band: f64) -> Volume {
        self.clear_marks();
        let (trees, motion) = (self.collision.trees(), &self.motion);
        let (pairs, marks) = (&mut self.work.pairs, &mut self.work.marks);
        pairs.visit(trees, motion, band, |[i, j], _, _| {
            marks[0][i] = true;
            marks[1][j] = true;
            true
        });
        let [a, b] = self.collision.solids.map(|solid| match band > 0.0 {
            true => solid.epsilon(),
            false => 0.0,
        });
        let first = marked(trees[0].balls(), &marks[0], a, |center| center);
        let second = marked(trees[1].balls(), &marks[1], b, |center| {
            motion.apply(center)
        });
        let mut volume = ball_union::shared_volume(&first, &second);
        // Rounding of a place moves each sphere.
        let spheres = [&first, &second].map(|balls| balls.iter().map(sphere).sum::<f64>());
        volume.error += self.rounding() * spheres[0].min(spheres[1]);
        volume
    }
}

/// Area of a ball's sphere.
fn sphere(ball: &Ball) -> f64 {
    4.0 * PI * ball.radius * ball.radius
}

fn ball_volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

/// The marked balls, grown and moved.
fn marked(
    balls: &[Ball],
    marks: &[bool],
    grown: f64,
    moved: impl Fn([f64; 3]) -> [f64; 3],
) -> Vec<Ball> {
    let marked = balls.iter().zip(marks).filter(|(_, mark)| **mark);
    let placed = marked.map(|(ball, _)| Ball {
        center: moved(ball.center),
        radius: ball.radius + grown,
    });
    placed.collect()
}
