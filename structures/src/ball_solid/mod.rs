//! Solids between two sets of balls, one inside and one around.
//!
//! # What is certain
//!
//! Every *inner* ball lies inside the solid S. The *outer* balls, which are the inner ones grown by eps, hold S. So for
//! two solids at a pose (B&I, section 4.1):
//!
//! - inner balls that meet certify a hit, also where one solid contains the other;
//! - outer balls that do not meet certify a miss;
//! - the distance of the solids is between that of the outer and that of the inner balls.
//!
//! Since outer balls are inner balls grown, one tree serves both sets: a pair of balls with the signed distance g has
//! the signed distance g - `eps_A` - `eps_B` once grown.
//!
//! # Where the balls come from
//!
//! - **Mesh**: the set A1 of Algorithm 1. Eps is that of its grid, or more if the balls grown by it are not shown to
//!   hold the mesh ([`BallSolid::from_mesh`]); of meshes that are not closed it is measured. A3 as it is misses a little
//!   of the solid, so it is no outer set.
//! - **Molecule**, or any list of balls: the solid is their union, and eps is zero ([`BallSolid::from_balls`]).
//!
//! # Conventions
//!
//! Lengths are in the file's unit. Balls are stored relative to [`BallSolid::origin`], so that an offset of the file
//! costs no digits; [`Motion`] takes the one solid's stored coordinates to the other's.

mod closest;
mod from_mesh;
mod hierarchy;
mod meeting;

pub use closest::{Closest, ClosestSearch, Limits};
pub use from_mesh::MeshSampling;
pub use hierarchy::BallHierarchy;
pub use meeting::MeetingPairs;

pub use crate::motion::Motion;

use std::sync::Arc;

use crate::ball::Ball;
use crate::knots::{Knots, KnotsError};
use crate::mesh::ExactSolid;
use crate::vector::{add, distance, scale, subtract};

/// A solid between two sets of balls.
#[derive(Clone, Debug)]
pub struct BallSolid {
    /// The zero of the stored coordinates, in the file's coordinates.
    origin: [f64; 3],
    /// The inner balls, relative to `origin`.
    hierarchy: BallHierarchy,
    /// Margin by which the inner balls grow to hold the solid.
    epsilon: f64,
    /// Centre of mass of the solid, relative to `origin`.
    centroid: [f64; 3],
    /// Balls and weights whose summed bumps are about one inside the solid; relative to `origin`.
    density: Knots,
    /// Its surface, if the triangles of a mesh decide contact.
    exact: Option<Arc<ExactSolid>>,
}

impl BallSolid {
    /// The union of `balls`, in the file's coordinates; `weights` count where they overlap.
    ///
    /// # Errors
    /// [`KnotsError`] without balls, with radii not above zero, or with numbers that are not finite.
    pub fn from_balls(balls: &[Ball], weights: Option<&[f64]>) -> Result<Self, KnotsError> {
        let ones = vec![1.0; balls.len()];
        let weights = weights.unwrap_or(&ones);
        let (low, high) = weighted(balls, weights.to_vec())?.bounds();
        let origin = add(scale(low, 0.5), scale(high, 0.5));
        let relative = |ball: &Ball| Ball::new(subtract(ball.center, origin), ball.radius);
        let moved: Vec<Ball> = balls.iter().map(relative).collect();
        let centroid = mean_center(&moved, weights);
        Ok(Self {
            origin,
            hierarchy: BallHierarchy::new(&moved),
            epsilon: 0.0,
            centroid,
            density: density(&moved, weights)?,
            exact: None,
        })
    }

    /// The zero of the stored coordinates, in the file's coordinates.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// The inner balls in a sphere tree, relative to [`Self::origin`].
    pub fn hierarchy(&self) -> &BallHierarchy {
        &self.hierarchy
    }

    /// Balls inside the solid, relative to [`Self::origin`].
    pub fn inner(&self) -> &[Ball] {
        self.hierarchy.balls()
    }

    /// Balls that together hold the solid, relative to [`Self::origin`].
    pub fn outer(&self) -> Vec<Ball> {
        let grown = self.inner().iter().map(|ball| ball.grown(self.epsilon));
        grown.collect()
    }

    /// Largest distance of the surface from the inner balls.
    pub fn epsilon(&self) -> f64 {
        self.epsilon
    }

    /// Centre of mass of the solid, relative to [`Self::origin`].
    pub fn centroid(&self) -> [f64; 3] {
        self.centroid
    }

    /// Balls with weights, none negative, whose summed bumps are about one inside the solid and zero outside; relative
    /// to [`Self::origin`]. Each is an inner ball, so solids whose bumps overlap meet.
    pub fn density(&self) -> &Knots {
        &self.density
    }

    /// The solid's surface, if the solid is a mesh whose triangles decide contact.
    pub fn exact(&self) -> Option<&ExactSolid> {
        self.exact.as_deref()
    }

    /// Radius of a ball about the origin of the stored coordinates that holds the outer balls.
    pub fn reach(&self) -> f64 {
        self.reach_from([0.0; 3])
    }

    /// Radius of a ball about another point of these coordinates that holds the outer balls.
    pub fn reach_from(&self, point: [f64; 3]) -> f64 {
        let reach = |ball: &Ball| distance(ball.center, point) + ball.radius;
        self.inner().iter().map(reach).fold(0.0, f64::max) + self.epsilon
    }
}

/// Mean of the centres, weighted by weight and volume.
fn mean_center(balls: &[Ball], weights: &[f64]) -> [f64; 3] {
    let largest = balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
    let (mut sum, mut total) = ([0.0; 3], 0.0);
    for (ball, weight) in balls.iter().zip(weights) {
        // Relative to the largest, so that no cube under- or overflows.
        let share = weight.max(0.0) * (ball.radius / largest).powi(3);
        total += share;
        for (sum, center) in sum.iter_mut().zip(ball.center) {
            *sum += share * center;
        }
    }
    if total > 0.0 {
        sum.map(|sum| sum / total)
    } else {
        [0.0; 3]
    }
}

/// Weighted balls, those of no weight left out; all of them at weight one if none has any.
fn density(balls: &[Ball], weights: &[f64]) -> Result<Knots, KnotsError> {
    let any = weights.iter().any(|&weight| weight > 0.0);
    let (balls, weights): (Vec<&Ball>, Vec<f64>) = balls
        .iter()
        .zip(weights)
        .map(|(ball, &weight)| (ball, if any { weight } else { 1.0 }))
        .filter(|(_, weight)| *weight > 0.0)
        .unzip();
    weighted(balls, weights)
}

fn weighted<'a>(
    balls: impl IntoIterator<Item = &'a Ball>,
    weights: Vec<f64>,
) -> Result<Knots, KnotsError> {
    let parts = balls.into_iter().map(|ball| (ball.center, ball.radius));
    let (centers, radii) = parts.unzip();
    Knots::with_weights(centers, radii, weights)
}
